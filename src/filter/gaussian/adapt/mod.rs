//! What adapts Q or R on the way: what it carries beside x and P, and what an update does to that. One file a kind.
//!
//! Adaptation sees innovations and covariances only, never a coordinate, so the deviation form changes nothing here.
//! Everything that the log alone decides (which rows count, whether a buffer is full) is a column.
#![expect(non_snake_case, reason = "Kalman notation: P, Q, R")]

mod fuzzy;
mod sage_husa;
mod sage_husa_r;

pub(in crate::filter) use fuzzy::Fuzzy;
pub(in crate::filter) use sage_husa::SageHusa;
pub(in crate::filter) use sage_husa_r::SageHusaR;

use super::update::{Measurement, Update};
use crate::filter::covariance::Covariance;
use crate::filter::covariance::Symmetric;
use crate::filter::form::Form;
use crate::filter::nodes::ModelNodes;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units;
use crate::model::{Model, Range};
use crate::tape::{Graph, Id, Unary};

/// The noise of a row, in the filter's units.
pub(in crate::filter) struct Noise {
    pub(super) Q: Covariance,
    pub(super) R: Symmetric,
}

impl Noise {
    /// The model's.
    pub(super) fn of(t: &mut Tracer<'_>, model: &ModelNodes) -> Self {
        Self {
            Q: Covariance::Full(units::covariance(&mut t.g, &model.Q, &t.units.states)),
            R: units::covariance(&mut t.g, &model.R, &t.units.measurements),
        }
    }
}

/// What an update is adapted from.
pub(in crate::filter) struct Seen<'a> {
    pub(super) measurement: &'a Measurement,
    pub(super) update: &'a Update,
    /// The covariance before it.
    pub(super) prior: &'a Covariance,
}

/// A law by which Q or R change, and its memory: entries that are carried.
pub(in crate::filter) trait Adaptation {
    /// Names of the entries.
    fn names(&self, form: Form, model: &Model) -> Vec<String>;

    /// Number of entries at the end that are neither constant nor equal to others, so that nothing is to be found out about
    /// them.
    fn opaque(&self, _: &Model) -> usize {
        0
    }

    /// The entries at the start of a trajectory, from the model's noise.
    fn start(&self, g: &mut Graph, form: Form, noise: Noise) -> Vec<Id>;

    /// Puts the adapted Q or R in the place of the model's.
    fn adopt(&self, g: &mut Graph, form: Form, memory: &[Id], noise: &mut Noise);

    /// The entries after an update.
    fn adapt(&self, t: &mut Tracer<'_>, form: Form, row: &Row, memory: Vec<Id>, seen: &Seen<'_>) -> Vec<Id>;
}

/// Q and R stay the model's: the Kalman filter itself.
pub(in crate::filter) struct NoAdaptation;

impl Adaptation for NoAdaptation {
    fn names(&self, _: Form, _: &Model) -> Vec<String> {
        vec![]
    }

    fn start(&self, _: &mut Graph, _: Form, _: Noise) -> Vec<Id> {
        vec![]
    }

    fn adopt(&self, _: &mut Graph, _: Form, _: &[Id], _: &mut Noise) {}

    fn adapt(&self, _: &mut Tracer<'_>, _: Form, _: &Row, memory: Vec<Id>, _: &Seen<'_>) -> Vec<Id> {
        memory
    }
}

/// The next weight 1 / d_k = 1 + b + ... + b^k = 1 + b / d_(k-1), from 1 at k = 0, and d_k; where nothing is measured the
/// weight stays and d is 0.
fn fade(g: &mut Graph, weight: Id, forgetting: Id, measured: Id) -> (Id, Id) {
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let faded = g.mul(forgetting, weight);
    let next = g.add(faded, one);
    let d = g.div(one, next);
    (g.select(measured, next, weight), g.select(measured, d, zero))
}

/// Diagonal R of independent components.
fn diagonal(g: &mut Graph, variances: &[Id]) -> Symmetric {
    let zero = g.constant(0.0);
    Symmetric::from_fn(variances.len(), |i, j| if i == j { variances[i] } else { zero })
}

/// Positive while the searched settings of the filter are in their ranges.
pub(in crate::filter) fn in_range(t: &mut Tracer<'_>, settings: &[Id]) -> Vec<Id> {
    let ranges = t.problem.settings().into_iter().map(|setting| setting.range);
    let searched: Vec<_> = ranges.zip(settings).filter(|(_, value)| t.g.value(**value).is_none()).collect();
    searched.into_iter().map(|(range, value)| within(&mut t.g, range, *value)).collect()
}

/// Positive where `value` is in its range.
fn within(g: &mut Graph, range: Range, value: Id) -> Id {
    let (one, no) = (g.constant(1.0), g.constant(-1.0));
    match range {
        Range::Positive => value,
        Range::NotNegative => {
            let below = g.neg(value);
            g.select(below, no, one)
        }
        // What is not finite makes a cost that is not.
        Range::Any => one,
        Range::Share => {
            let above = g.sub(value, one);
            g.select(above, no, value)
        }
        Range::Probability => {
            let (below, above) = (g.neg(value), g.sub(value, one));
            let least = g.select(above, no, one);
            g.select(below, no, least)
        }
        Range::One => {
            let (off, rounding) = (g.sub(value, one), g.constant(Range::ROUNDING));
            let off = g.unary(Unary::Abs, off);
            let beyond = g.sub(off, rounding);
            g.select(beyond, no, one)
        }
        Range::Inside => {
            let rest = g.sub(one, value);
            g.select(value, rest, no)
        }
        Range::AboveTwo => {
            let two = g.constant(2.0);
            g.sub(value, two)
        }
        Range::BelowOne => {
            let (below, rest) = (g.neg(value), g.sub(one, value));
            g.select(below, no, rest)
        }
    }
}
