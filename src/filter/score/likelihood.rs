//! `nll`: negative log-likelihood by the prediction error decomposition (Schweppe 1965, doi 10.1109/TIT.1965.1053737).

use super::{Pools, Scoring, Traced};
use crate::objective::Objective;
use std::f64::consts::TAU;

/// Sums: that of the exponents, then ln of the factors (ln det S, for a gaussian) in pieces, then what has a power of its own.
pub(super) fn trace(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let weight = scoring.weight(|place| f64::from(u8::from(place.k >= skip)));
    let mut sums = vec![scoring.sum(scoring.exponent(), weight)];
    for (component, factor) in scoring.factors() {
        let gate = scoring.weight(|place| f64::from(u8::from(place.k >= skip && place.present(component))));
        sums.push(scoring.log_product(factor, gate));
    }
    for (value, power) in scoring.powers() {
        let gate = scoring.weight(|place| f64::from(u8::from(place.k >= skip && place.components() > 0)));
        sums.push(scoring.log_power(value, power, gate));
    }
    Traced { sums, counts: super::innovation::component_counts(objective, scoring) }
}

/// 1/2 (count ln 2 pi + ln det S + the exponents).
pub(super) fn finish(pools: &Pools<'_>) -> f64 {
    let log_determinant: f64 = (1..pools.len()).map(|j| pools.total(j)).sum();
    0.5 * (pools.count() * TAU.ln() + log_determinant + pools.total(0))
}
