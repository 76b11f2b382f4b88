//! `nis_distribution`: the NIS against its chi-square distribution (Neyman 1937, doi 10.1080/03461238.1937.10404821).

use super::chi_square::{legendre, probability};
use super::{Pools, Scoring, Traced};
use crate::filter::Place;
use crate::objective::Objective;

/// Sums: the four polynomials of u = F(NIS), which is uniform if the filter is right. Rows differ in the number of their components,
/// and so in F: a column chooses, which kinds of rows decide.
pub(super) fn trace(objective: &Objective, scoring: &mut Scoring<'_, '_>) -> Traced {
    let skip = objective.skip;
    let scores = |place: Place<'_>| place.k >= skip && place.components() > 0;
    let weight = scoring.weight(|place| f64::from(u8::from(scores(place))));
    let nis = scoring.nis();
    let mut u = None;
    for m in 1..=scoring.measurements() {
        let rows = scoring.weight(|place| f64::from(u8::from(scores(place) && place.components() == m)));
        if rows.counts_any() {
            let [own] = scoring.map(nis, |g, nis| [probability(g, nis, m)]);
            u = Some(u.map_or(own, |others| scoring.choose(rows, own, others)));
        }
    }
    // Where nothing scores the count is 0, and there is no value.
    let u = u.unwrap_or(nis);
    let sums = scoring.map(u, legendre).map(|polynomial| scoring.sum(polynomial, weight)).to_vec();
    let counts = scoring.counts(|place| f64::from(u8::from(scores(place))));
    Traced { sums, counts }
}

/// The sum of the squared means of the polynomials: rows x value is chi-square with 4 degrees of freedom if consistent.
pub(super) fn finish(pools: &Pools<'_>) -> f64 {
    (0..pools.len()).map(|j| (pools.total(j) / pools.count()).powi(2)).sum()
}
