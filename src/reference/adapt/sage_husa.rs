//! Sage-Husa, process noise: Q_k = (1 - d_k) Q_(k-1) + d_k K nu nu' K'.

use nalgebra::DMatrix;

use super::{Adaptation, Evidence, fading};

#[derive(Debug)]
pub(in crate::reference) struct SageHusa {
    forgetting: f64,
    updates: usize,
    q: DMatrix<f64>,
}

impl SageHusa {
    pub(in crate::reference) fn new(settings: &[f64]) -> Self {
        Self { forgetting: settings[0], updates: 0, q: DMatrix::zeros(0, 0) }
    }
}

impl Adaptation for SageHusa {
    fn start(&mut self, model_q: DMatrix<f64>, _: &DMatrix<f64>) {
        self.updates = 0;
        self.q = model_q;
    }

    fn process_noise(&self) -> Option<&DMatrix<f64>> {
        Some(&self.q)
    }

    fn adapt(&mut self, Evidence { update, .. }: &Evidence<'_>, _: &mut DMatrix<f64>) -> bool {
        self.updates += 1;
        let d = fading(self.forgetting, self.updates);
        let correction = &update.k * &update.nu;
        self.q = &self.q * (1.0 - d) + &correction * correction.transpose() * d;
        false
    }
}
