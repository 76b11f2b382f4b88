//! After the search: local searches from several distinct candidates end it.
//!
//! A smooth cost is polished by L-BFGS-B from the winner, the user's start, other niches of the archive and fresh points;
//! one with kinks, or at a constraint's edge, by Nelder-Mead. All run in lockstep on the f64 evaluator.

mod front;
mod lockstep;
mod starts;
mod undetermined;
mod winner;

use std::sync::atomic::{AtomicBool, Ordering};

pub(super) use front::polish as polish_front;
pub(super) use winner::polish as polish_winner;

use super::finish::{Bounds, Verdict};
use super::record::Record;
use super::{Coordinates, Oracle};
use crate::evaluate::Evaluator;
use crate::model::TuneSpec;
use crate::objective::Kind;

/// What the local searches did.
#[derive(Debug, Clone, PartialEq)]
pub struct Polish {
    /// The winner's objectives before, by the oracle; of a front, the best of each.
    pub before: Vec<f64>,
    /// And after; the same when nothing better was found.
    pub after: Vec<f64>,
    /// Evaluations, not counted among the search's.
    pub evaluations: usize,
    /// Local searches.
    pub starts: usize,
    /// Why they ended.
    pub ended: Ended,
    /// Whether the winner is an optimum by its gradient; `None` where there is no gradient to judge by: a cost with kinks,
    /// the edge of a constraint, a front.
    pub converged: Option<bool>,
    /// Predicted distance of the winner to the optimum, in standard errors: sqrt(2 x the predicted gain in nats).
    pub gradient_norm: Option<f64>,
    /// Searched parameters, by index, that were put back to their start because the cost is the same there.
    pub left_at_start: Vec<usize>,
    /// Members that the front gained.
    pub members: usize,
}

/// Why the local searches ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ended {
    /// They came to their own end.
    Done,
    /// The best one had used up its evaluations.
    Evaluations,
    /// The cost has no step down although its gradient is not small: a kink or a wall.
    Stuck,
    /// The time allowed was over.
    WallTime,
    /// Interrupted from outside.
    Interrupted,
}

/// What polish starts from and ends with.
pub(super) struct Polished<'a> {
    pub(super) candidate: &'a mut Vec<f64>,
    pub(super) verdict: &'a mut Verdict,
}

/// Where polish runs, and what ends it early.
pub(super) struct Place<'a> {
    pub(super) tune: &'a TuneSpec,
    pub(super) coordinates: &'a Coordinates,
    pub(super) record: &'a Record,
    pub(super) evaluator: &'a mut dyn Evaluator,
    pub(super) oracle: &'a Oracle<'a>,
    pub(super) bounds: Bounds<'a>,
    pub(super) interrupt: &'a AtomicBool,
}

impl Place<'_> {
    /// Why no further batch may start, if so.
    fn stopped(&self) -> Option<Ended> {
        let over = self.tune.wall_time.is_some_and(|limit| self.record.seconds() >= limit);
        if self.interrupt.load(Ordering::Relaxed) { Some(Ended::Interrupted) } else { over.then_some(Ended::WallTime) }
    }

    fn kind(&self, objective: usize) -> Kind {
        self.bounds.kind(objective)
    }

    fn rows(&self) -> usize {
        self.bounds.rows
    }
}
