//! The two ends of a data set's front by dense grids: the R of least f1, and that of least f2.

use super::scenario::RANGE;
use crate::evaluate::{Evaluator, Population};

/// Points of a grid.
const POINTS: usize = 4491;

/// (f1, f2) at some R.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    pub(super) r: f64,
    pub(super) f: [f64; 2],
}

/// `points` R from `low` to `high`, evenly spaced, with their objectives; those that failed are left out.
pub(super) fn curve(evaluator: &mut dyn Evaluator, [low, high]: [f64; 2], points: usize) -> Vec<Point> {
    let step = (high - low) / (points - 1) as f64;
    let grid: Vec<f64> = (0..points).map(|i| (low + i as f64 * step).min(high)).collect();
    let costs = evaluator.evaluate(&Population::from_rows(1, grid.clone()));
    let usable = grid.into_iter().enumerate().filter(|(i, _)| costs.status(*i).is_ok());
    usable.map(|(i, r)| Point { r, f: [costs.costs(i)[0], costs.costs(i)[1]] }).collect()
}

/// The R of least f1 and of least f2: the best of a grid of 0.01 over the whole range, then of a finer one around it.
/// `None` if every R fails.
pub(super) fn ends(evaluator: &mut dyn Evaluator) -> Option<[f64; 2]> {
    let coarse = curve(evaluator, RANGE, POINTS);
    let step = (RANGE[1] - RANGE[0]) / (POINTS - 1) as f64;
    let mut end = |which: usize| {
        let best = |points: &[Point]| points.iter().min_by(|a, b| a.f[which].total_cmp(&b.f[which])).map(|p| p.r);
        let r = best(&coarse)?;
        best(&curve(evaluator, [(r - step).max(RANGE[0]), (r + step).min(RANGE[1])], 201))
    };
    Some([end(0)?, end(1)?])
}
