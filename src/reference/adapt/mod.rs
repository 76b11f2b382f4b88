//! Filters that adapt Q or R on the way, after each update, as their definitions are printed: one file each.

mod fuzzy;
mod sage_husa;
mod sage_husa_r;

use nalgebra::DMatrix;
use std::fmt::Debug;

use super::estimate::{Update, count};

pub(super) use fuzzy::Fuzzy;
pub(super) use sage_husa::SageHusa;
pub(super) use sage_husa_r::SageHusaR;

/// What an update is adapted from.
pub(super) struct Evidence<'a> {
    pub(super) update: &'a Update,
    /// Diagonal of H P H' before the update, of the present components.
    pub(super) predicted: &'a [f64],
}

impl Evidence<'_> {
    /// For each present component its index, its innovation and its part of the diagonal of H P H'.
    fn components(&self) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        let Self { update, predicted } = self;
        let values = update.nu.iter().zip(predicted.iter());
        update.present.iter().zip(values).map(|(i, (nu, predicted))| (*i, *nu, *predicted))
    }
}

/// A law by which Q or R change, and what it remembers of one trajectory.
pub(super) trait Adaptation: Debug {
    /// Forgets everything, at the start of a trajectory whose first step has the model's Q and R.
    fn start(&mut self, model_q: DMatrix<f64>, model_r: &DMatrix<f64>);

    /// The process noise of the next step, where it is adapted.
    fn process_noise(&self) -> Option<&DMatrix<f64>> {
        None
    }

    /// Takes an update in, and changes R for those that follow; whether it did.
    fn adapt(&mut self, evidence: &Evidence<'_>, r: &mut DMatrix<f64>) -> bool;
}

/// d_k = (1 - b) / (1 - b^(k+1)), without the cancellation of b^(k+1) near 1.
fn fading(b: f64, k: usize) -> f64 {
    let terms = count(k + 1);
    let whole = -(terms * b.ln()).exp_m1();
    if whole > 0.0 { (1.0 - b) / whole } else { 1.0 / terms }
}
