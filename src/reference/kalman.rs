//! The textbook Kalman filter: joint update by Cholesky of S, Joseph form, covariances made symmetric after each step.
//!
//! Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.2;
//! the Joseph form is its equation 5.2.3-18.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::Cause;
use super::matrices::{Affine, Formulas};

/// A state estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Mean, n.
    pub x: DVector<f64>,
    /// Covariance, n x n.
    pub p: DMatrix<f64>,
}

/// What a measurement did; p = number of present components.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// Indices of the present components, ascending, p.
    pub present: Vec<usize>,
    /// Joint prior innovation in measurement units, p.
    pub nu: DVector<f64>,
    /// Its covariance, p x p.
    pub s: DMatrix<f64>,
    /// Gain, n x p.
    pub k: DMatrix<f64>,
    /// nu' S^-1 nu.
    pub nis: f64,
    /// (p ln 2 pi + ln det S + NIS) / 2 \[nats\].
    pub nll: f64,
}

/// The filter of one candidate: `predict` takes posterior to prior, `update` prior to posterior.
#[derive(Debug)]
pub(super) struct Kalman {
    pub(super) formulas: Formulas,
    pub(super) prior: Estimate,
    pub(super) posterior: Estimate,
    transition: Transition,
    observation: Observation,
    scratch: [DMatrix<f64>; 2],
}

/// f and Q of the latest interval and inputs.
#[derive(Debug)]
pub(super) struct Transition {
    dt: f64,
    inputs: Vec<f64>,
    pub(super) f: Affine,
    pub(super) q: DMatrix<f64>,
}

/// h and R, whole and reduced to the present components, with the update's own storage.
#[derive(Debug)]
struct Observation {
    known: bool,
    inputs: Vec<f64>,
    whole: Affine,
    r_whole: DMatrix<f64>,
    h: Affine,
    r: DMatrix<f64>,
    hp: DMatrix<f64>,
    k_transposed: DMatrix<f64>,
    k_r: DMatrix<f64>,
    factor: DMatrix<f64>,
    s_inverse_nu: DVector<f64>,
    update: Update,
}

impl Kalman {
    pub(super) fn new(mut formulas: Formulas) -> Self {
        let (n, m) = (formulas.n, formulas.m);
        let estimate = Estimate { x: DVector::zeros(n), p: DMatrix::zeros(n, n) };
        let mut observation = Observation::new(n, m);
        formulas.measurement_noise(&mut observation.r_whole);
        Self {
            formulas,
            prior: estimate.clone(),
            posterior: estimate,
            transition: Transition::new(n),
            observation,
            scratch: [DMatrix::zeros(n, n), DMatrix::zeros(n, n)],
        }
    }

    /// Posterior of one row to prior of the next: x = f(x, u, dt), P = F P F' + Q.
    pub(super) fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause> {
        self.transition.prepare(&mut self.formulas, dt, inputs);
        let Transition { f, q, .. } = &self.transition;
        self.prior.x.copy_from(&f.offset);
        self.prior.x.gemv(1.0, &f.matrix, &self.posterior.x, 1.0);
        let fp = &mut self.scratch[0];
        fp.gemm(1.0, &f.matrix, &self.posterior.p, 0.0);
        self.prior.p.copy_from(q);
        self.prior.p.gemm(1.0, fp, &f.transpose, 1.0);
        symmetrise(&mut self.prior.p);
        self.prior.check()
    }

    /// x0 and P0 as prior of the first row, or one step of `first_dt` before it.
    pub(super) fn start(&mut self, first_dt: Option<f64>) -> Result<(), Cause> {
        self.formulas.initial_state(&mut self.prior.x);
        self.formulas.initial_covariance(&mut self.prior.p);
        self.posterior.clone_from(&self.prior);
        match first_dt {
            Some(dt) => self.predict(dt, &[]),
            None => self.prior.check(),
        }
    }

    /// The latest update.
    pub(super) fn latest(&self) -> &Update {
        &self.observation.update
    }

    /// Prior to posterior by the components of `z` that are not NaN; false when there are none, and the
    /// posterior is the prior.
    pub(super) fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        if !self.observation.prepare(&mut self.formulas, z, inputs) {
            self.posterior.x.copy_from(&self.prior.x);
            self.posterior.p.copy_from(&self.prior.p);
            return Ok(false);
        }
        self.observation.gain(z, &self.prior)?;
        let Observation { h, r, k_transposed, k_r, update: Update { k, nu, .. }, .. } = &mut self.observation;
        self.posterior.x.copy_from(&self.prior.x);
        self.posterior.x.gemv(1.0, k, nu, 1.0);

        let [a, a_p] = &mut self.scratch;
        a.fill_with_identity();
        a.gemm(-1.0, k, &h.matrix, 1.0);
        a_p.gemm(1.0, a, &self.prior.p, 0.0);
        a.transpose_mut();
        k_r.gemm(1.0, k, r, 0.0);
        self.posterior.p.gemm(1.0, a_p, a, 0.0);
        self.posterior.p.gemm(1.0, k_r, k_transposed, 1.0);
        symmetrise(&mut self.posterior.p);
        self.posterior.check()?;
        Ok(true)
    }

    pub(super) fn starts_from_measurement(&self) -> bool {
        self.formulas.starts_from_measurement()
    }

    /// x = pinv(H) (z - h(0)) and P = P0 as posterior, from a complete measurement.
    pub(super) fn start_from(&mut self, z: &[f64], inputs: &[f64]) -> Result<(), Cause> {
        self.observation.prepare(&mut self.formulas, z, inputs);
        let h = &self.observation.whole;
        let pinv = h.matrix.clone().pseudo_inverse(1e-12 * h.matrix.norm()).map_err(|_| Cause::NotFinite)?;
        self.posterior.x = pinv * (DVector::from_column_slice(z) - &h.offset);
        self.formulas.initial_covariance(&mut self.posterior.p);
        self.prior.clone_from(&self.posterior);
        self.posterior.check()
    }
}

impl Estimate {
    pub(super) fn check(&self) -> Result<(), Cause> {
        let finite = self.x.iter().chain(self.p.iter()).all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(Cause::NotFinite) }
    }
}

impl Transition {
    pub(super) fn new(n: usize) -> Self {
        Self { dt: f64::NAN, inputs: Vec::new(), f: Affine::zeros(n, n), q: DMatrix::zeros(n, n) }
    }

    /// Brings f and Q up to date with an interval and its inputs.
    pub(super) fn prepare(&mut self, formulas: &mut Formulas, dt: f64, inputs: &[f64]) {
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
    }
}

impl Observation {
    fn new(n: usize, m: usize) -> Self {
        Self {
            known: false,
            inputs: Vec::new(),
            whole: Affine::zeros(m, n),
            r_whole: DMatrix::zeros(m, m),
            h: Affine::zeros(0, n),
            r: DMatrix::zeros(0, 0),
            hp: DMatrix::zeros(0, n),
            k_transposed: DMatrix::zeros(0, n),
            k_r: DMatrix::zeros(n, 0),
            factor: DMatrix::zeros(0, 0),
            s_inverse_nu: DVector::zeros(0),
            update: Update {
                present: Vec::new(),
                nu: DVector::zeros(0),
                s: DMatrix::zeros(0, 0),
                k: DMatrix::zeros(n, 0),
                nis: 0.0,
                nll: 0.0,
            },
        }
    }

    /// Brings h and R up to date with the inputs and the missing pattern of a row; false when nothing is present.
    fn prepare(&mut self, formulas: &mut Formulas, z: &[f64], inputs: &[f64]) -> bool {
        let changed = !self.known || (formulas.h_uses_inputs && !same(inputs, &self.inputs));
        if changed {
            formulas.measurement(inputs, &mut self.whole);
            self.known = true;
            self.inputs.clear();
            self.inputs.extend_from_slice(inputs);
        }
        let present = || (0..z.len()).filter(|&i| !z[i].is_nan());
        if changed || !present().eq(self.update.present.iter().copied()) {
            self.reduce(present().collect());
        }
        !self.update.present.is_empty()
    }

    /// Drops the rows of H and the rows and columns of R whose component is missing.
    fn reduce(&mut self, present: Vec<usize>) {
        let (p, n) = (present.len(), self.whole.matrix.ncols());
        self.h.matrix = self.whole.matrix.select_rows(&present);
        self.h.transpose = self.h.matrix.transpose();
        self.h.offset = self.whole.offset.select_rows(&present);
        self.r = self.r_whole.select_rows(&present).select_columns(&present);
        self.hp = DMatrix::zeros(p, n);
        self.k_transposed = DMatrix::zeros(p, n);
        self.k_r = DMatrix::zeros(n, p);
        self.factor = DMatrix::zeros(p, p);
        self.s_inverse_nu = DVector::zeros(p);
        self.update.nu = DVector::zeros(p);
        self.update.s = DMatrix::zeros(p, p);
        self.update.k = DMatrix::zeros(n, p);
        self.update.present = present;
    }

    /// nu, S, K, NIS and the log-likelihood of the present components of `z`.
    fn gain(&mut self, z: &[f64], prior: &Estimate) -> Result<(), Cause> {
        let Update { present, nu, s, k, nis, nll } = &mut self.update;
        for (i, &component) in present.iter().enumerate() {
            nu[i] = z[component] - self.h.offset[i];
        }
        nu.gemv(-1.0, &self.h.matrix, &prior.x, 1.0);
        self.hp.gemm(1.0, &self.h.matrix, &prior.p, 0.0);
        s.copy_from(&self.r);
        s.gemm(1.0, &self.hp, &self.h.transpose, 1.0);
        symmetrise(s);
        if !nu.iter().chain(s.iter()).all(|v| v.is_finite()) {
            return Err(Cause::NotFinite);
        }
        // The factor takes the scratch matrix's storage and gives it back below: no allocation per row.
        let mut factored = std::mem::replace(&mut self.factor, DMatrix::zeros(0, 0));
        factored.copy_from(s);
        let cholesky = Cholesky::new(factored).ok_or(Cause::NotPositive)?;

        self.k_transposed.copy_from(&self.hp);
        cholesky.solve_mut(&mut self.k_transposed);
        self.k_transposed.transpose_to(k);
        self.s_inverse_nu.copy_from(nu);
        cholesky.solve_mut(&mut self.s_inverse_nu);
        *nis = nu.dot(&self.s_inverse_nu);
        let log_det: f64 = 2.0 * cholesky.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let constant = count(present.len()) * std::f64::consts::TAU.ln();
        *nll = 0.5 * (constant + log_det + *nis);
        self.factor = cholesky.unpack_dirty();
        Ok(())
    }
}

/// Lengths as numbers; exact below 2^53.
#[expect(clippy::cast_precision_loss, reason = "no log has 2^53 rows")]
pub(super) fn count(length: usize) -> f64 {
    length as f64
}

pub(super) fn symmetrise(p: &mut DMatrix<f64>) {
    for j in 1..p.ncols() {
        for i in 0..j {
            let mean = 0.5 * (p[(i, j)] + p[(j, i)]);
            p[(i, j)] = mean;
            p[(j, i)] = mean;
        }
    }
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}
