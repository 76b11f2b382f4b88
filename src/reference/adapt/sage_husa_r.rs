//! Sage-Husa, measurement noise: R_k = (1 - d_k) R_(k-1) + d_k (nu^2 - H P H'), at least a share of the model's.

use nalgebra::DMatrix;

use super::{Adaptation, Evidence, fading};

/// One count and one least variance a component.
#[derive(Debug)]
pub(in crate::reference) struct SageHusaR {
    forgetting: f64,
    floor: f64,
    updates: Vec<usize>,
    least: Vec<f64>,
}

impl SageHusaR {
    pub(in crate::reference) fn new(settings: &[f64], m: usize) -> Self {
        Self { forgetting: settings[0], floor: settings[1], updates: vec![0; m], least: vec![0.0; m] }
    }
}

impl Adaptation for SageHusaR {
    fn start(&mut self, _: DMatrix<f64>, model_r: &DMatrix<f64>) {
        self.updates.fill(0);
        self.least = model_r.diagonal().iter().map(|r| self.floor * r).collect();
    }

    fn adapt(&mut self, evidence: &Evidence<'_>, r: &mut DMatrix<f64>) -> bool {
        for (i, nu, predicted) in evidence.components() {
            self.updates[i] += 1;
            let d = fading(self.forgetting, self.updates[i]);
            r[(i, i)] = ((1.0 - d) * r[(i, i)] + d * (nu * nu - predicted)).max(self.least[i]);
        }
        true
    }
}
