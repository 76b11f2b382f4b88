//! The Kalman filter by square roots: joint update, the covariance as P = B' B (see [`super::square_root`]). The extended
//! and the iterated filter are the same with f and h taken about the means.
//!
//! Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, sections 5.2, 7.4 and
//! 10.3; the iteration by Bell and Cathey (1993), doi 10.1109/9.250476.

use nalgebra::{DMatrix, DVector};

use super::Cause;
use super::adapt::Adaptation;
use super::estimate::{Estimate, Noise};
use super::filter::{Filter, State, Taken};
use super::matrices::Formulas;
use super::observation::Observation;
use super::square_root::{least_norm, root, square, triangularise};
use super::transition::Transition;

/// The filter of one candidate.
#[derive(Debug)]
pub(super) struct Kalman {
    formulas: Formulas,
    prior: Estimate,
    posterior: Estimate,
    /// Upper triangular roots of the covariances, prior and posterior.
    prior_root: DMatrix<f64>,
    posterior_root: DMatrix<f64>,
    transition: Transition,
    q_root: DMatrix<f64>,
    observation: Observation,
    adaptation: Option<Box<dyn Adaptation>>,
    /// How often h is linearised in a row; `None` where f and h are affine.
    linearisations: Option<usize>,
    /// 2 n x n.
    stacked: DMatrix<f64>,
}

impl Kalman {
    /// The linear filter.
    pub(super) fn new(formulas: Formulas, adaptation: Option<Box<dyn Adaptation>>) -> Self {
        Self::with(formulas, adaptation, None)
    }

    /// The extended filter, with one linearisation of h in a row, or the iterated one, with more.
    pub(super) fn local(formulas: Formulas, linearisations: usize) -> Self {
        Self::with(formulas, None, Some(linearisations))
    }

    fn with(formulas: Formulas, adaptation: Option<Box<dyn Adaptation>>, linearisations: Option<usize>) -> Self {
        let (n, m) = (formulas.n, formulas.m);
        Self {
            formulas,
            prior: Estimate::zeros(n),
            posterior: Estimate::zeros(n),
            prior_root: DMatrix::zeros(n, n),
            posterior_root: DMatrix::zeros(n, n),
            transition: Transition::new(n),
            q_root: DMatrix::zeros(n, n),
            observation: Observation::new(n, m),
            adaptation,
            linearisations,
            stacked: DMatrix::zeros(2 * n, n),
        }
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

    fn adapted_q(&self) -> Option<&DMatrix<f64>> {
        self.adaptation.as_ref().and_then(|adaptation| adaptation.process_noise())
    }

    /// The rest of an update by an affine h.
    fn update_affine(&mut self, z: &[f64]) -> Result<(), Cause> {
        self.observation.innovation(&self.formulas, z, &self.prior.x);
        self.observation.gain(&self.prior_root)?;
        self.observation.correct(z, &mut self.posterior.x);
        Ok(())
    }

    /// The rest of an update by an h that was taken about the prior mean: x = x- + K_i (wrap(z - h(x_i)) - H_i (x- - x_i))
    /// for x_0 = x-. nu, S and the likelihood are those of the first linearisation, K and P of the last.
    fn update_local(&mut self, z: &[f64], inputs: &[f64], linearisations: usize) -> Result<(), Cause> {
        let Self { formulas, prior, posterior, prior_root, observation, .. } = self;
        observation.innovation_at(formulas, z, &DVector::zeros(formulas.n));
        observation.gain(prior_root)?;
        let first = observation.update.clone();
        posterior.x.gemv(1.0, &first.k, &first.nu, 1.0);
        for _ in 1..linearisations {
            observation.prepare_at(formulas, z, inputs, &posterior.x)?;
            observation.innovation_at(formulas, z, &(&prior.x - &posterior.x));
            observation.gain(prior_root)?;
            posterior.x = &prior.x + &observation.update.k * &observation.applied;
        }
        let k = std::mem::replace(&mut observation.update, first).k;
        observation.update.k = k;
        Ok(())
    }
}

impl Filter for Kalman {
    fn starts_from_measurement(&self) -> bool {
        self.formulas.starts_from_measurement()
    }

    fn start(&mut self, first_dt: Option<f64>, dt: Option<f64>) -> Result<(), Cause> {
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

    fn start_from(&mut self, z: &[f64], inputs: &[f64], dt: Option<f64>) -> Result<(), Cause> {
        self.start_noise(dt)?;
        self.observation.prepare(&mut self.formulas, z, inputs)?;
        let h = &self.observation.whole;
        self.prior.x = least_norm(&h.matrix, &(DVector::from_column_slice(z) - &h.offset));
        self.start_covariance()?;
        self.posterior.clone_from(&self.prior);
        self.posterior.check()
    }

    /// x = f(x, u, dt), P = F P F' + Q.
    fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause> {
        let Self { formulas, transition, posterior, .. } = self;
        let local = self.linearisations.is_some();
        let renewed = if local {
            transition.prepare_at(formulas, &posterior.x, dt, inputs)
        } else {
            transition.prepare(formulas, dt, inputs)
        };
        if renewed {
            self.q_root = self.formulas.process_root(&self.transition.q)?;
        }
        if let Some(q) = self.adapted_q() {
            self.q_root = root(q).ok_or(Cause::NotFinite)?;
        }
        let (n, f) = (self.formulas.n, &self.transition.f);
        self.prior.x.copy_from(&f.offset);
        if !local {
            self.prior.x.gemv(1.0, &f.matrix, &self.posterior.x, 1.0);
        }
        self.stacked.rows_mut(0, n).gemm(1.0, &self.posterior_root, &f.transpose, 0.0);
        self.stacked.rows_mut(n, n).copy_from(&self.q_root);
        triangularise(&mut self.stacked);
        self.prior_root.copy_from(&self.stacked.rows(0, n));
        square(&self.prior_root, &mut self.prior.p);
        self.prior.check()
    }

    fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        self.posterior.x.copy_from(&self.prior.x);
        let measured = match self.linearisations {
            None => self.observation.prepare(&mut self.formulas, z, inputs)?,
            Some(_) => self.observation.prepare_at(&mut self.formulas, z, inputs, &self.prior.x)?,
        };
        if !measured {
            self.posterior.p.copy_from(&self.prior.p);
            self.posterior_root.copy_from(&self.prior_root);
            return Ok(false);
        }
        match self.linearisations {
            None => self.update_affine(z)?,
            Some(linearisations) => self.update_local(z, inputs, linearisations)?,
        }
        self.observation.leave(&mut self.posterior_root);
        square(&self.posterior_root, &mut self.posterior.p);
        self.posterior.check()?;
        if let Some(adaptation) = &mut self.adaptation {
            self.observation.adapt(adaptation.as_mut())?;
        }
        Ok(true)
    }

    fn amend(&mut self, posterior: Estimate, root: DMatrix<f64>) {
        self.posterior = posterior;
        self.posterior_root = root;
    }

    fn state(&self) -> State<'_> {
        let Self { prior, posterior, posterior_root, observation, transition, .. } = self;
        let taken = Taken {
            f: &transition.f.matrix,
            q: &transition.q,
            h: &observation.h.matrix,
            r: &observation.r,
            nu: &observation.applied,
        };
        State {
            prior,
            posterior,
            posterior_root,
            update: &observation.update,
            noise: Noise { q: self.adapted_q(), r: &observation.r_whole },
            taken: self.linearisations.map(|_| taken),
            modes: &[],
            reweighed: None,
        }
    }
}
