//! Gradient and Hessian of a cost by central differences.

use nalgebra::{DMatrix, DVector};

/// Rounding of a cost, relative: a sum of many terms keeps all but the last few bits.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Cost difference \[nats\] that a step along one axis aims at. The error by the fourth derivative grows with it, that by
/// rounding falls: at a cost of 1e3 both are near 1e-6 of the curvature (`the_nile_has_the_errors_of_dense_algebra`).
const RISE: f64 = 1e-4;
/// Tries to reach that difference.
const TRIES: usize = 6;

/// Derivatives of a cost at a point, in search coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curvature {
    pub(super) gradient: DVector<f64>,
    pub(super) hessian: DMatrix<f64>,
}

/// A coordinate: where it stands, its first step and the longest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    pub(super) at: f64,
    pub(super) first: f64,
    pub(super) longest: f64,
}

/// Costs at many points in search coordinates; `None` where there is none.
pub(super) type Costs<'a> = dyn FnMut(&[Vec<f64>]) -> Vec<Option<f64>> + 'a;

/// The centre, moved along some axes.
type Shifted<'a> = dyn Fn(&[(usize, f64)]) -> Vec<f64> + 'a;

/// Evaluations of the cost that [`Curvature::of`] takes in `d` coordinates, where the second step along each axis fits.
pub(super) const fn evaluations(d: usize) -> usize {
    1 + d * (d + 3)
}

/// Costs a step away on both sides.
#[derive(Debug, Clone, Copy)]
struct Sides {
    step: f64,
    up: f64,
    down: f64,
}

impl Curvature {
    /// Three points along each axis, and two more in each plane: the error of every entry is of second order. The points of
    /// all axes are scored together, and so are those of all planes. `None` where the cost is not defined around the point.
    pub(super) fn of(costs: &mut Costs<'_>, axes: &[Axis]) -> Option<Self> {
        let centre: Vec<f64> = axes.iter().map(|axis| axis.at).collect();
        let shifted = |shifts: &[(usize, f64)]| {
            let mut point = centre.clone();
            shifts.iter().for_each(|&(i, shift)| point[i] += shift);
            point
        };
        let middle = (*costs(std::slice::from_ref(&centre)).first()?)?;
        let sides = sides(costs, &shifted, middle, axes)?;
        let d = axes.len();
        let planes: Vec<(usize, usize)> = (0..d).flat_map(|i| (0..i).map(move |j| (i, j))).collect();
        let both = |&(i, j): &(usize, usize)| {
            let (a, b) = (sides[i].step, sides[j].step);
            [shifted(&[(i, a), (j, b)]), shifted(&[(i, -a), (j, -b)])]
        };
        let corners: Vec<f64> =
            costs(&planes.iter().flat_map(both).collect::<Vec<_>>()).into_iter().collect::<Option<_>>()?;
        let mut hessian = DMatrix::from_diagonal(&DVector::from_iterator(
            d,
            sides.iter().map(|s| (s.up - 2.0 * middle + s.down) / (s.step * s.step)),
        ));
        for (&(i, j), corners) in planes.iter().zip(corners.chunks_exact(2)) {
            let (a, b) = (sides[i], sides[j]);
            let bent = corners[0] + corners[1] - a.up - a.down - b.up - b.down + 2.0 * middle;
            hessian[(i, j)] = bent / (2.0 * a.step * b.step);
            hessian[(j, i)] = hessian[(i, j)];
        }
        let gradient = DVector::from_iterator(d, sides.iter().map(|s| (s.up - s.down) / (2.0 * s.step)));
        Some(Self { gradient, hessian })
    }
}

/// Finds the step along each axis whose second difference is about [`RISE`], or enough to stand out of rounding.
fn sides(costs: &mut Costs<'_>, shifted: &Shifted<'_>, middle: f64, axes: &[Axis]) -> Option<Vec<Sides>> {
    let goal = 2.0 * RISE.max(1e4 * ROUNDING * middle.abs());
    let mut found: Vec<Option<Sides>> = vec![None; axes.len()];
    let mut steps: Vec<f64> = axes.iter().map(|axis| axis.first.min(axis.longest)).collect();
    for tries in 1..=TRIES {
        let open: Vec<usize> = (0..axes.len()).filter(|i| found[*i].is_none()).collect();
        if open.is_empty() {
            break;
        }
        let pair = |&i: &usize| [shifted(&[(i, steps[i])]), shifted(&[(i, -steps[i])])];
        let scored = costs(&open.iter().flat_map(pair).collect::<Vec<_>>());
        for (&i, pair) in open.iter().zip(scored.chunks_exact(2)) {
            let (step, longest) = (steps[i], axes[i].longest);
            let rise = match (pair[0], pair[1]) {
                (Some(up), Some(down)) => (up - 2.0 * middle + down).abs(),
                // Beyond what the filter can run with: a shorter step.
                _ => f64::INFINITY,
            };
            let enough = (0.25 * goal..4.0 * goal).contains(&rise) || (rise < goal && step >= longest);
            if enough || tries == TRIES {
                found[i] = Some(Sides { step, up: pair[0]?, down: pair[1]? });
            }
            steps[i] = (step * (goal / rise).sqrt().clamp(1e-3, 1e2)).min(longest);
        }
    }
    found.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curvature(cost: &dyn Fn(&[f64]) -> Option<f64>, at: &[f64]) -> Option<Curvature> {
        Curvature::of(&mut |points| points.iter().map(|point| cost(point)).collect(), &axes(at))
    }

    fn axes(at: &[f64]) -> Vec<Axis> {
        at.iter().map(|at| Axis { at: *at, first: 0.01, longest: 10.0 }).collect()
    }

    /// cosh and a product, whose derivatives are known, on a large constant as nll has one.
    #[test]
    fn derivatives_of_known_functions() {
        for (scale, constant, tolerance) in [(1.0, 0.0, 1e-4), (50.0, 700.0, 1e-5), (1e6, 1e6, 1e-5), (1e-3, 0.0, 1e-1)]
        {
            let cost =
                move |x: &[f64]| Some(constant + scale * (x[0].cosh() + (x[0] * x[1]).exp() + 2.0 * x[1].cosh()));
            let found = curvature(&cost, &[0.3, -0.2]).expect("defined everywhere");
            let product = (-0.06f64).exp();
            let expected = DMatrix::from_row_slice(
                2,
                2,
                &[
                    0.3f64.cosh() + 0.04 * product,
                    (1.0 - 0.06) * product,
                    (1.0 - 0.06) * product,
                    2.0 * 0.2f64.cosh() + 0.09 * product,
                ],
            );
            let error = (&found.hessian / scale - &expected).amax();
            println!("scale {scale:e} on {constant:e}: error of the Hessian {error:.1e}");
            assert!(error < tolerance, "scale {scale:e}: {} instead of {expected}", found.hessian / scale);
            let slope = 0.3f64.sinh() - 0.2 * product;
            assert!((found.gradient[0] / scale - slope).abs() < tolerance, "gradient {}", found.gradient);
        }
    }

    #[test]
    fn a_flat_axis_takes_its_longest_step_and_a_wall_shortens_one() {
        let cost = |x: &[f64]| Some(1_000.0 + x[0] * x[0]);
        let found = curvature(&cost, &[0.0, 5.0]).expect("defined everywhere");
        assert!(found.hessian[(1, 1)].abs() < 1e-10 && (found.hessian[(0, 0)] - 2.0).abs() < 1e-5, "{found:?}");
        let wall = |x: &[f64]| (x[0].abs() < 1e-4).then(|| 1.0 + 1e6 * x[0] * x[0]);
        let found = curvature(&wall, &[0.0]).expect("defined close to the point");
        assert!((found.hessian[(0, 0)] / 2e6 - 1.0).abs() < 1e-6, "{found:?}");
        assert_eq!(curvature(&|_: &[f64]| None, &[0.0]), None, "defined nowhere");
    }
}
