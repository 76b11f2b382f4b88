//! Robust updates: what a row counts that the filter did not expect, and the density that it is scored by.
//!
//! The plain update comes first. A row of weight w then gets x + w K nu and P - w K S K', which is the share w of the plain
//! update: no square is ever taken away twice, and factors stay factors. Of the present components of a row all have one weight,
//! but those of the Huber kind with more than two measurements, which are weighed one decorrelated scalar after the other.
#![expect(non_snake_case, reason = "Kalman notation: P, S, K")]

mod gate;
mod huber;
mod outliers;
mod student;

pub(super) use huber::weight as huber_weight;

use super::update::{Update, between};
use crate::filter::columns::Key;
use crate::filter::covariance::Covariance;
use crate::filter::evidence::{Factor, Likelihood};
use crate::filter::form::Form;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::model::Robust;
use crate::tape::{Graph, Id, Unary};

/// A row before and after its plain update.
pub(super) struct Plain<'a> {
    pub(super) prior: (&'a [Id], &'a Covariance),
    pub(super) update: &'a Update,
    pub(super) posterior: (Vec<Id>, Covariance),
    pub(super) form: Form,
}

/// A row after its robust update.
pub(super) struct Outcome {
    pub(super) x: Vec<Id>,
    pub(super) P: Covariance,
    /// The entries that the kind carries.
    pub(super) memory: Vec<Id>,
    pub(super) likelihood: Likelihood,
    /// One less the weight, 0 where nothing is measured.
    pub(super) rejected: Option<Id>,
    /// What a candidate fails without.
    pub(super) positive: Vec<Id>,
}

/// What is known of a row.
struct Seen {
    /// 1 where anything is measured.
    any: Id,
    /// Number of present components, m.
    count: Id,
    nis: Id,
    /// The settings of the kind.
    settings: Vec<Id>,
}

/// What a row counts.
enum Verdict {
    /// A weight from 0 to 1.
    Weight(Id),
    /// All where positive, else nothing.
    Accepted(Id),
    /// The probability that it is no outlier, and that it is one: of both, mean and covariance of the two that may be.
    Probable([Id; 2]),
    /// Weighed already, component by component; the mean of one less these weights.
    Weighed(Id),
}

/// The threshold of the Huber kind, where components are weighed one by one.
pub(super) fn by_component(robust: Option<&Robust>, t: &Tracer<'_>, row: &Row) -> Option<Id> {
    match robust {
        Some(Robust::Huber { .. }) if row.present.len() > 2 => settings(t, row).first().copied(),
        _ => None,
    }
}

/// Names of what a kind carries.
pub(super) fn names(robust: Option<&Robust>) -> Vec<String> {
    let counts = robust.is_some_and(gate::counts);
    if counts { vec!["rejected".to_owned()] } else { vec![] }
}

/// The same at the start.
pub(super) fn start(g: &mut Graph, robust: Option<&Robust>) -> Vec<Id> {
    names(robust).iter().map(|_| g.constant(0.0)).collect()
}

/// The robust update of a row; `memory` is what the kind carries.
pub(super) fn update(robust: &Robust, t: &mut Tracer<'_>, row: &Row, plain: Plain<'_>, memory: Vec<Id>) -> Outcome {
    let seen = Seen::new(t, row, plain.update);
    let mut memory = memory;
    let (verdict, likelihood) = match robust {
        Robust::Mixture(outliers) => {
            let density = outliers::Density::new(t, row, (&seen, plain.update), outliers, 0);
            (Verdict::Probable(density.probabilities(&mut t.g, &seen)), density.likelihood(t, row, &seen))
        }
        Robust::Correntropy { outliers, .. } => {
            let density = outliers::Density::new(t, row, (&seen, plain.update), outliers, 1);
            (Verdict::Weight(seen.correntropy(&mut t.g)), density.likelihood(t, row, &seen))
        }
        Robust::Gate { limit, outliers, .. } => {
            let density = outliers::Density::new(t, row, (&seen, plain.update), outliers, 1);
            let accepted = gate::accepted(&mut t.g, &seen, *limit, &mut memory);
            (Verdict::Accepted(accepted), density.likelihood(t, row, &seen))
        }
        Robust::StudentT { .. } => student::update(t, row, (&seen, plain.update)),
        Robust::Huber { .. } => huber::update(t, row, (&seen, plain.update)),
    };
    let (x, P, rejected) = plain.posterior_by(&mut t.g, &seen, verdict);
    let positive = plain.update.pivots.clone();
    Outcome { x, P, memory, likelihood, rejected: Some(rejected), positive }
}

impl Plain<'_> {
    /// The posterior that a verdict leaves of the plain one, and what is rejected.
    fn posterior_by(&self, g: &mut Graph, seen: &Seen, verdict: Verdict) -> (Vec<Id>, Covariance, Id) {
        let ((before, prior), (mut x, P)) = (self.prior, self.posterior.clone());
        let one = g.constant(1.0);
        let weight = match verdict {
            Verdict::Weighed(rejected) => return (x, P, rejected),
            Verdict::Weight(weight) | Verdict::Accepted(weight) | Verdict::Probable([weight, _]) => {
                g.select(seen.any, weight, one)
            }
        };
        between(g, weight, before, &mut x);
        if let Verdict::Accepted(_) = verdict {
            let P = P.or(g, weight, prior, self.form);
            return (x, P, g.sub(one, weight));
        }
        let mut P = prior.partly(g, &P, weight, &self.update.gains);
        let Verdict::Probable([_, left]) = verdict else { return (x, P, g.sub(one, weight)) };
        // What is left is b(1 - b) K nu nu' K', the spread of the two means.
        let zero = g.constant(0.0);
        let left = g.select(seen.any, left, zero);
        let spread = g.mul(weight, left);
        P.widen(g, spread, &self.update.correction);
        (x, P, left)
    }
}

impl Seen {
    fn new(t: &mut Tracer<'_>, row: &Row, update: &Update) -> Self {
        let any = t.flag(Key::Measured, |place| place.components() > 0);
        let zero = t.g.constant(0.0);
        let count = row.present.iter().fold(zero, |sum, present| t.g.add(sum, *present));
        let nis = update.nis.iter().fold(zero, |sum, share| t.g.add(sum, *share));
        Self { any, count, nis, settings: settings(t, row) }
    }

    /// exp(-NIS / (2 k^2)).
    fn correntropy(&self, g: &mut Graph) -> Id {
        let (k, half) = (self.settings[0], g.constant(-0.5));
        let square = g.mul(k, k);
        let scale = g.div(half, square);
        let exponent = g.mul(self.nis, scale);
        g.unary(Unary::Exp, exponent)
    }
}

/// The settings of the robust kind: they stand behind those of the filter.
fn settings(t: &Tracer<'_>, row: &Row) -> Vec<Id> {
    row.model.settings[t.problem.filter.settings().len()..].to_vec()
}

/// The factors of a density that has those of the gaussian one, each times `by`.
fn factors(g: &mut Graph, pivots: &[Id], by: Id) -> Vec<Factor> {
    let factor = |(component, pivot): (usize, &Id)| Factor { value: g.mul(*pivot, by), component };
    pivots.iter().enumerate().map(factor).collect()
}

/// What `of` says of the number of present components, 1 or more; 0 where there is none.
fn by_count(t: &mut Tracer<'_>, most: usize, of: impl Fn(&mut Graph, usize) -> Id) -> Id {
    let mut sum = t.g.constant(0.0);
    for count in 1..=most {
        let these = t.flag(Key::Components(count), |place| place.components() == count);
        if t.g.is(these, 0.0) {
            continue;
        }
        let value = of(&mut t.g, count);
        let value = t.g.mul(these, value);
        sum = t.g.add(sum, value);
    }
    sum
}
