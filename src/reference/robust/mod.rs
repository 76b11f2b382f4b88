//! Robust updates by their definitions, around any filter: the filter updates in full, and what it did counts by the weight of
//! the row.

mod component;
mod density;

use nalgebra::{DMatrix, DVector};

use super::Cause;
use super::estimate::{Estimate, Update, count};
use super::filter::{Filter, Reweighed, State};
use super::matrices::{Affine, Formulas};
use super::square_root::{root, triangularise};
use crate::model::{Angles, Robust};
use component::{Linear, Row};
use density::Density;

/// Below this weight a row says nothing.
const NOTHING: f64 = 1e-12;

/// A filter with robust updates.
pub(super) struct Withstanding {
    inner: Box<dyn Filter>,
    density: Density,
    /// Most rejected rows in a row of a gate, which has one.
    limit: Option<usize>,
    formulas: Formulas,
    /// How often h is linearised in a row.
    linearisations: usize,
    update: Update,
    reweighed: Reweighed,
    /// Measured rows rejected since the last one that updated.
    rejected: usize,
}

/// What becomes of a row.
struct Outcome {
    posterior: Estimate,
    root: DMatrix<f64>,
    gain: DMatrix<f64>,
    nll: f64,
    rejected: f64,
    reweighed: Reweighed,
}

impl Withstanding {
    /// Around `inner`, with the values of the kind's settings and the ranges of the training log; `linearisations` of h there
    /// are in a row, none where it is affine or taken at points.
    pub(super) fn new(
        inner: Box<dyn Filter>,
        robust: &Robust,
        values: &[f64],
        formulas: Formulas,
        (angles, ranges): (&Angles, &[f64]),
        linearisations: usize,
    ) -> Self {
        let limit =
            if let Robust::Gate { limit, .. } = robust { Some(*limit).filter(|limit| *limit > 0) } else { None };
        let n = formulas.n;
        let density = Density::new(robust, values, angles, ranges);
        Self {
            inner,
            density,
            limit,
            formulas,
            linearisations,
            update: Update::empty(n),
            reweighed: Reweighed { h: DMatrix::zeros(0, n), nu: DVector::zeros(0), r: None },
            rejected: 0,
        }
    }

    /// H, R and nu of the last linearisation of the inner filter, the present components.
    fn linear(&mut self, inputs: &[f64]) -> Linear {
        let State { update, noise, taken, .. } = self.inner.state();
        if let Some(taken) = taken {
            return Linear { h: taken.h.clone(), r: taken.r.clone(), nu: taken.nu.clone() };
        }
        let mut whole = Affine::zeros(self.formulas.m, self.formulas.n);
        self.formulas.measurement(inputs, &mut whole);
        let r = noise.r.select_rows(&update.present).select_columns(&update.present);
        Linear { h: whole.matrix.select_rows(&update.present), r, nu: update.nu.clone() }
    }

    /// One weight for all present components.
    fn joint(&mut self, inputs: &[f64]) -> Result<Outcome, Cause> {
        let Linear { h, r, nu } = self.linear(inputs);
        let State { prior, posterior, posterior_root, update, .. } = self.inner.state();
        let forced = self.limit.is_some_and(|limit| self.rejected >= limit);
        let (weight, spread) = if forced { (1.0, 0.0) } else { self.density.weight(update) };
        let correction = &posterior.x - &prior.x;
        // P + (1 - w) K S K', and the spread of two means; S is that of the last linearisation.
        let s = &h * &prior.p * h.transpose() + &r;
        let s_root = root(&s).ok_or(Cause::NotPositive)?;
        let (n, p) = (prior.x.len(), nu.len());
        let mut stacked = DMatrix::zeros(n + p + 1, n);
        stacked.rows_mut(0, n).copy_from(posterior_root);
        let left = (1.0 - weight).sqrt() * s_root * update.k.transpose();
        stacked.rows_mut(n, p).copy_from(&left);
        stacked.row_mut(n + p).copy_from(&(spread.sqrt() * correction.transpose()));
        triangularise(&mut stacked);
        let root = stacked.rows(0, n).into_owned();
        let x = &prior.x + weight * correction;
        let gain = weight * &update.k;
        let r = (weight > NOTHING).then(|| r + (1.0 / weight - 1.0) * s);
        let nll = self.density.nll(update);
        let posterior = Estimate { x, p: root.tr_mul(&root) };
        let reweighed = Reweighed { h, nu, r };
        Ok(Outcome { posterior, root, gain, nll, rejected: 1.0 - weight, reweighed })
    }

    /// Each decorrelated component by itself.
    fn by_component(&mut self, k: f64, z: &[f64], inputs: &[f64]) -> Result<Outcome, Cause> {
        let linear = self.linear(inputs);
        let State { prior, update, .. } = self.inner.state();
        let (present, prior) = (update.present.clone(), prior.clone());
        let mut row = Row::new(&prior, linear);
        for i in 0..self.linearisations {
            let h = component::linearised(&mut self.formulas, (z, inputs), &present, (&prior.x, &row.x()));
            row.relinearise(Linear { r: row.linear.r.clone(), ..h });
            if i == 0 {
                row.weigh(k)?;
            } else {
                row.update()?;
            }
        }
        if self.linearisations == 0 {
            row.weigh(k)?;
        }
        let (x, p, gain) = (row.x(), row.p.clone(), row.gain()?);
        let mut root = root(&p).ok_or(Cause::NotFinite)?;
        triangularise(&mut root);
        let nll: f64 = row.seen.iter().map(|seen| self.density.nll_of(seen.nis.sqrt(), seen.variance)).sum();
        let rejected = row.seen.iter().map(|seen| 1.0 - seen.weight).sum::<f64>() / count(present.len());
        let Linear { h, nu, .. } = row.linear.clone();
        let reweighed = Reweighed { h, nu, r: Some(row.noise()) };
        Ok(Outcome { posterior: Estimate { x, p }, root, gain, nll, rejected, reweighed })
    }
}

impl Filter for Withstanding {
    fn starts_from_measurement(&self) -> bool {
        self.inner.starts_from_measurement()
    }

    fn start(&mut self, first_dt: Option<f64>, dt: Option<f64>) -> Result<(), Cause> {
        self.rejected = 0;
        self.inner.start(first_dt, dt)
    }

    fn start_from(&mut self, z: &[f64], inputs: &[f64], dt: Option<f64>) -> Result<(), Cause> {
        self.rejected = 0;
        self.inner.start_from(z, inputs, dt)
    }

    fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause> {
        self.inner.predict(dt, inputs)
    }

    fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause> {
        if !self.inner.update(z, inputs)? {
            return Ok(false);
        }
        let outcome = match self.density.threshold_of_each() {
            Some(k) if z.len() > 2 => self.by_component(k, z, inputs)?,
            _ => self.joint(inputs)?,
        };
        let Outcome { posterior, root, gain, nll, rejected, reweighed } = outcome;
        self.update.clone_from(self.inner.state().update);
        self.update.k = gain;
        self.update.nll = nll;
        self.update.rejected = rejected;
        self.reweighed = reweighed;
        self.rejected = if rejected >= 1.0 { self.rejected + 1 } else { 0 };
        self.inner.amend(posterior, root);
        self.inner.state().posterior.check()?;
        Ok(true)
    }

    fn amend(&mut self, posterior: Estimate, root: DMatrix<f64>) {
        self.inner.amend(posterior, root);
    }

    fn state(&self) -> State<'_> {
        State { update: &self.update, reweighed: Some(&self.reweighed), ..self.inner.state() }
    }
}
