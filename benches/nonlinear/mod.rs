//! The baseline of the nonlinear filters: textbook extended and unscented filters on nalgebra's static matrices, f64, one
//! candidate at a time, as a careful engineer would write them in an afternoon: Jacobians by hand, a joint update with the
//! closed inverse of S, nothing allocated in the time loop. They share no code with kfgpu.

use nalgebra::{Matrix2, Matrix2x4, Matrix4, Matrix4x2, Vector2, Vector4};
use std::f64::consts::{PI, TAU};

/// The log of `workloads/range_bearing.csv`, steps of 1 s.
pub(crate) struct Baseline {
    pub(crate) z: Vec<Vector2<f64>>,
}

/// x' = F x + w, z = (range, bearing) + v for one candidate.
struct Model {
    f: Matrix4<f64>,
    q: Matrix4<f64>,
    r: Matrix2<f64>,
}

fn wrap(a: f64) -> f64 {
    a - TAU * ((a + PI) / TAU).floor()
}

fn h(x: &Vector4<f64>) -> Vector2<f64> {
    Vector2::new(x[0].hypot(x[1]), x[1].atan2(x[0]))
}

impl Model {
    fn new(c: &[f64]) -> Self {
        let mut f = Matrix4::identity();
        (f[(0, 2)], f[(1, 3)]) = (1.0, 1.0);
        let mut q = Matrix4::zeros();
        for axis in 0..2 {
            q[(axis, axis)] = c[0] / 3.0;
            (q[(axis, axis + 2)], q[(axis + 2, axis)]) = (c[0] / 2.0, c[0] / 2.0);
            q[(axis + 2, axis + 2)] = c[0];
        }
        Self { f, q, r: Matrix2::from_diagonal(&Vector2::new(c[1], c[2])) }
    }
}

/// (S^-1, half the log-likelihood of the row times -2) of an innovation.
fn score(s: &Matrix2<f64>, nu: &Vector2<f64>) -> (Matrix2<f64>, f64) {
    let det = s[(0, 0)] * s[(1, 1)] - s[(0, 1)] * s[(1, 0)];
    let inverse = Matrix2::new(s[(1, 1)], -s[(0, 1)], -s[(1, 0)], s[(0, 0)]) / det;
    let nis = (nu.transpose() * inverse * nu)[0];
    (inverse, 2.0 * TAU.ln() + det.ln() + nis)
}

impl Baseline {
    /// nll of a candidate by the extended filter.
    pub(crate) fn extended(&self, candidate: &[f64]) -> f64 {
        let model = Model::new(candidate);
        let (mut x, mut p) = Self::start();
        let mut total = 0.0;
        for z in &self.z {
            let range = x[0].hypot(x[1]);
            let square = range * range;
            #[rustfmt::skip]
            let jacobian = Matrix2x4::new(
                x[0] / range, x[1] / range, 0.0, 0.0,
                -x[1] / square, x[0] / square, 0.0, 0.0,
            );
            let mut nu = z - h(&x);
            nu[1] = wrap(nu[1]);
            let ph = p * jacobian.transpose();
            let s = jacobian * ph + model.r;
            let (inverse, row) = score(&s, &nu);
            total += row;
            let k = ph * inverse;
            x += k * nu;
            p -= k * ph.transpose();
            x = model.f * x;
            p = model.f * p * model.f.transpose() + model.q;
        }
        0.5 * total
    }

    /// nll of a candidate by the unscented filter, alpha 1, beta 2, kappa 0, points redrawn before the update.
    pub(crate) fn unscented(&self, candidate: &[f64]) -> f64 {
        const N: usize = 4;
        let model = Model::new(candidate);
        let (mut x, mut p) = Self::start();
        let (centre, other) = (2.0, 0.5 / N as f64);
        let mut total = 0.0;
        for z in &self.z {
            let at = points(&x, &p);
            let seen = at.map(|point| h(&point));
            let mut mean = Vector2::zeros();
            for point in &seen[1..] {
                let mut moved = point - seen[0];
                moved[1] = wrap(moved[1]);
                mean += other * moved;
            }
            mean += seen[0];
            let (mut s, mut cross) = (model.r, Matrix4x2::zeros());
            for (i, (point, seen)) in at.iter().zip(&seen).enumerate() {
                let weight = if i == 0 { centre } else { other };
                let mut e = seen - mean;
                e[1] = wrap(e[1]);
                s += weight * e * e.transpose();
                cross += weight * (point - x) * e.transpose();
            }
            let mut nu = z - mean;
            nu[1] = wrap(nu[1]);
            let (inverse, row) = score(&s, &nu);
            total += row;
            let k = cross * inverse;
            x += k * nu;
            p -= k * s * k.transpose();
            // f is linear, and points go through it as any others.
            let moved = points(&x, &p).map(|point| model.f * point);
            let mut next = Vector4::zeros();
            moved[1..].iter().for_each(|point| next += other * point);
            p = model.q;
            for (i, point) in moved.iter().enumerate() {
                let (weight, e) = (if i == 0 { centre } else { other }, point - next);
                p += weight * e * e.transpose();
            }
            x = next;
        }
        0.5 * total
    }

    fn start() -> (Vector4<f64>, Matrix4<f64>) {
        (Vector4::new(-4000.0, 1500.0, 0.0, 0.0), Matrix4::from_diagonal(&Vector4::new(1e4, 1e4, 100.0, 100.0)))
    }
}

/// x, x + 2 L_j, x - 2 L_j.
fn points(x: &Vector4<f64>, p: &Matrix4<f64>) -> [Vector4<f64>; 9] {
    let root = p.cholesky().map_or_else(Matrix4::zeros, |c| c.unpack()) * 2.0;
    let mut points = [*x; 9];
    for j in 0..4 {
        points[1 + j] += root.column(j);
        points[5 + j] -= root.column(j);
    }
    points
}
