//! What a filter is to the walk through a log, whatever it carries.

use nalgebra::{DMatrix, DVector};

use super::Cause;
use super::estimate::{Estimate, Noise, Update};

/// A filter of one candidate: `predict` takes posterior to prior, `update` prior to posterior.
pub(super) trait Filter {
    /// Whether x0 is the first complete measurement.
    fn starts_from_measurement(&self) -> bool;

    /// x0 and P0 as prior of the first row, or one step of `first_dt` before it; `dt` follows that row.
    fn start(&mut self, first_dt: Option<f64>, dt: Option<f64>) -> Result<(), Cause>;

    /// x = pinv(H) (z - h(0)) and P = P0 as posterior, from a complete measurement; `dt` follows its row.
    fn start_from(&mut self, z: &[f64], inputs: &[f64], dt: Option<f64>) -> Result<(), Cause>;

    /// Posterior of one row to prior of the next, `dt` later.
    fn predict(&mut self, dt: f64, inputs: &[f64]) -> Result<(), Cause>;

    /// Prior to posterior by the components of `z` that are not NaN; false when there are none, and the posterior is the
    /// prior.
    fn update(&mut self, z: &[f64], inputs: &[f64]) -> Result<bool, Cause>;

    /// Puts another posterior, with B of P = B' B, in the place of what the latest update made.
    fn amend(&mut self, posterior: Estimate, root: DMatrix<f64>);

    /// What it has now.
    fn state(&self) -> State<'_>;
}

/// What a filter has after a row. One that carries several gaussians gives their common mean and covariance.
#[derive(Clone, Copy)]
pub(super) struct State<'a> {
    pub(super) prior: &'a Estimate,
    pub(super) posterior: &'a Estimate,
    /// An upper triangular B with B' B = P of the posterior; a diagonal entry of 0 where there is none.
    pub(super) posterior_root: &'a DMatrix<f64>,
    /// The latest update, perhaps of an earlier row.
    pub(super) update: &'a Update,
    /// What an adaptive filter goes on with.
    pub(super) noise: Noise<'a>,
    /// What the filter took f and h for; `None` where they are affine, and as the model has them.
    pub(super) taken: Option<Taken<'a>>,
    /// The latest update as a plain one, where it was robust.
    pub(super) reweighed: Option<&'a Reweighed>,
    /// The probabilities of its modes after the latest row; empty for a filter of one model.
    pub(super) modes: &'a [f64],
}

/// H, nu and R with which a plain update has the gain of a robust one; p components.
#[derive(Debug, Clone)]
pub(super) struct Reweighed {
    pub(super) h: DMatrix<f64>,
    pub(super) nu: DVector<f64>,
    /// `None` where the row was rejected.
    pub(super) r: Option<DMatrix<f64>>,
}

/// The linear model with which a Kalman filter would have done what a filter of nonlinear f and h did in a row.
#[derive(Clone, Copy)]
pub(super) struct Taken<'a> {
    /// F of the step that led to the row, n x n.
    pub(super) f: &'a DMatrix<f64>,
    /// Its Q, with what the curvature of f adds.
    pub(super) q: &'a DMatrix<f64>,
    /// H of the latest update, p x n.
    pub(super) h: &'a DMatrix<f64>,
    /// Its R, with what the curvature of h adds, p x p.
    pub(super) r: &'a DMatrix<f64>,
    /// The innovation that K was applied to, p: x = x- + K nu.
    pub(super) nu: &'a DVector<f64>,
}
