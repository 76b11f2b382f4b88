//! Fixed-interval smoothing: the estimate of every row by all measurements of its trajectory, later ones too.
//!
//! The estimates are those of Rauch, Tung and Striebel (1965, doi:10.2514/3.3166). Their recursion inverts predicted
//! covariances, which may be singular (an exact x0, states without noise), undoes a stable F step by step, and loses
//! digits as the square of P0 / R. So they are computed from two filters (Fraser and Potter 1969,
//! doi:10.1109/TAC.1969.1099196): the filter's x and P of a row, and what later measurements say about that state. Its
//! log-likelihood is j' d - d' J d / 2 at x + d; J (n x n) and j (n) start from 0 at the last row and go back by
//!
//! ```text
//! smoothed:                    Ps = (P^-1 + J)^-1,   xs = x + Ps j                    (d from the posterior)
//! before the row's update:     J <- J + H' R^-1 H,   j <- j + J K nu + H' R^-1 nu     (d from the prior)
//! before the transition to it: J <- F' C F,          j <- F' (j - C Q j)              with C = (J^-1 + Q)^-1
//! ```
//!
//! P, J and Q may be singular: (A^-1 + B)^-1 = L (I + L' B L)^-1 L' with A = L L' inverts nothing that can be, and
//! subtracts nothing.
//!
//! A robust filter is smoothed with the R that gives a plain update the same gain: R + (1 / w - 1) S for a weight of w. Of the
//! mixture the filter's P holds the spread of the two means besides.
//!
//! An adaptive filter is smoothed with the Q and R that it used in each step: its x and P are those of the model with
//! these, so its smoothed estimates are too.
//!
//! A filter of nonlinear f and h is smoothed with the F, Q, H, R and nu by which a Kalman filter would have done the same
//! (`Taken`): of the extended filters the Jacobians where they took them, of sigma points the affine map with the same
//! cross-covariance and, as noise, what that leaves of the covariance. What comes out is the recursion of Särkkä (2008,
//! doi:10.1109/TAC.2008.919531), whose gain is the cross-covariance over the predicted P.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::estimate::{Estimate, Update, symmetrise};
use super::filter::{Reweighed, Taken};
use super::matrices::{Affine, Formulas};
use super::run::walk;
use super::step::Moment;
use super::transition::Transition;
use super::{Cause, Failure};
use crate::data::{Log, Trajectory};
use crate::model::{Adapts, Problem};

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
/// rows of [`super::Run::trajectories`]. It keeps n² + n numbers a row, and while it runs the updates, with Q and R where
/// the filter adapts them, and F, H, Q and R where f and h are not affine.
///
/// # Errors
/// As [`super::run`]; also when R is singular.
///
/// # Panics
/// If `candidate` does not have one value per searched parameter.
pub fn smooth(problem: &Problem, log: &Log, candidate: &[f64]) -> Result<Vec<Vec<Smoothed>>, Failure> {
    if !problem.modes.is_empty() {
        return Err(Failure::at(log, 0, 0, Cause::NoSmoother));
    }
    let adapts = problem.filter.facts().adapts != Adapts::Nothing;
    let mut passes: Vec<Vec<Pass>> = log.trajectories.iter().map(|_| Vec::new()).collect();
    walk(problem, log, candidate, &mut |moment| {
        let Moment { trajectory, row, update, state } = moment;
        let time = log.trajectories[trajectory].time[row];
        passes[trajectory].push(Pass {
            smoothed: Smoothed { row, time, estimate: state.posterior.clone() },
            update: update.cloned(),
            q: state.noise.q.cloned(),
            r: adapts.then(|| state.noise.r.clone()),
            linear: state.taken.map(|taken| Linear::of(taken, update.is_some())),
            reweighed: state.reweighed.cloned(),
        });
    })?;
    let mut later = Later::new(problem, candidate);
    let all = passes.into_iter().zip(&log.trajectories).enumerate();
    all.map(|(index, (passes, trajectory))| {
        later.backwards(passes, trajectory).map_err(|(row, what)| Failure::at(log, index, row, what))
    })
    .collect()
}

/// A row of the filter.
struct Pass {
    /// The posterior, in place of what is to be smoothed.
    smoothed: Smoothed,
    update: Option<Update>,
    /// Q of the step to the next row, where the filter adapts it.
    q: Option<DMatrix<f64>>,
    /// R of the next row, where the filter is adaptive.
    r: Option<DMatrix<f64>>,
    /// What the filter took f and h for, where they are not affine.
    linear: Option<Linear>,
    /// The update as a plain one, where it was robust.
    reweighed: Option<Reweighed>,
}

/// F and Q of the step that led to a row, and H, R and nu of its update, where it has one.
struct Linear {
    step: [DMatrix<f64>; 2],
    update: Option<([DMatrix<f64>; 2], DVector<f64>)>,
}

impl Linear {
    fn of(Taken { f, q, h, r, nu }: Taken<'_>, updated: bool) -> Self {
        let update = updated.then(|| ([h.clone(), r.clone()], nu.clone()));
        Self { step: [f.clone(), q.clone()], update }
    }
}

/// What later measurements say about a state.
struct Later {
    formulas: Formulas,
    transition: Transition,
    /// h, as long as inputs do not change it.
    measurement: Option<Affine>,
    /// The model's R, with which every trajectory starts.
    r: DMatrix<f64>,
    /// J, n x n, positive semidefinite.
    information: DMatrix<f64>,
    /// j, n.
    gradient: DVector<f64>,
}

impl Later {
    fn new(problem: &Problem, candidate: &[f64]) -> Self {
        let mut formulas = Formulas::new(&problem.model, problem.parameters.resolve(candidate));
        let (n, m) = (formulas.n, formulas.m);
        let mut r = DMatrix::zeros(m, m);
        formulas.measurement_noise(&mut r);
        Self {
            formulas,
            transition: Transition::new(n),
            measurement: None,
            r,
            information: DMatrix::zeros(n, n),
            gradient: DVector::zeros(n),
        }
    }

    /// Smooths one trajectory, last row first; an error comes with its row.
    fn backwards(&mut self, passes: Vec<Pass>, trajectory: &Trajectory) -> Result<Vec<Smoothed>, (usize, Cause)> {
        self.information.fill(0.0);
        self.gradient.fill(0.0);
        let mut smoothed: Vec<Smoothed> = Vec::with_capacity(passes.len());
        let mut step: Option<[DMatrix<f64>; 2]> = None;
        let mut passes = passes.into_iter().rev().peekable();
        while let Some(Pass { smoothed: mut pass, update, q, linear, reweighed, .. }) = passes.next() {
            let (row, inputs) = (pass.row, trajectory.u.row(pass.row));
            let failed = |cause| (row, cause);
            // Nothing follows the last row: its posterior is what it is.
            if let Some(dt) = trajectory.dt(row).filter(|_| !smoothed.is_empty()) {
                match &step {
                    Some([f, q]) => self.before_transition(f, q),
                    None => self.before_affine_transition(dt, inputs, q.as_ref()),
                }
                .map_err(failed)?;
                let Estimate { x, p } = &mut pass.estimate;
                *p = parallel(p, &self.information).map_err(failed)?;
                *x += &*p * &self.gradient;
                pass.estimate.check().map_err(failed)?;
            }
            if let Some(update) = update {
                let r = passes.peek().and_then(|before| before.r.as_ref());
                match (&reweighed, linear.as_ref().and_then(|linear| linear.update.as_ref())) {
                    (Some(Reweighed { r: None, .. }), _) => Some(()),
                    (Some(Reweighed { h, nu, r: Some(r) }), _) => self.before_update(h, r, &update.k, nu),
                    (None, Some(([h, r], nu))) => self.before_update(h, r, &update.k, nu),
                    (None, None) => self.before_affine_update(&update, inputs, r),
                }
                .ok_or_else(|| failed(Cause::SingularNoise))?;
            }
            step = linear.map(|linear| linear.step);
            smoothed.push(pass);
        }
        smoothed.reverse();
        Ok(smoothed)
    }

    /// By an affine h, with the R of this row where it is not the model's; `None` when R has no inverse.
    fn before_affine_update(&mut self, update: &Update, inputs: &[f64], adapted: Option<&DMatrix<f64>>) -> Option<()> {
        let Update { present, nu, k, .. } = update;
        let Formulas { n, m, h_uses_inputs, .. } = self.formulas;
        let whole = self.measurement.take().filter(|_| !h_uses_inputs).unwrap_or_else(|| {
            let mut whole = Affine::zeros(m, n);
            self.formulas.measurement(inputs, &mut whole);
            whole
        });
        let h = whole.matrix.select_rows(present);
        self.measurement = Some(whole);
        let r = adapted.unwrap_or(&self.r).select_rows(present).select_columns(present);
        self.before_update(&h, &r, k, nu)
    }

    /// `None` when R has no inverse.
    fn before_update(&mut self, h: &DMatrix<f64>, r: &DMatrix<f64>, k: &DMatrix<f64>, nu: &DVector<f64>) -> Option<()> {
        // H' R^-1.
        let weight = Cholesky::new(r.clone())?.solve(h).transpose();
        self.gradient += &self.information * (k * nu) + &weight * nu;
        self.information += weight * h;
        symmetrise(&mut self.information);
        Some(())
    }

    /// By an affine f, with the Q of this step where it is not the model's.
    fn before_affine_transition(
        &mut self,
        dt: f64,
        inputs: &[f64],
        adapted: Option<&DMatrix<f64>>,
    ) -> Result<(), Cause> {
        let _ = self.transition.prepare(&mut self.formulas, dt, inputs);
        let f = self.transition.f.matrix.clone();
        let q = adapted.unwrap_or(&self.transition.q).clone();
        self.before_transition(&f, &q)
    }

    fn before_transition(&mut self, f: &DMatrix<f64>, q: &DMatrix<f64>) -> Result<(), Cause> {
        let c = parallel(&self.information, q)?;
        let transpose = f.transpose();
        self.gradient = &transpose * (&self.gradient - &c * (q * &self.gradient));
        self.information = &transpose * c * f;
        symmetrise(&mut self.information);
        Ok(())
    }
}

/// (A^-1 + B)^-1 of positive semidefinite A and B, which need no inverse.
fn parallel(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<DMatrix<f64>, Cause> {
    let root = root(a)?;
    let n = a.nrows();
    let mut inner = root.tr_mul(b) * &root + DMatrix::identity(n, n);
    symmetrise(&mut inner);
    let factor = Cholesky::new(inner).ok_or(Cause::NotFinite)?;
    let half = factor.l_dirty().solve_lower_triangular(&root.transpose()).ok_or(Cause::NotFinite)?;
    Ok(half.tr_mul(&half))
}

/// L with A = L L'. Where A has no Cholesky factor, from its eigenvectors, with the negative eigenvalues that rounding
/// leaves taken as 0. A is scaled to a unit diagonal first, so that units do not decide what is lost in rounding.
fn root(a: &DMatrix<f64>) -> Result<DMatrix<f64>, Cause> {
    if !a.iter().all(|v| v.is_finite()) {
        return Err(Cause::NotFinite);
    }
    let scale = a.diagonal().map(|v| v.max(0.0).sqrt());
    let inverse = scale.map(|s| if s > 0.0 { s.recip() } else { 0.0 });
    let scaled = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * inverse[i] * inverse[j]);
    let mut root = Cholesky::new(scaled.clone()).map_or_else(
        || {
            let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
            eigenvectors * DMatrix::from_diagonal(&eigenvalues.map(|value| value.max(0.0).sqrt()))
        },
        Cholesky::unpack,
    );
    root.row_iter_mut().zip(&scale).for_each(|(mut row, scale)| row *= *scale);
    Ok(root)
}
