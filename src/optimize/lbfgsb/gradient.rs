//! Where a quasi-Newton method takes its gradients from.

use super::usable;
use crate::optimize::Space;

/// Rounding of a cost, relative: a sum of many terms keeps all but the last few bits.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Second difference \[nats\] that a step aims at. In standard errors the step is then 0.014, so that the gradient is off by
/// some 3e-5 of 1 / standard error by the third derivative and, of a cost of 1e3 nats, by 2e-10 by rounding: a predicted
/// gain is then right to 1e-9 nats.
const RISE: f64 = 2e-4;
/// Or this many times the rounding of the cost, where that is more.
const ABOVE_ROUNDING: f64 = 2e4;

/// The slope of a cost at a point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Slope {
    /// First derivatives by search coordinate.
    pub gradient: Vec<f64>,
    /// Second derivatives along each coordinate, 0 where rounding leaves none; empty = the source does not know them.
    pub curvature: Vec<f64>,
}

/// A source of gradients: differences of costs, or derivatives themselves.
pub trait Gradient {
    /// Points of which it needs the cost for the slope at `x`, beside that at `x` itself.
    fn points(&mut self, x: &[f64]) -> Vec<Vec<f64>>;

    /// Offsets of its two points along each coordinate; empty where it needs none.
    fn offsets(&self) -> &[[f64; 2]] {
        &[]
    }

    /// The slope at `x`, where the cost is `cost`, from those of the points that [`Self::points`] gave last.
    fn slope(&mut self, x: &[f64], cost: f64, costs: &[f64]) -> Slope;
}

/// Central differences, one-sided ones of second order at a bound: two points a coordinate, none outside the box. The
/// steps follow the curvature from one point to the next.
#[derive(Debug, Clone)]
pub struct Differences {
    space: Space,
    steps: Vec<f64>,
    longest: Vec<f64>,
    nat: f64,
    /// Offsets of the two points along each coordinate.
    offsets: Vec<[f64; 2]>,
}

impl Differences {
    /// With these first steps, never longer than a tenth of `units`; `nat` is what one nat is in the cost's own unit.
    #[must_use]
    pub fn new(space: &Space, first: &[f64], units: &[f64], nat: f64) -> Self {
        let longest: Vec<f64> = units.iter().map(|unit| 0.1 * unit).collect();
        let steps = first.iter().zip(&longest).map(|(first, longest)| first.min(*longest)).collect();
        Self { space: space.clone(), steps, longest, nat, offsets: Vec::new() }
    }

    /// Two places beside `x[d]` in the box.
    fn beside(&self, x: &[f64], d: usize) -> [f64; 2] {
        let (down, up) = (x[d] - self.space.lower[d], self.space.upper[d] - x[d]);
        let h = self.steps[d].min(0.25 * (down + up));
        if up >= h && down >= h {
            [h, -h]
        } else if up >= down {
            [h, 2.0 * h]
        } else {
            [-h, -2.0 * h]
        }
    }

    /// The next step along coordinate `d`, after one of `h` with this second difference.
    fn adapt(&mut self, d: usize, h: f64, rise: f64, goal: f64) {
        let factor = if rise > 0.0 { (goal / rise).sqrt().clamp(0.125, 8.0) } else { 8.0 };
        self.steps[d] = (h * factor).min(self.longest[d]);
    }
}

impl Gradient for Differences {
    fn points(&mut self, x: &[f64]) -> Vec<Vec<f64>> {
        self.offsets = (0..x.len()).map(|d| self.beside(x, d)).collect();
        let shifted = |(d, offset): (usize, f64)| {
            let mut point = x.to_vec();
            point[d] += offset;
            point
        };
        self.offsets.iter().enumerate().flat_map(|(d, [a, b])| [(d, *a), (d, *b)]).map(shifted).collect()
    }

    fn offsets(&self) -> &[[f64; 2]] {
        &self.offsets
    }

    fn slope(&mut self, x: &[f64], cost: f64, costs: &[f64]) -> Slope {
        let mut slope = Slope { gradient: vec![0.0; x.len()], curvature: vec![0.0; x.len()] };
        let rounding = ROUNDING * cost.abs();
        let goal = (RISE * self.nat).max(ABOVE_ROUNDING * rounding);
        for (d, pair) in costs.chunks_exact(2).enumerate() {
            let [a, b] = self.offsets[d];
            if a == 0.0 {
                continue;
            }
            let (da, db) = ((pair[0] - cost) / a, (pair[1] - cost) / b);
            (slope.gradient[d], slope.curvature[d]) = match (usable(pair[0]), usable(pair[1])) {
                // The line through the three points: its slope at x and its second derivative.
                (true, true) => ((da * b - db * a) / (b - a), 2.0 * (db - da) / (b - a)),
                (true, false) => (da, 0.0),
                (false, true) => (db, 0.0),
                (false, false) => (0.0, 0.0),
            };
            if usable(pair[0]) && usable(pair[1]) {
                let rise = slope.curvature[d].abs() * a * a;
                if rise <= 4.0 * rounding {
                    slope.curvature[d] = 0.0;
                }
                self.adapt(d, a.abs(), rise, goal);
            } else {
                self.steps[d] = 0.125 * a.abs();
            }
        }
        slope
    }
}
