//! Objectives of the innovations: `mse_innovation`, `nis`, and what others share with them.

use super::{Pools, Scoring, Traced};
use crate::filter::Place;
use crate::objective::Objective;

/// Number of present components over the rows that score.
pub(super) fn component_counts(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Vec<f64> {
    let skip = objective.skip;
    scoring.counts(|place| if place.k >= skip { count(place.components()) } else { 0.0 })
}

/// `nis` and `nis_mean`.
pub(super) fn trace_nis(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let weight = scoring.weight(|place| f64::from(u8::from(place.k >= skip)));
    let nis = scoring.nis();
    Traced { sums: vec![scoring.sum(nis, weight)], counts: component_counts(objective, scoring) }
}

/// sum NIS / number of present components: 1 when consistent.
pub(super) fn finish_nis_mean(pools: &Pools<'_>) -> f64 {
    pools.total(0) / pools.count()
}

/// |nis_mean - 1|.
pub(super) fn finish_nis(pools: &Pools<'_>) -> f64 {
    (finish_nis_mean(pools) - 1.0).abs()
}

/// `rejected`: over the rows with a measurement.
pub(super) fn trace_rejected(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let counts = |place: Place<'_>| f64::from(u8::from(place.k >= skip && place.components() > 0));
    let weight = scoring.weight(counts);
    let rejected = scoring.rejected();
    Traced { sums: vec![scoring.sum(rejected, weight)], counts: scoring.counts(counts) }
}

/// Mean of one less the weight of a row.
pub(super) fn finish_rejected(pools: &Pools<'_>) -> f64 {
    pools.total(0) / pools.count()
}

/// `mse_innovation` (f1): one sum of nu^2 of the present components.
pub(super) fn trace_mse(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let sums = (0..scoring.measurements())
        .map(|i| {
            let weight = scoring.weight(|place| f64::from(u8::from(place.k >= skip && place.present(i))));
            let square = scoring.squared_innovation(i);
            scoring.sum(square, weight)
        })
        .collect();
    Traced { sums, counts: component_counts(objective, scoring) }
}

/// sum nu^2 / number of present components.
pub(super) fn finish_mse(pools: &Pools<'_>) -> f64 {
    (0..pools.len()).map(|j| pools.total(j)).sum::<f64>() / pools.count()
}

#[expect(clippy::cast_precision_loss, reason = "counts of rows and components stay far below 2^53")]
pub(super) const fn count(n: usize) -> f64 {
    n as f64
}
