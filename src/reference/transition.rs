//! f and Q of a step.

use nalgebra::{DMatrix, DVector};

use super::estimate::same;
use super::matrices::{Affine, Formulas};

/// f and Q of the latest interval and inputs.
#[derive(Debug)]
pub(super) struct Transition {
    dt: f64,
    inputs: Vec<f64>,
    pub(super) f: Affine,
    pub(super) q: DMatrix<f64>,
}

impl Transition {
    pub(super) fn new(n: usize) -> Self {
        Self { dt: f64::NAN, inputs: Vec::new(), f: Affine::zeros(n, n), q: DMatrix::zeros(n, n) }
    }

    /// Brings an affine f and Q up to date with an interval and its inputs; whether Q is another.
    pub(super) fn prepare(&mut self, formulas: &mut Formulas, dt: f64, inputs: &[f64]) -> bool {
        let before = self.dt;
        let renewed = self.renew_noise(formulas, dt);
        if dt.to_bits() != before.to_bits() || (formulas.f_uses_inputs && !same(inputs, &self.inputs)) {
            formulas.transition(dt, inputs, &mut self.f);
            self.inputs.clear();
            self.inputs.extend_from_slice(inputs);
        }
        renewed
    }

    /// Takes f about x, and brings Q up to date; whether Q is another.
    pub(super) fn prepare_at(&mut self, formulas: &mut Formulas, x: &DVector<f64>, dt: f64, inputs: &[f64]) -> bool {
        formulas.transition_at(x, dt, inputs, &mut self.f);
        self.renew_noise(formulas, dt)
    }

    /// Brings Q up to date with an interval; whether it is another.
    pub(super) fn renew_noise(&mut self, formulas: &mut Formulas, dt: f64) -> bool {
        let renewed = dt.to_bits() != self.dt.to_bits();
        if renewed {
            formulas.process_noise(dt, &mut self.q);
            self.dt = dt;
        }
        renewed
    }
}
