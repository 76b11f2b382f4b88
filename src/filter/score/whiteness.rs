//! `whiteness`: the autocorrelation of the innovations.

use super::{Pools, Scoring, Traced};
use crate::filter::Memo;
use crate::objective::Objective;

/// What has to be remembered: so many earlier values of each of `measurements` components.
pub(super) fn memory(objective: &Objective, measurements: usize) -> impl Iterator<Item = Memo> {
    let (lags, skip) = (objective.lags, objective.skip);
    (0..measurements).flat_map(move |component| (1..=lags).map(move |lag| Memo::Innovation { component, lag, skip }))
}

/// Sums: for each component that has a value, of nu^2 / S and then of nu / sqrt(S) times the value 1, 2, ... values ago. Values are
/// taken over where the component is present; in other rows the memory stays.
pub(super) fn trace(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let (mut sums, mut pairs) = (Vec::new(), vec![]);
    for component in 0..scoring.measurements() {
        let rows = scoring.weight(|place| f64::from(u8::from(place.k >= skip && place.present(component))));
        let values = scoring.counts(|place| f64::from(u8::from(place.k >= skip && place.present(component))));
        pairs.resize(values.len(), 0.0);
        pairs.iter_mut().zip(values).for_each(|(pairs, values)| *pairs += (values - 1.0).max(0.0));
        if !rows.counts_any() {
            continue;
        }
        let value = scoring.standardised_innovation(component, rows);
        sums.push(scoring.total_product(value, value));
        let mut later = value;
        for lag in 1..=objective.lags {
            let memo = Memo::Innovation { component, lag, skip };
            let earlier = scoring.recall(memo);
            sums.push(scoring.total_product(value, earlier));
            let kept = scoring.choose(rows, later, earlier);
            scoring.remember(memo, kept);
            later = earlier;
        }
    }
    Traced { sums, counts: pairs }
}

/// The sum over components and lags of squared autocorrelations; NaN where no component has two values in one trajectory.
pub(super) fn finish(objective: &Objective, pools: &Pools<'_>) -> f64 {
    if pools.count() <= 0.0 {
        return f64::NAN;
    }
    let width = objective.lags + 1;
    let of_component = |first: usize| -> f64 {
        let power = pools.total(first);
        (first + 1..first + width).map(|j| (pools.total(j) / power).powi(2)).sum()
    };
    (0..pools.len()).step_by(width).map(of_component).sum()
}
