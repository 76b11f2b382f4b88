//! Fixed-interval smoothing: the estimate of every row by all measurements of its trajectory, later ones too.
//!
//! Rauch, Tung and Striebel (1965, doi:10.2514/3.3166), backwards from the last row, where both estimates are the same:
//!
//! ```text
//! C  = P F' pinv(F P F' + Q)
//! xs = x + C (xs_next - x_next)                              x_next: the filter's prediction from this row
//! Ps = (I - C F) P (I - C F)' + C (Q + Ps_next) C'           = P + C (Ps_next - P_next) C'
//! ```
//!
//! The second form of Ps is the published one. The first is the same matrix as a sum of covariances: with a diffuse P0 it
//! loses digits as P0/R and not as its square (measured in `tests/golden_reference/smoother.rs`), and no variance can
//! come out negative. Predictions may be singular (an exact x0, a state without noise): where the factor of P_next,
//! scaled to a unit diagonal, does not exist, its pseudo-inverse takes its place. It is exact, because P F' has no part
//! outside the range of P_next.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::kalman::{Estimate, Transition, count, symmetrise};
use super::matrices::Formulas;
use super::run::visit;
use super::{Cause, Failure};
use crate::data::{Log, Trajectory};
use crate::model::{FilterKind, Problem};

/// The estimate of one row by all measurements of its trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Row of the trajectory.
    pub row: usize,
    /// Its time \[s\].
    pub time: f64,
    /// State and covariance.
    pub estimate: Estimate,
}

/// Smooths the run of `candidate` (searched parameters in their own units): one list per trajectory of the log, with the
/// rows of [`super::Run::trajectories`]. It keeps n² + n numbers a row, and twice as many while it runs.
///
/// # Errors
/// As [`super::run`].
///
/// # Panics
/// If `candidate` does not have one value per searched parameter.
pub fn smooth(problem: &Problem, log: &Log, candidate: &[f64]) -> Result<Vec<Vec<Smoothed>>, Failure> {
    let mut passes: Vec<Vec<Pass>> = log.trajectories.iter().map(|_| Vec::new()).collect();
    visit(problem, log, candidate, &mut |trajectory, step| {
        let (prior, estimate) = (step.prior.clone(), step.posterior.clone());
        passes[trajectory].push(Pass { prior, smoothed: Smoothed { row: step.row, time: step.time, estimate } });
    })?;
    let mut smoother = Smoother::new(problem, candidate);
    for (index, (passes, trajectory)) in passes.iter_mut().zip(&log.trajectories).enumerate() {
        smoother.backwards(passes, trajectory).map_err(|(row, what)| Failure::at(log, index, row, what))?;
    }
    Ok(passes.into_iter().map(|passes| passes.into_iter().map(|pass| pass.smoothed).collect()).collect())
}

/// A row: its prior, and its posterior until it is smoothed.
struct Pass {
    prior: Estimate,
    smoothed: Smoothed,
}

struct Smoother {
    formulas: Formulas,
    transition: Transition,
}

impl Smoother {
    fn new(problem: &Problem, candidate: &[f64]) -> Self {
        // Q of the formulas is the Q that was filtered with.
        match problem.filter {
            FilterKind::Kalman => {}
        }
        let formulas = Formulas::new(&problem.model, problem.parameters.resolve(candidate));
        let transition = Transition::new(formulas.n);
        Self { formulas, transition }
    }

    /// Smooths one trajectory, last row first; an error comes with its row.
    fn backwards(&mut self, passes: &mut [Pass], trajectory: &Trajectory) -> Result<(), (usize, Cause)> {
        for k in (1..passes.len()).rev() {
            let [now, next] = &mut passes[k - 1..=k] else { continue };
            let row = now.smoothed.row;
            let Some(dt) = trajectory.dt(row) else { continue };
            self.transition.prepare(&mut self.formulas, dt, trajectory.u.row(row));
            self.step(&mut now.smoothed.estimate, next);
            now.smoothed.estimate.check().map_err(|cause| (row, cause))?;
        }
        Ok(())
    }

    /// Posterior to smoothed of one row; `next` is smoothed.
    fn step(&self, now: &mut Estimate, next: &Pass) {
        let Transition { f, q, .. } = &self.transition;
        let n = q.nrows();
        let c = solve(&next.prior.p, &f.matrix * &now.p).transpose();
        now.x += &c * (&next.smoothed.estimate.x - &next.prior.x);
        let a = DMatrix::identity(n, n) - &c * &f.matrix;
        now.p = &a * &now.p * a.transpose() + &c * (q + &next.smoothed.estimate.p) * c.transpose();
        symmetrise(&mut now.p);
    }
}

/// pinv(P) B for a covariance P.
fn solve(p: &DMatrix<f64>, mut b: DMatrix<f64>) -> DMatrix<f64> {
    let n = p.nrows();
    // Units of the states must not decide what counts as singular.
    let scale = p.diagonal().map(|variance| if variance > 0.0 { variance.sqrt().recip() } else { 0.0 });
    let scaled = DMatrix::from_fn(n, n, |i, j| p[(i, j)] * scale[i] * scale[j]);
    scale_rows(&mut b, &scale);
    // Entries of the unit diagonal are off by a few roundings: smaller eigenvalues are rounding themselves.
    let negligible = 16.0 * count(n) * f64::EPSILON;
    let factor = Cholesky::new(scaled.clone());
    let regular = factor.filter(|c| c.l_dirty().diagonal().iter().all(|l| l * l > negligible));
    let mut solution = if let Some(factor) = regular {
        factor.solve(&b)
    } else {
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
        let mut parts = eigenvectors.tr_mul(&b);
        scale_rows(&mut parts, &eigenvalues.map(|value| if value > negligible { value.recip() } else { 0.0 }));
        eigenvectors * parts
    };
    scale_rows(&mut solution, &scale);
    solution
}

fn scale_rows(matrix: &mut DMatrix<f64>, scale: &DVector<f64>) {
    matrix.row_iter_mut().zip(scale).for_each(|(mut row, scale)| row *= *scale);
}
