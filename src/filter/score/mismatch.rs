//! `mismatch` (f2 of MOMA, doi 10.1145/2576768.2598242): actual against theoretical innovation covariance, by their traces.

use super::{Pools, Scoring, Traced};
use crate::objective::Objective;
use std::cell::LazyCell;

/// Sums: m for Ca over the window, then m for Ct over the window, or over its last row with `ct = "last"`.
pub(super) fn trace(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let (skip, window) = (objective.skip, objective.window);
    let last = if objective.ct_last { 1 } else { window };
    let rows = scoring.rows();
    let inside = LazyCell::new(|| rows.last_measured(skip, window));
    let theory = LazyCell::new(|| rows.last_measured(skip, last));
    let m = scoring.measurements();
    let mut sums = Vec::with_capacity(2 * m);
    for i in 0..m {
        let weight = scoring.weight(|place| f64::from(u8::from(place.present(i) && inside.contains(place))));
        let square = scoring.squared_innovation(i);
        sums.push(scoring.sum(square, weight));
    }
    for i in 0..m {
        let weight = scoring.weight(|place| f64::from(u8::from(place.present(i) && theory.contains(place))));
        let variance = scoring.innovation_variance(i);
        sums.push(scoring.sum(variance, weight));
    }
    // Ca is a mean over the window; Ct over the same rows or over one.
    let counts = scoring.counts(|place| f64::from(u8::from(place.components() > 0 && inside.contains(place))));
    let scale = |rows: f64| match rows {
        0.0 => f64::NAN,
        _ if objective.ct_last => 1.0 / rows,
        _ => 1.0,
    };
    let counts = counts.into_iter().map(scale).collect();
    Traced { sums, counts }
}

/// Of trajectory `t`: |mean Ca / mean Ct - 1|; one without a measured row does not count.
pub(super) fn of_trajectory(pools: &Pools<'_>, t: usize) -> f64 {
    let m = pools.len() / 2;
    let scale = pools.counts()[t];
    if scale.is_nan() {
        return 0.0;
    }
    let actual: f64 = (0..m).map(|j| pools.total(j)).sum();
    let theory: f64 = (m..2 * m).map(|j| pools.total(j)).sum();
    (actual * scale / theory - 1.0).abs()
}

/// The mean over the trajectories that count.
pub(super) fn finish(pools: &Pools<'_>) -> f64 {
    let trajectories = pools.counts().iter().filter(|scale| !scale.is_nan()).count();
    pools.folded() / super::innovation::count(trajectories)
}
