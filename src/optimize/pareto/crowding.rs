//! Crowding distance.

use rayon::prelude::*;

use super::Scores;

/// Members from which on a front is worth sorting on all threads. (Indices decide ties, so the order is the same.)
const LARGE_FRONT: usize = 4096;

/// Crowding distance of every candidate within its front, as `ranks` gives them.
///
/// For each front and objective the members are sorted by cost, equal costs by index. The first and the last become
/// infinite, so of equal extremes the first copy at the low end and the last at the high end; every other gains
/// (next - previous) / (largest - smallest), or nothing where these are equal. Distances of the objectives are summed, not
/// averaged.
#[must_use]
pub fn crowding(scores: &Scores, ranks: &[usize]) -> Vec<f64> {
    crowding_among(scores, ranks, (0..ranks.len()).collect())
}

/// As [`crowding`], for these members of whole fronts; 0 for all others.
pub(super) fn crowding_among(scores: &Scores, ranks: &[usize], mut members: Vec<usize>) -> Vec<f64> {
    members.sort_by_key(|i| ranks[*i]);
    let mut distance = vec![0.0; ranks.len()];
    let mut keyed = Vec::new();
    for front in members.chunk_by(|i, j| ranks[*i] == ranks[*j]) {
        for objective in 0..scores.objectives() {
            keyed.clear();
            keyed.extend(front.iter().map(|i| (scores.costs(*i)[objective], *i)));
            let by_cost = |(a, i): &(f64, usize), (b, j): &(f64, usize)| a.total_cmp(b).then(i.cmp(j));
            if keyed.len() > LARGE_FRONT {
                keyed.par_sort_unstable_by(by_cost);
            } else {
                keyed.sort_unstable_by(by_cost);
            }
            add_gaps(&keyed, &mut distance);
        }
    }
    distance
}

/// Adds the gaps of one objective to the distances of a front, sorted by that objective.
fn add_gaps(sorted: &[(f64, usize)], distance: &mut [f64]) {
    // Halves, so that no difference of finite costs overflows.
    let gap = |high: f64, low: f64| 0.5 * high - 0.5 * low;
    let (smallest, first) = sorted[0];
    let (largest, last) = sorted[sorted.len() - 1];
    distance[first] = f64::INFINITY;
    distance[last] = f64::INFINITY;
    let range = gap(largest, smallest);
    if range > 0.0 {
        for three in sorted.windows(3) {
            distance[three[1].1] += gap(three[2].0, three[0].0) / range;
        }
    }
}
