//! `prediction`: measurements against what was predicted of them several rows ago.

use super::{Pools, Scoring, Traced};
use crate::filter::{Memo, Place};
use crate::objective::Objective;

/// What has to be remembered: the predictions on their way, each of all `states`.
pub(super) fn memory(objective: &Objective, states: usize) -> impl Iterator<Item = Memo> {
    let most = objective.horizons().iter().copied().max().unwrap_or(1);
    (1..most).flat_map(move |rows| (0..states).map(move |state| Memo::Lead { state, rows }))
}

/// For each distance the sums of the squared errors of the components, and the counts of these, trajectory by trajectory.
pub(super) fn trace(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let mut traced = Traced::default();
    for &ahead in objective.horizons() {
        let scores = |place: Place<'_>| place.k >= skip && place.leads() >= ahead;
        for i in 0..scoring.measurements() {
            let weight = scoring.weight(|place| f64::from(u8::from(scores(place) && place.present(i))));
            let square = scoring.squared_prediction_error(ahead, i);
            traced.sums.push(scoring.sum_where(square, weight));
        }
        let components =
            |place: Place<'_>| if scores(place) { super::innovation::count(place.components()) } else { 0.0 };
        traced.counts.extend(scoring.counts(components));
    }
    traced
}

/// The mean over the distances of sum e^2 / number of present components.
pub(super) fn finish(objective: &Objective, pools: &Pools<'_>) -> f64 {
    let horizons = objective.horizons().len();
    let (sums, trajectories) = (pools.len() / horizons, pools.counts().len() / horizons);
    let of = |ahead: usize| -> f64 {
        let total: f64 = (ahead * sums..(ahead + 1) * sums).map(|j| pools.total(j)).sum();
        let count: f64 = pools.counts()[ahead * trajectories..(ahead + 1) * trajectories].iter().sum();
        total / count
    };
    (0..horizons).map(of).sum::<f64>() / super::innovation::count(horizons)
}
