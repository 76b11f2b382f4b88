//! The interacting multiple model filter: every mode by its own filter of the reference, mixed before every prediction. Blom and
//! Bar-Shalom (1988), doi 10.1109/9.1299; Bar-Shalom, Li and Kirubarajan (2001), section 11.6.6.

use nalgebra::DMatrix;

use super::Cause;
use super::estimate::{Estimate, Noise, Update};
use super::filter::{Filter, State};
use super::mixture::Mixture;
use super::points::lower;
use super::square_root::{root, triangularise};
use crate::model::family;
use crate::model::{Angles, Expr, Problem, Symbol};

/// The filter of one candidate.
pub(super) struct Imm {
    modes: Vec<Box<dyn Filter>>,
    allowed: Vec<Option<Expr>>,
    transition: Vec<Expr>,
    start: Vec<Expr>,
    /// All values.
    parameters: Vec<f64>,
    angles: Angles,
    /// c before an update, mu after it.
    probabilities: Vec<f64>,
    prior: Estimate,
    posterior: Estimate,
    /// L' with L L' = P of the posterior, 0 where P has no root.
    posterior_root: DMatrix<f64>,
    update: Update,
}

impl Imm {
    /// `modes` are the filters of the problem's modes, in their order.
    pub(super) fn new(problem: &Problem, imm: &family::Imm, modes: Vec<Box<dyn Filter>>, parameters: Vec<f64>) -> Self {
        let n = problem.model.states.len();
        Self {
            probabilities: vec![f64::NAN; modes.len()],
            modes,
            allowed: problem.modes.iter().map(|mode| mode.allowed.clone()).collect(),
            transition: imm.transition.clone(),
            start: imm.start.clone(),
            parameters,
            angles: problem.model.angles.clone(),
            prior: Estimate::zeros(n),
            posterior: Estimate::zeros(n),
            posterior_root: DMatrix::zeros(n, n),
            update: Update::empty(n),
        }
    }

    fn value(&self, formula: &Expr, dt: f64, inputs: &[f64]) -> f64 {
        formula.evaluate(&|symbol| match symbol {
            Symbol::Parameter(i) => self.parameters[i],
            Symbol::Input(i) => inputs[i],
            Symbol::Dt => dt,
            Symbol::State(_) => f64::NAN,
        })
    }

    /// p_ij of a step, row by row.
    fn chain(&self, dt: f64) -> Vec<f64> {
        self.transition.iter().map(|formula| self.value(formula, dt, &[])).collect()
    }

    /// c_j = sum_i p_ij mu_i.
    fn after_step(&self, chain: &[f64]) -> Vec<f64> {
        let r = self.modes.len();
        (0..r).map(|j| (0..r).map(|i| chain[i * r + j] * self.probabilities[i]).sum()).collect()
    }

    fn begin(&mut self) {
        self.probabilities = self.start.iter().map(|formula| self.value(formula, f64::NAN, &[])).collect();
    }

    /// The estimates of all modes as one, before a row or after it.
    fn combined(&self, of: impl Fn(&dyn Filter) -> Estimate, weights: &[f64]) -> Estimate {
        let estimates: Vec<Estimate> = self.modes.iter().map(|mode| of(mode.as_ref())).collect();
        Mixture { estimates: &estimates, between: &|i, d| self.angles.between_states(i, d) }.moments(weights)
    }

    fn keep_prior(&mut self) {
        self.prior = self.combined(|mode| mode.state().prior.clone(), &shares(&self.probabilities));
    }

    fn keep_posterior(&mut self) {
        self.posterior = self.combined(|mode| mode.state().posterior.clone(), &self.probabilities);
        match lower(&self.posterior.p) {
            Some(root) => root.transpose_to(&mut self.posterior_root),
            None => self.posterior_root.fill(0.0),
        }
    }

    /// mu_j = c_j N_j / sum over those that are allowed, none of them below the floor; and ln of the sum over that of c_j.
    fn weigh(&mut self, inputs: &[f64], log_likelihoods: &[f64]) -> f64 {
        let allowed = |formula: &Option<Expr>| formula.as_ref().is_none_or(|f| self.value(f, f64::NAN, inputs) > 0.0);
        let allowed: Vec<bool> = self.allowed.iter().map(allowed).collect();
        let restricted = self.allowed.iter().any(Option::is_some);
        let before: Vec<f64> =
            self.probabilities.iter().zip(&allowed).map(|(c, a)| if *a { *c } else { 0.0 }).collect();
        let possible = before.iter().zip(log_likelihoods).filter(|(c, _)| **c > 0.0);
        let most = possible.map(|(_, log)| *log).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = before.iter().zip(log_likelihoods).map(|(c, log)| c * (log - most).exp()).collect();
        let total: f64 = weights.iter().sum();
        let floored = |(weight, allowed): (f64, bool)| if allowed { weight.max(family::Imm::FLOOR) } else { 0.0 };
        self.probabilities = weights.iter().map(|weight| weight / total).zip(allowed).map(floored).collect();
        let all: f64 = if restricted { before.iter().sum() } else { 1.0 };
        most + (total / all).ln()
    }

    /// Moments of the innovations of all modes, weighed by what was predicted.
    fn note_update(&mut self, predicted: &[f64], log_likelihood: f64) -> Result<(), Cause> {
        let first = self.modes[0].state().update.clone();
        let present = first.present.clone();
        let seen: Vec<Estimate> = self
            .modes
            .iter()
            .map(|mode| Estimate { x: mode.state().update.nu.clone(), p: mode.state().update.s.clone() })
            .collect();
        let between = |i: usize, d: f64| self.angles.between_measurements(present[i], d);
        let Estimate { x: mut nu, p: s } = Mixture { estimates: &seen, between: &between }.moments(predicted);
        nu.iter_mut().enumerate().for_each(|(i, nu)| *nu = between(i, *nu));
        let factor = nalgebra::Cholesky::new(s.clone()).ok_or(Cause::NotPositive)?;
        let nis = nu.dot(&factor.solve(&nu));
        let gains = self.modes.iter().zip(&self.probabilities);
        let k = gains
            .fold(DMatrix::zeros(first.k.nrows(), first.k.ncols()), |k, (mode, mu)| k + &mode.state().update.k * *mu);
        self.update = Update { present, nu, s, k, nis, nll: -log_likelihood, rejected: 0.0 };
        Ok(())
    }
}

/// The same as parts of one.
fn shares(weights: &[f64]) -> Vec<f64> {
    let all: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / all).collect()
}

impl Filter for Imm {
    fn starts_from_measurement(&self) -> bool {
        self.modes[0].starts_from_measurement()
    }

    fn start(&mut self, first_dt: Option<f64>, dt: Option<f64>) -> Result<(), Cause> {
        self.modes.iter_mut().try_for_each(|mode| mode.start(first_dt, dt))?;
        self.begin();
        if let Some(dt) = first_dt {
            // All modes start from one gaussian, which mixing leaves as it is.
            self.probabilities = self.after_step(&self.chain(dt));
        }
        self.keep_prior();
        self.keep_posterior();
        Ok(())
    }

    fn start_from(&mut self, z: &[f64], inputs: &[f64], dt: Option<f64>) -> Result<(), Cause> {
        self.modes.iter_mut().try_for_each(|mode| mode.start_from(z, inputs, dt))?;
        self.begin();
        self.weigh(inputs, &vec![0.0; self.modes.len()]);
        self.keep_prior();
        self.keep_posterior();
        Ok(())
    }

    fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause> {
        let r = self.modes.len();
        let chain = self.chain(dt);
        let next = self.after_step(&chain);
        let estimates: Vec<Estimate> = self.modes.iter().map(|mode| mode.state().posterior.clone()).collect();
        let between = |i: usize, d: f64| self.angles.between_states(i, d);
        let mixture = Mixture { estimates: &estimates, between: &between };
        let from = |j: usize| (0..r).map(|i| chain[i * r + j] * self.probabilities[i] / next[j]).collect::<Vec<f64>>();
        let mixed: Vec<Estimate> = (0..r)
            .map(|j| if next[j] > 0.0 { mixture.moments(&from(j)) } else { mixture.moments(&vec![0.0; r]) })
            .collect();
        for (mode, mixed) in self.modes.iter_mut().zip(mixed) {
            mixed.check()?;
            let mut root = root(&mixed.p).ok_or(Cause::NotFinite)?;
            triangularise(&mut root);
            mode.amend(mixed, root);
            mode.predict(dt, inputs)?;
        }
        self.probabilities = next;
        self.keep_prior();
        self.prior.check()
    }

    fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        let mut updated = false;
        for mode in &mut self.modes {
            updated = mode.update(z, inputs)?;
        }
        let before = self.probabilities.clone();
        let log_likelihood = |mode: &dyn Filter| if updated { -mode.state().update.nll } else { 0.0 };
        let log_likelihoods: Vec<f64> = self.modes.iter().map(|mode| log_likelihood(mode.as_ref())).collect();
        let joint = self.weigh(inputs, &log_likelihoods);
        if updated {
            if !joint.is_finite() {
                return Err(Cause::NotFinite);
            }
            let allowed = before.iter().zip(&self.probabilities).map(|(c, mu)| if *mu > 0.0 { *c } else { 0.0 });
            self.note_update(&shares(&allowed.collect::<Vec<_>>()), joint)?;
        }
        self.keep_posterior();
        self.posterior.check()?;
        Ok(updated)
    }

    /// Of all modes together: nothing amends them apart from their own filters.
    fn amend(&mut self, posterior: Estimate, root: DMatrix<f64>) {
        self.posterior = posterior;
        self.posterior_root = root;
    }

    fn state(&self) -> State<'_> {
        let r = self.modes[0].state().noise.r;
        State {
            prior: &self.prior,
            posterior: &self.posterior,
            posterior_root: &self.posterior_root,
            update: &self.update,
            noise: Noise { q: None, r },
            taken: None,
            reweighed: None,
            modes: &self.probabilities,
        }
    }
}
