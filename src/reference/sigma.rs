//! Filters by sigma points: the unscented and the cubature filter, as weighted sums over points that are drawn afresh before
//! each prediction and before each update.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::Cause;
use super::estimate::{Estimate, Noise, Update, count, symmetrise};
use super::filter::{Filter, State, Taken};
use super::matrices::{Affine, Formulas};
use super::points::{Moments, Rule, lower, slope};
use super::square_root::least_norm;
use super::transition::Transition;

/// The filter of one candidate.
#[derive(Debug)]
pub(super) struct SigmaPoints {
    formulas: Formulas,
    rule: Rule,
    prior: Estimate,
    posterior: Estimate,
    /// L' with L L' = P of the posterior, 0 where P has no root.
    posterior_root: DMatrix<f64>,
    transition: Transition,
    r: DMatrix<f64>,
    update: Update,
    /// F, Q, H and R of the affine model that would have had the same moments.
    f: DMatrix<f64>,
    q: DMatrix<f64>,
    h: DMatrix<f64>,
    r_and_excess: DMatrix<f64>,
}

impl SigmaPoints {
    /// By alpha, beta and kappa.
    pub(super) fn new(formulas: Formulas, settings: [f64; 3]) -> Self {
        let (n, m) = (formulas.n, formulas.m);
        let square = || DMatrix::zeros(n, n);
        Self {
            rule: Rule::new(n, settings),
            formulas,
            prior: Estimate::zeros(n),
            posterior: Estimate::zeros(n),
            posterior_root: square(),
            transition: Transition::new(n),
            r: DMatrix::zeros(m, m),
            update: Update::empty(n),
            f: square(),
            q: square(),
            h: DMatrix::zeros(0, n),
            r_and_excess: DMatrix::zeros(0, 0),
        }
    }

    /// P0 as that of prior and posterior, and R.
    fn start_covariances(&mut self) -> Result<(), Cause> {
        self.formulas.initial_covariance(&mut self.prior.p);
        self.formulas.initial_root(&self.prior.p)?;
        self.formulas.measurement_noise(&mut self.r);
        self.formulas.measurement_root(&self.r)?;
        Ok(())
    }

    fn leave_prior(&mut self) {
        self.posterior.clone_from(&self.prior);
        self.find_root();
    }

    fn find_root(&mut self) {
        match lower(&self.posterior.p) {
            Some(root) => root.transpose_to(&mut self.posterior_root),
            None => self.posterior_root.fill(0.0),
        }
    }

    /// Moments of the present components of h, and the root of the prior covariance they belong to.
    fn predicted_measurement(&mut self, inputs: &[f64]) -> Result<(Moments, DMatrix<f64>), Cause> {
        let Self { formulas, rule, prior, update, .. } = self;
        let root = lower(&prior.p).ok_or(Cause::NoSigmaPoints)?;
        let present = &update.present;
        let values: Vec<DVector<f64>> = rule
            .points(&prior.x, &root)
            .iter()
            .map(|x| formulas.measured(x.as_slice(), inputs).select_rows(present))
            .collect();
        let moments = rule.moments(&values, |y, centre| wrap_angles(formulas, present, y - centre));
        Ok((moments, root))
    }
}

/// Components of a measurement that are angles, in [-pi, pi).
fn wrap_angles(formulas: &Formulas, present: &[usize], mut values: DVector<f64>) -> DVector<f64> {
    for (value, component) in values.iter_mut().zip(present) {
        *value = formulas.angles.between_measurements(*component, *value);
    }
    values
}

impl Filter for SigmaPoints {
    fn starts_from_measurement(&self) -> bool {
        self.formulas.starts_from_measurement()
    }

    fn start(&mut self, first_dt: Option<f64>, _: Option<f64>) -> Result<(), Cause> {
        self.formulas.initial_state(&mut self.prior.x);
        self.start_covariances()?;
        self.leave_prior();
        if let Some(dt) = first_dt {
            self.predict(dt, &[])?;
        }
        self.prior.check()
    }

    fn start_from(&mut self, z: &[f64], inputs: &[f64], _: Option<f64>) -> Result<(), Cause> {
        let mut h = Affine::zeros(self.formulas.m, self.formulas.n);
        self.formulas.measurement(inputs, &mut h);
        self.prior.x = least_norm(&h.matrix, &(DVector::from_column_slice(z) - &h.offset));
        self.start_covariances()?;
        self.leave_prior();
        self.posterior.check()
    }

    /// x = sum W f(X_i), P = sum W (f(X_i) - x)(f(X_i) - x)' + Q.
    fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause> {
        let Self { formulas, rule, transition, .. } = self;
        if transition.renew_noise(formulas, dt) {
            formulas.process_root(&transition.q)?;
        }
        let root = lower(&self.posterior.p).ok_or(Cause::NoSigmaPoints)?;
        let points = rule.points(&self.posterior.x, &root);
        let values: Vec<_> = points.iter().map(|x| formulas.moved(x.as_slice(), dt, inputs)).collect();
        let Moments { mean, covariance, cross, excess } = rule.moments(&values, |y, centre| y - centre);
        self.prior.x = mean;
        self.prior.p = covariance + &transition.q;
        self.f = slope(&cross, &root);
        self.q = excess + &transition.q;
        self.prior.check()
    }

    /// S = sum W (Z_i - z)(Z_i - z)' + R, K = Cov(x, z) S^-1, x + K nu, P - K S K'. Points are those of the prior.
    fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        self.leave_prior();
        self.update.present = (0..z.len()).filter(|i| !z[*i].is_nan()).collect();
        if self.update.present.is_empty() {
            return Ok(false);
        }
        let (Moments { mean, covariance, cross, excess }, root) = self.predicted_measurement(inputs)?;
        let Update { present, nu, s, k, nis, nll, .. } = &mut self.update;
        let measured = DVector::from_iterator(present.len(), present.iter().map(|i| z[*i]));
        let r = self.r.select_rows(&*present).select_columns(&*present);
        *nu = wrap_angles(&self.formulas, present, measured - mean);
        *s = covariance + &r;
        if !nu.iter().chain(s.iter()).all(|v| v.is_finite()) {
            return Err(Cause::NotFinite);
        }
        let factor = Cholesky::new(s.clone()).ok_or(Cause::NotPositive)?;
        *k = factor.solve(&(&root * &cross).transpose()).transpose();
        *nis = nu.dot(&factor.solve(nu));
        let log_det: f64 = 2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        *nll = 0.5 * (count(present.len()) * std::f64::consts::TAU.ln() + log_det + *nis);
        self.posterior.x += &*k * &*nu;
        self.h = slope(&cross, &root);
        self.r_and_excess = r + excess;
        // P - K S K' in Joseph's form, which a P far above R costs no digits.
        let left = DMatrix::identity(k.nrows(), k.nrows()) - &*k * &self.h;
        self.posterior.p = &left * &self.prior.p * left.transpose() + &*k * &self.r_and_excess * k.transpose();
        symmetrise(&mut self.posterior.p);
        self.find_root();
        self.posterior.check()?;
        Ok(true)
    }

    fn amend(&mut self, posterior: Estimate, _: DMatrix<f64>) {
        self.posterior = posterior;
        self.find_root();
    }

    fn state(&self) -> State<'_> {
        let Self { prior, posterior, posterior_root, update, r, f, q, h, r_and_excess, .. } = self;
        State {
            prior,
            posterior,
            posterior_root,
            update,
            noise: Noise { q: None, r },
            taken: Some(Taken { f, q, h, r: r_and_excess, nu: &update.nu }),
            modes: &[],
            reweighed: None,
        }
    }
}
