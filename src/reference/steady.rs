//! The steady state of the covariance recursion.

use nalgebra::{Cholesky, DMatrix};

use super::estimate::symmetrise;
use super::matrices::Matrices;
use crate::model::Problem;

/// Doublings before giving up: 2^40 steps of the recursion.
const DOUBLINGS: usize = 40;
/// Relative change and residual that count as converged.
const TOLERANCE: f64 = 1e-12;

/// Gain and covariances that a filter with constant matrices settles to.
#[derive(Debug, Clone, PartialEq)]
pub struct Steady {
    /// Gain, n x m.
    pub k: DMatrix<f64>,
    /// Covariance before each measurement, n x n.
    pub p_prior: DMatrix<f64>,
    /// Covariance after each measurement, n x n.
    pub p_posterior: DMatrix<f64>,
}

/// The steady state for intervals of `dt` \[s\] with every measurement present and inputs at zero; `None` when f or h is not
/// affine, R is singular, or the recursion does not settle (an unstable state that is not seen, or one that nothing drives).
///
/// Structured doubling for P = F P F' - F P H' (H P H' + R)^-1 H P F' + Q: step j of it is step 2^j of the recursion
/// (Chu, Fan, Lin and Wang 2004, doi:10.1080/00207170410001714988). One plain step checks the result.
///
/// # Panics
/// If `candidate` does not have one value per searched parameter.
#[must_use]
pub fn steady_gain(problem: &Problem, candidate: &[f64], dt: f64) -> Option<Steady> {
    if !problem.model.is_affine() {
        return None;
    }
    let matrices = Matrices::of(problem, candidate, dt);
    let p_prior = doubling(&matrices)?;
    let steady = update(&matrices, &p_prior)?;
    let mut next = &matrices.f * &steady.p_posterior * matrices.f.transpose() + &matrices.q;
    symmetrise(&mut next);
    close(&next, &p_prior, 1e3 * TOLERANCE).then_some(steady)
}

fn doubling(Matrices { f, h, q, r }: &Matrices) -> Option<DMatrix<f64>> {
    let n = f.nrows();
    let mut a = f.transpose();
    let mut g = h.transpose() * Cholesky::new(r.clone())?.solve(h);
    let mut p = q.clone();
    for _ in 0..DOUBLINGS {
        let w = (DMatrix::identity(n, n) + &g * &p).lu();
        let (w_a, w_g) = (w.solve(&a)?, w.solve(&g)?);
        let mut next = &p + a.transpose() * &p * &w_a;
        symmetrise(&mut next);
        g += &a * w_g * a.transpose();
        symmetrise(&mut g);
        a = &a * w_a;
        if !next.iter().chain(a.iter()).all(|v| v.is_finite()) {
            return None;
        }
        // `a` tends to the transition of the closed loop over 2^j steps: it vanishes only where the filter is stable.
        let settled = close(&next, &p, TOLERANCE) && a.amax() <= TOLERANCE.sqrt();
        p = next;
        if settled {
            return Some(p);
        }
    }
    None
}

fn update(Matrices { h, r, .. }: &Matrices, p_prior: &DMatrix<f64>) -> Option<Steady> {
    let n = p_prior.nrows();
    let mut s = h * p_prior * h.transpose() + r;
    symmetrise(&mut s);
    let k = Cholesky::new(s)?.solve(&(h * p_prior)).transpose();
    let a = DMatrix::identity(n, n) - &k * h;
    let mut p_posterior = &a * p_prior * a.transpose() + &k * r * k.transpose();
    symmetrise(&mut p_posterior);
    Some(Steady { k, p_prior: p_prior.clone(), p_posterior })
}

fn close(a: &DMatrix<f64>, b: &DMatrix<f64>, tolerance: f64) -> bool {
    (a - b).amax() <= tolerance * a.amax()
}
