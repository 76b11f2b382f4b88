//! How much of the likelihood to show: on a long log, an optimum is a needle in any range that a user thinks of.

use super::{RISE, Range, costs};
use crate::evaluate::{Evaluator, Population};

/// Steps from the winner to an end of a range that are looked at, each a fifth of the one before.
const STEPS: i32 = 8;
const RATIO: f64 = 5.0;

/// Ranges that end where `nll` has risen by about [`RISE`] along each parameter, or where they ended before; wide enough
/// for the baseline where that is no higher.
pub(super) fn narrowed(
    ranges: Vec<Range>,
    winner: &[f64],
    baseline: &[f64],
    evaluator: &mut dyn Evaluator,
) -> Vec<Range> {
    let offsets: Vec<f64> = (0..STEPS).map(|k| RATIO.powi(-k)).collect();
    let mut rows = [winner, baseline].concat();
    for (i, range) in ranges.iter().enumerate() {
        for end in [range.low, range.high] {
            let (from, to) = (range.place(winner[i]), range.place(end));
            rows.extend(offsets.iter().flat_map(|share| {
                let mut row = winner.to_vec();
                row[i] = range.at(from + share * (to - from));
                row
            }));
        }
    }
    let found = costs(evaluator, Population::from_rows(winner.len(), rows));
    let rises: Vec<f64> = found.iter().map(|cost| cost - found[0]).collect();
    let near = rises[1] <= RISE;
    let sides = rises[2..].chunks_exact(2 * offsets.len());
    let narrowed = |(range, rises): (Range, &[f64])| {
        let (left, right) = rises.split_at(offsets.len());
        range.within([width(left), width(right)], near)
    };
    ranges.into_iter().zip(sides).map(narrowed).collect()
}

/// The share of the way to the end of a range at which the cost has risen by [`RISE`], from the rises at the whole way,
/// a fifth of it and so on; between two of these it rises as a parabola does. A candidate that failed is above all.
fn width(rises: &[f64]) -> f64 {
    let is_low = |rise: f64| rise <= RISE;
    let Some(k) = rises.iter().position(|rise| is_low(*rise)) else { return RATIO.powi(1 - STEPS) };
    let (inner, outer) = (RATIO.powi(-(k as i32)), RATIO.powi(1 - k as i32));
    if k == 0 { 1.0 } else { (inner * (RISE / rises[k].max(1e-9)).sqrt()).clamp(inner, outer) }
}

impl Range {
    /// The parts of the ways from the winner to both ends that `shares` say, and the baseline with some room where asked.
    fn within(self, shares: [f64; 2], with_baseline: bool) -> Self {
        let middle = self.place(self.winner);
        let [mut low, mut high] = [self.low, self.high].map(|end| self.place(end));
        (low, high) = (middle + shares[0] * (low - middle), middle + shares[1] * (high - middle));
        if with_baseline {
            let (place, room) = (self.place(self.baseline), 0.1 * (high - low));
            (low, high) = (low.min(place - room), high.max(place + room));
        }
        let (low, high) = (self.at(low), self.at(high));
        if low < high { Self { low, high, ..self } } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola of curvature c rises by 20 at sqrt(20 / c) of the way.
    #[test]
    fn a_parabola_is_shown_up_to_the_rise() {
        for c in [1.0, 19.0, 21.0, 1e3, 1e6, 1e9] {
            let rises: Vec<f64> = (0..STEPS).map(|k| c * RATIO.powi(-2 * k)).collect();
            let expected = (RISE / c).sqrt().min(1.0);
            assert!((width(&rises) / expected - 1.0).abs() < 1e-9, "{c}: {} for {expected}", width(&rises));
        }
        let failed = [f64::NAN, f64::NAN, 3.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        assert!((0.04..=0.2).contains(&width(&failed)), "up to where it fails: {}", width(&failed));
        assert!(width(&[1e30; STEPS as usize]) < 2e-5, "a needle");
    }
}
