//! Objectives that need the true states: `rmse`, `distance`, `nees`.

use super::{Pools, Scoring, Traced};
use crate::filter::Place;
use crate::objective::Objective;

/// 1 where the truth of all `columns` is known, else 0.
fn known(place: Place<'_>, columns: &[Option<usize>], skip: usize) -> f64 {
    let all = columns.iter().all(|c| c.is_some_and(|c| !place.truth(c).is_nan()));
    f64::from(u8::from(place.k >= skip && all))
}

/// The named states, or all that have truth.
fn compared(objective: &Objective, scoring: &Scoring<'_, '_>) -> Vec<usize> {
    if objective.states.is_empty() {
        return (0..scoring.states()).filter(|i| scoring.truth_column(*i).is_some()).collect();
    }
    objective.states.clone()
}

fn with_truth(objective: &Objective, scoring: &mut Scoring<'_, '_>, states: &[usize], root: bool) -> Traced {
    let (columns, skip) = (states.iter().map(|i| scoring.truth_column(*i)).collect::<Vec<_>>(), objective.skip);
    let weight = scoring.weight(|place| known(place, &columns, skip));
    let counts = scoring.counts(|place| known(place, &columns, skip));
    let mut value = scoring.squared_error(states);
    if root {
        value = scoring.sqrt(value);
    }
    Traced { sums: vec![scoring.sum(value, weight)], counts }
}

/// `rmse`: squared error of the named states.
pub(super) fn trace_rmse(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    with_truth(objective, scoring, &compared(objective, scoring), false)
}

/// sqrt(sum / number of rows), not divided by the number of states.
pub(super) fn finish_rmse(pools: &Pools<'_>) -> f64 {
    (pools.total(0) / pools.count()).sqrt()
}

/// `distance`: Euclidean error of the named states.
pub(super) fn trace_distance(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    with_truth(objective, scoring, &compared(objective, scoring), true)
}

/// The sum over rows; NaN over none, which is not a distance of 0.
pub(super) fn finish_distance(pools: &Pools<'_>) -> f64 {
    if pools.count() > 0.0 { pools.total(0) } else { f64::NAN }
}

/// `nees`: e' P^-1 e where the truth of all states is known; counts are rows x n.
pub(super) fn trace_nees(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let states: Vec<usize> = (0..scoring.states()).collect();
    let (columns, skip) = (states.iter().map(|i| scoring.truth_column(*i)).collect::<Vec<_>>(), objective.skip);
    let weight = scoring.weight(|place| known(place, &columns, skip));
    let n = super::innovation::count(states.len());
    let counts = scoring.counts(|place| n * known(place, &columns, skip));
    // Not weight * value: where the truth is unknown P may be singular, and 0 times infinity is no number.
    let value = scoring.normalised_error(weight);
    Traced { sums: vec![scoring.total_of(value)], counts }
}

/// sum NEES / (n x rows): 1 when consistent.
pub(super) fn finish_nees_mean(pools: &Pools<'_>) -> f64 {
    pools.total(0) / pools.count()
}

/// |nees_mean - 1|.
pub(super) fn finish_nees(pools: &Pools<'_>) -> f64 {
    (finish_nees_mean(pools) - 1.0).abs()
}
