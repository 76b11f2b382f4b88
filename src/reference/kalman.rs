//! The Kalman filter by square roots: joint update, the covariance as P = B' B (see [`super::square_root`]).
//!
//! Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, sections 5.2 and 7.4.

use nalgebra::{DMatrix, DVector};

use super::Cause;
use super::adapt::Adaptation;
use super::estimate::{Estimate, Noise, Update, same};
use super::matrices::{Affine, Formulas};
use super::observation::Observation;
use super::square_root::{least_norm, root, square, triangularise};

/// The filter of one candidate: `predict` takes posterior to prior, `update` prior to posterior.
#[derive(Debug)]
pub(super) struct Kalman {
    pub(super) formulas: Formulas,
    pub(super) prior: Estimate,
    pub(super) posterior: Estimate,
    /// Upper triangular roots of the covariances, prior and posterior.
    prior_root: DMatrix<f64>,
    pub(super) posterior_root: DMatrix<f64>,
    transition: Transition,
    q_root: DMatrix<f64>,
    observation: Observation,
    adaptation: Option<Box<dyn Adaptation>>,
    /// 2 n x n.
    stacked: DMatrix<f64>,
}

/// f and Q of the latest interval and inputs.
#[derive(Debug)]
pub(super) struct Transition {
    dt: f64,
    inputs: Vec<f64>,
    pub(super) f: Affine,
    pub(super) q: DMatrix<f64>,
}

impl Kalman {
    pub(super) fn new(formulas: Formulas, adaptation: Option<Box<dyn Adaptation>>) -> Self {
        let (n, m) = (formulas.n, formulas.m);
        let estimate = Estimate { x: DVector::zeros(n), p: DMatrix::zeros(n, n) };
        Self {
            formulas,
            prior: estimate.clone(),
            posterior: estimate,
            prior_root: DMatrix::zeros(n, n),
            posterior_root: DMatrix::zeros(n, n),
            transition: Transition::new(n),
            q_root: DMatrix::zeros(n, n),
            observation: Observation::new(n, m),
            adaptation,
            stacked: DMatrix::zeros(2 * n, n),
        }
    }

    /// Posterior of one row to prior of the next: x = f(x, u, dt), P = F P F' + Q.
    pub(super) fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause> {
        if self.transition.prepare(&mut self.formulas, dt, inputs) {
            self.q_root = self.formulas.process_root(&self.transition.q)?;
        }
        if let Some(q) = self.adapted_q() {
            self.q_root = root(q).ok_or(Cause::NotFinite)?;
        }
        let (n, f) = (self.formulas.n, &self.transition.f);
        self.prior.x.copy_from(&f.offset);
        self.prior.x.gemv(1.0, &f.matrix, &self.posterior.x, 1.0);
        self.stacked.rows_mut(0, n).gemm(1.0, &self.posterior_root, &f.transpose, 0.0);
        self.stacked.rows_mut(n, n).copy_from(&self.q_root);
        triangularise(&mut self.stacked);
        self.prior_root.copy_from(&self.stacked.rows(0, n));
        square(&self.prior_root, &mut self.prior.p);
        self.prior.check()
    }

    /// x0 and P0 as prior of the first row, or one step of `first_dt` before it; `dt` follows that row.
    pub(super) fn start(&mut self, first_dt: Option<f64>, dt: Option<f64>) -> Result<(), Cause> {
        self.formulas.initial_state(&mut self.prior.x);
        self.start_covariance()?;
        self.posterior.clone_from(&self.prior);
        if let Some(dt) = first_dt {
            self.start_noise(Some(dt))?;
            self.predict(dt, &[])?;
        }
        self.start_noise(dt)?;
        self.prior.check()
    }

    /// P0 as prior and posterior.
    fn start_covariance(&mut self) -> Result<(), Cause> {
        self.formulas.initial_covariance(&mut self.prior.p);
        self.prior_root = self.formulas.initial_root(&self.prior.p)?;
        triangularise(&mut self.prior_root);
        self.posterior_root.copy_from(&self.prior_root);
        Ok(())
    }

    /// The model's R, and its Q of a step of `dt`, as what an adaptive filter starts from.
    fn start_noise(&mut self, dt: Option<f64>) -> Result<(), Cause> {
        self.formulas.measurement_noise(&mut self.observation.r_whole);
        self.formulas.measurement_root(&self.observation.r_whole)?;
        self.observation.renew_noise()?;
        let mut q = DMatrix::zeros(self.formulas.n, self.formulas.n);
        if let (Some(_), Some(dt)) = (self.adapted_q(), dt) {
            self.formulas.process_noise(dt, &mut q);
            self.formulas.process_root(&q)?;
        }
        if let Some(adaptation) = &mut self.adaptation {
            adaptation.start(q, &self.observation.r_whole);
        }
        Ok(())
    }

    /// The latest update.
    pub(super) fn latest(&self) -> &Update {
        &self.observation.update
    }

    fn adapted_q(&self) -> Option<&DMatrix<f64>> {
        self.adaptation.as_ref().and_then(|adaptation| adaptation.process_noise())
    }

    pub(super) fn noise(&self) -> Noise<'_> {
        Noise { q: self.adapted_q(), r: &self.observation.r_whole }
    }

    /// Prior to posterior by the components of `z` that are not NaN; false when there are none, and the
    /// posterior is the prior.
    pub(super) fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        self.posterior.x.copy_from(&self.prior.x);
        if !self.observation.prepare(&mut self.formulas, z, inputs)? {
            self.posterior.p.copy_from(&self.prior.p);
            self.posterior_root.copy_from(&self.prior_root);
            return Ok(false);
        }
        self.observation.gain(z, &self.prior.x, &self.prior_root)?;
        self.observation.correct(z, &mut self.posterior.x);
        self.observation.leave(&mut self.posterior_root);
        square(&self.posterior_root, &mut self.posterior.p);
        self.posterior.check()?;
        if let Some(adaptation) = &mut self.adaptation {
            self.observation.adapt(adaptation.as_mut())?;
        }
        Ok(true)
    }

    pub(super) fn starts_from_measurement(&self) -> bool {
        self.formulas.starts_from_measurement()
    }

    /// x = pinv(H) (z - h(0)) and P = P0 as posterior, from a complete measurement; `dt` follows its row.
    pub(super) fn start_from(&mut self, z: &[f64], inputs: &[f64], dt: Option<f64>) -> Result<(), Cause> {
        self.start_noise(dt)?;
        self.observation.prepare(&mut self.formulas, z, inputs)?;
        let h = &self.observation.whole;
        self.prior.x = least_norm(&h.matrix, &(DVector::from_column_slice(z) - &h.offset));
        self.start_covariance()?;
        self.posterior.clone_from(&self.prior);
        self.posterior.check()
    }
}

impl Transition {
    pub(super) fn new(n: usize) -> Self {
        Self { dt: f64::NAN, inputs: Vec::new(), f: Affine::zeros(n, n), q: DMatrix::zeros(n, n) }
    }

    /// Brings f and Q up to date with an interval and its inputs; whether Q is another.
    pub(super) fn prepare(&mut self, formulas: &mut Formulas, dt: f64, inputs: &[f64]) -> bool {
        let same_dt = dt.to_bits() == self.dt.to_bits();
        if !same_dt {
            formulas.process_noise(dt, &mut self.q);
        }
        if !same_dt || (formulas.f_uses_inputs && !same(inputs, &self.inputs)) {
            formulas.transition(dt, inputs, &mut self.f);
            self.dt = dt;
            self.inputs.clear();
            self.inputs.extend_from_slice(inputs);
        }
        !same_dt
    }
}
