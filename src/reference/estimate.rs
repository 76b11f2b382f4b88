//! What a filter has at a row: its estimate, and what a measurement did to it. Small helpers on matrices beside them.

use nalgebra::{DMatrix, DVector};

use super::Cause;

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
    /// Gain, n x p, times the weight of the row.
    pub k: DMatrix<f64>,
    /// nu' S^-1 nu.
    pub nis: f64,
    /// Minus the logarithm of the density of the innovation \[nats\]: (p ln 2 pi + ln det S + NIS) / 2, but for robust updates.
    pub nll: f64,
    /// One less the weight of the row, 0 to 1: 0 where it counted in full.
    pub rejected: f64,
}

/// The noise that an adaptive filter has arrived at, for what follows a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise<'a> {
    /// Q of the step to the next row; `None` where the filter takes the model's.
    pub(super) q: Option<&'a DMatrix<f64>>,
    /// R of the next row, m x m.
    pub(super) r: &'a DMatrix<f64>,
}

impl Update {
    /// Of no component, for n states.
    pub(super) fn empty(n: usize) -> Self {
        Self {
            present: Vec::new(),
            nu: DVector::zeros(0),
            s: DMatrix::zeros(0, 0),
            k: DMatrix::zeros(n, 0),
            nis: 0.0,
            nll: 0.0,
            rejected: 0.0,
        }
    }
}

impl Estimate {
    /// 0 in n dimensions.
    pub(super) fn zeros(n: usize) -> Self {
        Self { x: DVector::zeros(n), p: DMatrix::zeros(n, n) }
    }

    pub(super) fn check(&self) -> Result<(), Cause> {
        let finite = self.x.iter().chain(self.p.iter()).all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(Cause::NotFinite) }
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

pub(super) fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}
