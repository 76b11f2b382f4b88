//! What a row's measurement is to the filter: H and R of its present components, innovation, gain.

use nalgebra::{DMatrix, DVector};

use super::Cause;
use super::adapt::{Adaptation, Evidence};
use super::estimate::{Update, count, same};
use super::matrices::{Affine, Formulas};
use super::square_root::{root, solve_transposed, square, triangularise};

/// What rounding leaves of a root that is 0, beside what it began with.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// h and R, whole and reduced to the p present components, with the update's own storage.
#[derive(Debug)]
pub(super) struct Observation {
    known: bool,
    inputs: Vec<f64>,
    pub(super) whole: Affine,
    pub(super) r_whole: DMatrix<f64>,
    pub(super) h: Affine,
    pub(super) r: DMatrix<f64>,
    /// B with B' B = R, p x p, and whether R is singular.
    r_root: DMatrix<f64>,
    singular: bool,
    /// B H' with the root B of the prior covariance, n x p.
    seen: DMatrix<f64>,
    /// [root of R, 0; B H', B] before the reflections, [root of S, W; 0, root of P after the update] after them.
    stacked: DMatrix<f64>,
    s_root: DMatrix<f64>,
    k_transposed: DMatrix<f64>,
    s_inverse_nu: DVector<f64>,
    /// Whole turns by which innovations of angles were moved into [-pi, pi), p.
    turns: DVector<f64>,
    /// The innovation that the last gain was applied to, where h is not affine, p.
    pub(super) applied: DVector<f64>,
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
            r_root: DMatrix::zeros(0, 0),
            singular: false,
            seen: DMatrix::zeros(n, 0),
            stacked: DMatrix::zeros(n, n),
            s_root: DMatrix::zeros(0, 0),
            k_transposed: DMatrix::zeros(0, n),
            s_inverse_nu: DVector::zeros(0),
            turns: DVector::zeros(0),
            applied: DVector::zeros(0),
            update: Update::empty(n),
        }
    }

    /// Brings an affine h and R up to date with the inputs and the missing pattern of a row; false when nothing is present.
    pub(super) fn prepare(&mut self, formulas: &mut Formulas, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        let changed = !self.known || (formulas.h_uses_inputs && !same(inputs, &self.inputs));
        if changed {
            formulas.measurement(inputs, &mut self.whole);
            self.known = true;
            self.inputs.clear();
            self.inputs.extend_from_slice(inputs);
        }
        let present = || (0..z.len()).filter(|&i| !z[i].is_nan());
        if changed || !present().eq(self.update.present.iter().copied()) {
            self.reduce(present().collect())?;
        }
        Ok(!self.update.present.is_empty())
    }

    /// Takes h about x, and the present components of it and of R; false when nothing is present.
    pub(super) fn prepare_at(
        &mut self,
        formulas: &mut Formulas,
        z: &[f64],
        inputs: &[f64],
        x: &DVector<f64>,
    ) -> Result<bool, Cause> {
        formulas.measurement_at(x, inputs, &mut self.whole);
        self.reduce((0..z.len()).filter(|&i| !z[i].is_nan()).collect())?;
        Ok(!self.update.present.is_empty())
    }

    /// R of the present components, after it changed.
    pub(super) fn renew_noise(&mut self) -> Result<(), Cause> {
        let present = &self.update.present;
        self.r = self.r_whole.select_rows(present).select_columns(present);
        self.r_root = root(&self.r).ok_or(Cause::NotPositive)?;
        // The rows of a root are filled from the first.
        self.singular = self.r_root.row_iter().last().is_some_and(|row| row.amax() <= 0.0);
        Ok(())
    }

    /// Shows the latest update to an adaptive filter, which may change R.
    pub(super) fn adapt(&mut self, adaptation: &mut dyn Adaptation) -> Result<(), Cause> {
        let predicted: Vec<f64> = self.seen.column_iter().map(|column| column.norm_squared()).collect();
        let evidence = Evidence { update: &self.update, predicted: &predicted };
        if adaptation.adapt(&evidence, &mut self.r_whole) { self.renew_noise() } else { Ok(()) }
    }

    /// Drops the rows of H and the rows and columns of R whose component is missing.
    fn reduce(&mut self, present: Vec<usize>) -> Result<(), Cause> {
        let (p, n) = (present.len(), self.whole.matrix.ncols());
        self.h.matrix = self.whole.matrix.select_rows(&present);
        self.h.transpose = self.h.matrix.transpose();
        self.h.offset = self.whole.offset.select_rows(&present);
        self.seen = DMatrix::zeros(n, p);
        self.stacked = DMatrix::zeros(p + n, p + n);
        self.s_root = DMatrix::zeros(p, p);
        self.k_transposed = DMatrix::zeros(p, n);
        self.s_inverse_nu = DVector::zeros(p);
        self.turns = DVector::zeros(p);
        self.update.nu = DVector::zeros(p);
        self.update.s = DMatrix::zeros(p, p);
        self.update.k = DMatrix::zeros(n, p);
        self.update.present = present;
        self.renew_noise()
    }

    /// nu = z - h of the present components, of angles in [-pi, pi), with h affine and taken at x.
    pub(super) fn innovation(&mut self, formulas: &Formulas, z: &[f64], x: &DVector<f64>) {
        self.difference(z);
        let nu = &mut self.update.nu;
        nu.gemv(-1.0, &self.h.matrix, x, 1.0);
        for (i, component) in self.update.present.iter().enumerate() {
            let wrapped = formulas.angles.between_measurements(*component, nu[i]);
            self.turns[i] = wrapped - nu[i];
            nu[i] = wrapped;
        }
    }

    /// The same of an h that was taken about a point, as a linear h would have it at x: wrap(z - h(o)) - H (x - o), with
    /// `away` = x - o.
    pub(super) fn innovation_at(&mut self, formulas: &Formulas, z: &[f64], away: &DVector<f64>) {
        self.difference(z);
        let nu = &mut self.update.nu;
        for (i, component) in self.update.present.iter().enumerate() {
            nu[i] = formulas.angles.between_measurements(*component, nu[i]);
        }
        nu.gemv(-1.0, &self.h.matrix, away, 1.0);
        self.applied.clone_from(nu);
    }

    /// z less the offset of h.
    fn difference(&mut self, z: &[f64]) {
        let Update { present, nu, .. } = &mut self.update;
        for (i, &component) in present.iter().enumerate() {
            nu[i] = z[component] - self.h.offset[i];
        }
    }

    /// S, K, NIS and the log-likelihood of nu, from the root of the prior covariance.
    pub(super) fn gain(&mut self, root: &DMatrix<f64>) -> Result<(), Cause> {
        let Update { present, nu, s, k, nis, nll, .. } = &mut self.update;
        let (p, n) = (present.len(), root.nrows());
        self.seen.gemm(1.0, root, &self.h.transpose, 0.0);
        self.stacked.fill(0.0);
        self.stacked.view_mut((0, 0), (p, p)).copy_from(&self.r_root);
        self.stacked.view_mut((p, 0), (n, p)).copy_from(&self.seen);
        self.stacked.view_mut((p, p), (n, n)).copy_from(root);
        triangularise(&mut self.stacked);
        self.s_root.copy_from(&self.stacked.view((0, 0), (p, p)));
        square(&self.s_root, s);
        if !nu.iter().chain(s.iter()).all(|v| v.is_finite()) {
            return Err(Cause::NotFinite);
        }
        // Only a singular R leaves rounding where there is nothing.
        let least = |i: usize| if self.singular { ROUNDING * s[(i, i)].sqrt() } else { 0.0 };
        if (0..p).any(|i| self.s_root[(i, i)].abs() <= least(i)) {
            return Err(Cause::NotPositive);
        }
        self.k_transposed.copy_from(&self.stacked.view((0, p), (p, n)));
        self.s_root.solve_upper_triangular_mut(&mut self.k_transposed);
        self.k_transposed.transpose_to(k);
        solve_transposed(&self.s_root, nu, &mut self.s_inverse_nu);
        *nis = self.s_inverse_nu.norm_squared();
        self.s_root.solve_upper_triangular_mut(&mut self.s_inverse_nu);
        let log_det: f64 = 2.0 * self.s_root.diagonal().iter().map(|d| d.abs().ln()).sum::<f64>();
        *nll = 0.5 * (count(p) * std::f64::consts::TAU.ln() + log_det + *nis);
        Ok(())
    }

    /// x + K nu. Where the prior was so far off that a correction is larger than what it leaves, the rounding of that is
    /// taken in once more: of the exact x, z - h(x) is R S^-1 nu.
    pub(super) fn correct(&self, z: &[f64], x: &mut DVector<f64>) {
        let Update { present, nu, k, .. } = &self.update;
        x.gemv(1.0, k, nu, 1.0);
        let mut left = DVector::from_iterator(present.len(), present.iter().map(|i| z[*i])) - &self.h.offset;
        left += &self.turns;
        if left.iter().zip(nu).all(|(left, nu)| nu.abs() <= left.abs()) {
            return;
        }
        left.gemv(-1.0, &self.h.matrix, x, 1.0);
        left.gemv(-1.0, &self.r, &self.s_inverse_nu, 1.0);
        x.gemv(1.0, k, &left, 1.0);
    }

    /// The root of the covariance after the update.
    pub(super) fn leave(&self, root: &mut DMatrix<f64>) {
        let (p, n) = (self.update.present.len(), root.nrows());
        root.copy_from(&self.stacked.view((p, p), (n, n)));
        if self.singular {
            // What is measured without noise is known.
            for (i, mut column) in root.column_iter_mut().enumerate() {
                let before = self.stacked.column(p + i).norm();
                if column.norm() <= ROUNDING * before {
                    column.fill(0.0);
                }
            }
        }
    }
}
