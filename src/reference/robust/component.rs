//! Huber's weights of decorrelated components, one after the other: R = L D L' in the order of the measurements.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::density::huber_weight;
use crate::reference::Cause;
use crate::reference::estimate::{Estimate, symmetrise};
use crate::reference::matrices::{Affine, Formulas};

/// nu = H dx + v with var v = R.
#[derive(Clone)]
pub(super) struct Linear {
    pub(super) h: DMatrix<f64>,
    pub(super) r: DMatrix<f64>,
    pub(super) nu: DVector<f64>,
}

/// A decorrelated component.
pub(super) struct Seen {
    /// Its innovation squared over its variance.
    pub(super) nis: f64,
    /// h P h' + D, P after the components before it.
    pub(super) variance: f64,
    pub(super) weight: f64,
}

/// A row on its way.
pub(super) struct Row<'a> {
    prior: &'a Estimate,
    pub(super) linear: Linear,
    dx: DVector<f64>,
    pub(super) p: DMatrix<f64>,
    pub(super) seen: Vec<Seen>,
    /// Variances that give the same with all weights 1.
    variances: Vec<f64>,
    l: DMatrix<f64>,
}

impl<'a> Row<'a> {
    pub(super) fn new(prior: &'a Estimate, linear: Linear) -> Self {
        let (n, p) = (prior.x.len(), linear.nu.len());
        let l = DMatrix::identity(p, p);
        Self { prior, linear, dx: DVector::zeros(n), p: prior.p.clone(), seen: vec![], variances: vec![], l }
    }

    /// The mean after it.
    pub(super) fn x(&self) -> DVector<f64> {
        &self.prior.x + &self.dx
    }

    pub(super) fn relinearise(&mut self, linear: Linear) {
        self.linear = linear;
    }

    /// Weighs every component by its innovation, and updates.
    pub(super) fn weigh(&mut self, k: f64) -> Result<(), Cause> {
        self.seen = self.run(|_, nis| huber_weight(k, nis))?;
        Ok(())
    }

    /// Updates again with the weights that there are.
    pub(super) fn update(&mut self) -> Result<(), Cause> {
        let weights: Vec<f64> = self.seen.iter().map(|seen| seen.weight).collect();
        self.run(|i, _| weights[i]).map(|_| ())
    }

    fn run(&mut self, weight: impl Fn(usize, f64) -> f64) -> Result<Vec<Seen>, Cause> {
        let Linear { h, r, nu } = &self.linear;
        let (l, d) = ldl(r);
        let (h, nu) = (
            l.solve_lower_triangular(h).ok_or(Cause::NotPositive)?,
            l.solve_lower_triangular(nu).ok_or(Cause::NotPositive)?,
        );
        let n = self.prior.x.len();
        (self.dx, self.p) = (DVector::zeros(n), self.prior.p.clone());
        self.variances.clear();
        let mut seen = Vec::with_capacity(d.len());
        for (i, d) in d.into_iter().enumerate() {
            let h = h.row(i);
            let innovation = nu[i] - (h * &self.dx)[0];
            let ph = &self.p * h.transpose();
            let variance = (h * &ph)[0] + d;
            if variance.is_nan() || variance <= 0.0 {
                return Err(Cause::NotPositive);
            }
            let nis = innovation * innovation / variance;
            let weight = weight(i, nis);
            let gain = weight / variance * ph;
            // P - w K S K' is the update with so much noise, in Joseph's form.
            let noise = d + variance * (1.0 / weight - 1.0);
            let left = DMatrix::identity(n, n) - &gain * h;
            self.p = &left * &self.p * left.transpose() + noise * &gain * gain.transpose();
            symmetrise(&mut self.p);
            self.dx += innovation * gain;
            self.variances.push(noise);
            seen.push(Seen { nis, variance, weight });
        }
        self.l = l;
        Ok(seen)
    }

    /// The R with which a plain update would have done the same.
    pub(super) fn noise(&self) -> DMatrix<f64> {
        &self.l * DMatrix::from_diagonal(&DVector::from_vec(self.variances.clone())) * self.l.transpose()
    }

    /// Its gain.
    pub(super) fn gain(&self) -> Result<DMatrix<f64>, Cause> {
        let ph = &self.prior.p * self.linear.h.transpose();
        let s = &self.linear.h * &ph + self.noise();
        Ok(Cholesky::new(s).ok_or(Cause::NotPositive)?.solve(&ph.transpose()).transpose())
    }
}

/// H and nu of an h taken about `at`, as a linear h would have it at the prior: wrap(z - h(at)) - H (x - at). R is left out.
pub(super) fn linearised(
    formulas: &mut Formulas,
    (z, inputs): (&[f64], &[f64]),
    present: &[usize],
    (x, at): (&DVector<f64>, &DVector<f64>),
) -> Linear {
    let mut whole = Affine::zeros(formulas.m, formulas.n);
    formulas.measurement_at(at, inputs, &mut whole);
    let difference = |i: &usize| {
        let difference = z[*i] - whole.offset[*i];
        formulas.angles.between_measurements(*i, difference)
    };
    let h = whole.matrix.select_rows(present);
    let nu = DVector::from_iterator(present.len(), present.iter().map(difference)) - &h * (x - at);
    Linear { h, r: DMatrix::zeros(0, 0), nu }
}

/// R = L D L' with a unit lower triangular L; where a pivot is 0 so is its column below the diagonal.
fn ldl(r: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let p = r.nrows();
    let (mut l, mut d) = (DMatrix::identity(p, p), Vec::with_capacity(p));
    for j in 0..p {
        let known = |i: usize, d: &[f64]| (0..j).map(|k| l[(i, k)] * d[k] * l[(j, k)]).sum::<f64>();
        let pivot: f64 = r[(j, j)] - known(j, &d);
        let pivot = if pivot > 1e-15 * r[(j, j)] { pivot } else { 0.0 };
        let below: Vec<f64> = (j + 1..p).map(|i| r[(i, j)] - known(i, &d)).collect();
        for (i, rest) in (j + 1..p).zip(below) {
            l[(i, j)] = if pivot > 0.0 { rest / pivot } else { 0.0 };
        }
        d.push(pivot);
    }
    (l, d)
}
