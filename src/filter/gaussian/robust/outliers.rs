//! The density (1 - eps) N(nu; 0, S) + eps / V of a measurement that may be an outlier anywhere in a volume V.
//!
//! With N' = (1 - eps) N and u = eps / V it is u (1 + N' / u): u is known before the loop, and 1 + N' / u is at least 1, so that
//! the exponential may vanish.

use super::Seen;
use crate::filter::evidence::{Likelihood, Power};
use crate::filter::gaussian::update::Update;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units::scaled;
use crate::model::family::Outliers;
use crate::tape::{Graph, Id, Unary};
use std::f64::consts::TAU;

/// The density of a row.
pub(super) struct Density {
    eps: Id,
    /// For each measurement the length of the range that outliers fall in, in the problem's own units.
    volume: Vec<Id>,
    /// N' / u.
    ratio: Id,
    /// 1 + N' / u.
    whole: Id,
}

impl Density {
    /// Of a row after its plain update; the settings of the outliers stand behind `own` others.
    pub(super) fn new(
        t: &mut Tracer<'_>,
        row: &Row,
        (seen, update): (&Seen, &Update),
        outliers: &Outliers,
        own: usize,
    ) -> Self {
        let eps = seen.settings[own];
        let volume = match outliers.volume {
            Some(_) => seen.settings[own + 1..].to_vec(),
            None => ranges(t),
        };
        let (one, half) = (t.g.constant(1.0), t.g.constant(-0.5));
        let less = t.g.sub(one, eps);
        let mut ratio = t.g.div(less, eps);
        let lengths = scaled(&mut t.g, &volume, &t.units.measurements);
        for ((length, present), inverse) in lengths.iter().zip(&row.present).zip(&update.inverses) {
            let scale = t.g.constant(1.0 / TAU);
            let variance = t.g.mul(*inverse, scale);
            let height = t.g.unary(Unary::Sqrt, variance);
            let factor = t.g.mul(*length, height);
            let factor = t.g.select(*present, factor, one);
            ratio = t.g.mul(ratio, factor);
        }
        let exponent = t.g.mul(half, seen.nis);
        let bell = t.g.unary(Unary::Exp, exponent);
        let ratio = t.g.mul(ratio, bell);
        let whole = t.g.add(one, ratio);
        Self { eps, volume, ratio, whole }
    }

    /// That the row is no outlier, and that it is one.
    pub(super) fn probabilities(&self, g: &mut Graph, seen: &Seen) -> [Id; 2] {
        let one = g.constant(1.0);
        let whole = g.select(seen.any, self.whole, one);
        let outlier = g.div(one, whole);
        [g.mul(self.ratio, outlier), outlier]
    }

    /// -2 ln p = 2 ln V - 2 ln eps - 2 ln(1 + N' / u). What is added up counts ln 2 pi for each component, which is taken off.
    pub(super) fn likelihood(&self, t: &mut Tracer<'_>, row: &Row, seen: &Seen) -> Likelihood {
        let (two, turn) = (t.g.constant(2.0), t.g.constant(TAU.ln()));
        let mut exponent = t.g.constant(0.0);
        for (volume, present) in self.volume.iter().zip(&row.present) {
            let ln = t.g.unary(Unary::Ln, *volume);
            let twice = t.g.mul(two, ln);
            let share = t.g.sub(twice, turn);
            let share = t.g.mul(*present, share);
            exponent = t.g.add(exponent, share);
        }
        let ln = t.g.unary(Unary::Ln, self.eps);
        let twice = t.g.mul(two, ln);
        let share = t.g.mul(seen.any, twice);
        let exponent = t.g.sub(exponent, share);
        let power = t.g.constant(-2.0);
        Likelihood { exponent, factors: vec![], powers: vec![Power { value: self.whole, power }] }
    }
}

/// The ranges of the training log, of angles a turn.
fn ranges(t: &mut Tracer<'_>) -> Vec<Id> {
    let ranges = t.rows.log.ranges();
    let angles = &t.problem.model.angles;
    let length = |(i, range): (usize, f64)| t.g.constant(if angles.measurement(i) { TAU } else { range });
    ranges.into_iter().enumerate().map(length).collect()
}
