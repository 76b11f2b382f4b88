//! Fuzzy adaptation of R by its degree of mismatch.

use std::collections::VecDeque;

use nalgebra::DMatrix;

use super::{Adaptation, Evidence};
use crate::reference::estimate::count;

/// The last squared innovations of each component.
#[derive(Debug)]
pub(in crate::reference) struct Fuzzy {
    window: usize,
    gain: f64,
    width: f64,
    squares: Vec<VecDeque<f64>>,
}

impl Fuzzy {
    pub(in crate::reference) fn new(settings: &[f64], window: usize, m: usize) -> Self {
        Self { window, gain: settings[0], width: settings[1], squares: vec![VecDeque::new(); m] }
    }
}

impl Adaptation for Fuzzy {
    fn start(&mut self, _: DMatrix<f64>, _: &DMatrix<f64>) {
        self.squares.iter_mut().for_each(VecDeque::clear);
    }

    fn adapt(&mut self, evidence: &Evidence<'_>, r: &mut DMatrix<f64>) -> bool {
        for (i, nu, predicted) in evidence.components() {
            let squares = &mut self.squares[i];
            squares.push_back(nu * nu);
            if squares.len() > self.window {
                squares.pop_front();
            }
            if squares.len() == self.window {
                let mean = squares.iter().sum::<f64>() / count(self.window);
                let mismatch = mean / (predicted + r[(i, i)]) - 1.0;
                r[(i, i)] *= 1.0 + relative_change(mismatch / self.width, self.gain);
            }
        }
        true
    }
}

/// Three rules on the degree of mismatch over its width: Negative, Zero and Positive, whose memberships sum to 1, ask for
/// -gain, 0 and +gain; the mean of these, weighted by membership.
fn relative_change(mismatch: f64, gain: f64) -> f64 {
    let negative = (-mismatch).clamp(0.0, 1.0);
    let positive = mismatch.clamp(0.0, 1.0);
    let zero = (1.0 - mismatch.abs()).max(0.0);
    gain * (positive - negative) / (negative + zero + positive)
}
