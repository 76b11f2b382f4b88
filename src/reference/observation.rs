//! What a row's measurement is to the filter: H and R of its present components, innovation, gain.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::Cause;
use super::adaptive::{Adaptation, Evidence};
use super::kalman::{Estimate, Update, count, same, symmetrise};
use super::matrices::{Affine, Formulas};

/// h and R, whole and reduced to the present components, with the update's own storage.
#[derive(Debug)]
pub(super) struct Observation {
    known: bool,
    inputs: Vec<f64>,
    pub(super) whole: Affine,
    pub(super) r_whole: DMatrix<f64>,
    pub(super) h: Affine,
    pub(super) r: DMatrix<f64>,
    hp: DMatrix<f64>,
    pub(super) k_transposed: DMatrix<f64>,
    pub(super) k_r: DMatrix<f64>,
    factor: DMatrix<f64>,
    s_inverse_nu: DVector<f64>,
    pub(super) update: Update,
}

impl Observation {
    pub(super) fn new(n: usize, m: usize) -> Self {
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
    pub(super) fn prepare(&mut self, formulas: &mut Formulas, z: &[f64], inputs: &[f64]) -> bool {
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

    /// R of the present components, after it changed.
    pub(super) fn renew_noise(&mut self) {
        let present = &self.update.present;
        self.r = self.r_whole.select_rows(present).select_columns(present);
    }

    /// Shows the latest update to an adaptive filter, which may change R.
    pub(super) fn adapt(&mut self, adaptation: &mut Adaptation) {
        if matches!(adaptation, Adaptation::None) {
            return;
        }
        let rows = 0..self.update.present.len();
        let predicted: Vec<f64> = rows.map(|i| self.hp.row(i).dot(&self.h.matrix.row(i))).collect();
        let evidence = Evidence { update: &self.update, predicted: &predicted };
        if adaptation.adapt(&evidence, &mut self.r_whole) {
            self.renew_noise();
        }
    }

    /// Drops the rows of H and the rows and columns of R whose component is missing.
    fn reduce(&mut self, present: Vec<usize>) {
        let (p, n) = (present.len(), self.whole.matrix.ncols());
        self.h.matrix = self.whole.matrix.select_rows(&present);
        self.h.transpose = self.h.matrix.transpose();
        self.h.offset = self.whole.offset.select_rows(&present);
        self.hp = DMatrix::zeros(p, n);
        self.k_transposed = DMatrix::zeros(p, n);
        self.k_r = DMatrix::zeros(n, p);
        self.factor = DMatrix::zeros(p, p);
        self.s_inverse_nu = DVector::zeros(p);
        self.update.nu = DVector::zeros(p);
        self.update.s = DMatrix::zeros(p, p);
        self.update.k = DMatrix::zeros(n, p);
        self.update.present = present;
        self.renew_noise();
    }

    /// nu, S, K, NIS and the log-likelihood of the present components of `z`.
    pub(super) fn gain(&mut self, z: &[f64], prior: &Estimate) -> Result<(), Cause> {
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
