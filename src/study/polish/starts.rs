//! Where local searches start: distinct, so that not all of them lie in the basin that a swarm fell into.

use super::Place;
use crate::evaluate::Population;
use crate::optimize::lbfgsb::{Differences, Lbfgsb, Options};
use crate::optimize::nelder_mead::{self, NelderMead};
use crate::optimize::{OptimizeError, Space};
use crate::random::{Purpose, Stream};

/// Candidates nearer than this share of a unit in every coordinate are one start.
const DISTINCT: f64 = 0.5;
/// Niches taken from the archive.
const NICHES: usize = 2;

/// Fresh points of the first population's box: a few beside what the search found; from five dimensions on a swarm collapses
/// on a shelf often enough that the points must find the optimum themselves.
const fn fresh_points(dimension: usize) -> usize {
    match dimension {
        0..=4 => 2,
        5..=11 => 4,
        _ => 6,
    }
}

impl Place<'_> {
    /// Positions: that of the winner, the user's start, distinct members of the archive, and fresh points.
    pub(super) fn starts(&self, winner: &[f64]) -> Vec<Vec<f64>> {
        let space = self.coordinates.space();
        let units = self.coordinates.units(winner);
        let mut starts = vec![self.coordinates.position(winner)];
        let near =
            |a: &[f64], b: &[f64]| a.iter().zip(b).zip(&units).all(|((a, b), unit)| (a - b).abs() < DISTINCT * unit);
        starts.extend(space.seeds.iter().filter(|seed| **seed != starts[0]).cloned().collect::<Vec<_>>());
        for member in self.record.archive.members() {
            let position = self.coordinates.position(&member.candidate);
            if starts.len() < 2 + NICHES && !starts.iter().any(|start| near(start, &position)) {
                starts.push(position);
            }
        }
        starts.extend(spread(&space, fresh_points(space.dimension()), self.tune.seed));
        starts
    }

    /// The quasi-Newton search from a position, for a cost in which a nat is `nat`.
    pub(super) fn quasi_newton(&self, start: &[f64], nat: f64) -> Result<Lbfgsb, OptimizeError> {
        let space = self.coordinates.space();
        let candidate = self.coordinates.candidates(&Population::from_rows(start.len(), start.to_vec()));
        let (units, steps) = (self.coordinates.units(candidate.row(0)), self.coordinates.steps(candidate.row(0)));
        let source = Box::new(Differences::new(&space, &steps, &units, nat));
        // From random points of up to 32 parameters at most 100 steps were taken, of one batch or two each.
        let evaluations = 300 * (2 * start.len() + 4);
        Lbfgsb::new(&space, start, source, Options { evaluations, nat, units })
    }

    /// The simplex search from a position, its first edges as far as the finalists lie from there, within limits: a
    /// converged search needs a small simplex.
    pub(super) fn simplex(&self, start: &[f64], others: &[Vec<f64>]) -> Result<NelderMead, OptimizeError> {
        let space = self.coordinates.space();
        let edges = edges(&space, start, others);
        // In two coordinates few evaluations converge even at four an iteration, with a quarter of the calls. In three they
        // no longer do: measured on the ellipsoid from 2e-2, 3e-11 at four an iteration against 7e-21 one at a time.
        let speculative = start.len() <= 2;
        let evaluations = (300 * start.len()).max(600);
        NelderMead::new(&space, start, &edges, nelder_mead::Options { evaluations, speculative, ..Default::default() })
    }
}

/// `count` points of `init`, one in each of as many slices of every coordinate (a Latin hypercube: M. D. McKay,
/// R. J. Beckman, W. J. Conover, Technometrics 21 (1979), doi 10.2307/1268522).
fn spread(space: &Space, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; space.dimension()]; count];
    for (d, [low, high]) in space.init.iter().enumerate() {
        let mut stream = Stream::new(seed, Purpose::Polish, 0, d as u64);
        let mut slices: Vec<usize> = (0..count).collect();
        (1..count).rev().for_each(|i| slices.swap(i, stream.below(i + 1)));
        for (point, slice) in points.iter_mut().zip(slices) {
            point[d] = low + (high - low) * (slice as f64 + stream.uniform()) / count as f64;
        }
    }
    points.iter_mut().for_each(|point| space.clip(point));
    points
}

/// The first edges of the polishing simplex, as a share of `init`, lie in this range.
const EDGE_SHARE: [f64; 2] = [1e-4, 1e-2];

fn edges(space: &Space, start: &[f64], others: &[Vec<f64>]) -> Vec<f64> {
    let mut reach = vec![0.0_f64; start.len()];
    for position in others {
        for ((reach, x), start) in reach.iter_mut().zip(position).zip(start) {
            *reach = reach.max((x - start).abs());
        }
    }
    let limited = |((reach, [low, high]), x): ((f64, &[f64; 2]), &f64)| {
        let width = if high > low { high - low } else { x.abs().max(1.0) };
        reach.max(EDGE_SHARE[0] * width).min(EDGE_SHARE[1] * width)
    };
    reach.into_iter().zip(&space.init).zip(start).map(limited).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_simplex_fits_the_finalists() {
        let space = Space::boxed(&[[0.0, 100.0], [0.0, 100.0], [0.0, 100.0]]);
        assert_eq!(edges(&space, &[50.0; 3], &[vec![50.0, 49.5, 90.0]]), [0.01, 0.5, 1.0]);
    }

    #[test]
    fn fresh_points_share_no_slice_of_any_coordinate() {
        let space = Space::boxed(&[[0.0, 6.0], [-6.0, 0.0], [2.0, 2.0]]);
        let points = spread(&space, 6, 7);
        for d in 0..2 {
            let mut slices: Vec<f64> = points.iter().map(|p| (p[d] - space.lower[d]).floor()).collect();
            slices.sort_by(f64::total_cmp);
            assert_eq!(slices, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], "coordinate {d}: {points:?}");
        }
        assert!(
            points.iter().all(|p| p[2].total_cmp(&2.0).is_eq()) && points != spread(&space, 6, 8),
            "the seed decides"
        );
    }
}
