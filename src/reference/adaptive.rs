//! Filters that adapt Q or R on the way, after each update, as their definitions are printed.

use std::collections::VecDeque;

use nalgebra::DMatrix;

use super::Cause;
use super::estimate::{Update, count};
use crate::model::FilterKind;

/// What an adaptive filter remembers of one trajectory.
#[derive(Debug)]
pub(super) enum Adaptation {
    None,
    /// Sage-Husa, process noise.
    ProcessNoise {
        forgetting: f64,
        updates: usize,
        q: DMatrix<f64>,
    },
    /// Sage-Husa, measurement noise; one count and one least variance a component.
    MeasurementNoise {
        forgetting: f64,
        floor: f64,
        updates: Vec<usize>,
        least: Vec<f64>,
    },
    /// Fuzzy; the last squared innovations of each component.
    Fuzzy {
        window: usize,
        gain: f64,
        width: f64,
        squares: Vec<VecDeque<f64>>,
    },
}

/// What an update is adapted from.
pub(super) struct Evidence<'a> {
    pub(super) update: &'a Update,
    /// Diagonal of H P H' before the update, of the present components.
    pub(super) predicted: &'a [f64],
}

impl Adaptation {
    /// For a candidate's parameters and m measurements.
    pub(super) fn new(kind: &FilterKind, parameters: &[f64], m: usize) -> Result<Self, Cause> {
        let settings = kind.settings();
        let mut values = Vec::with_capacity(settings.len());
        for setting in &settings {
            let value = setting.value(parameters);
            if !setting.range.contains(value) {
                return Err(Cause::Setting { key: setting.key });
            }
            values.push(value);
        }
        Ok(match (kind, values.as_slice()) {
            (FilterKind::SageHusa(_), [forgetting]) => {
                Self::ProcessNoise { forgetting: *forgetting, updates: 0, q: DMatrix::zeros(0, 0) }
            }
            (FilterKind::SageHusaR(_), [forgetting, floor]) => Self::MeasurementNoise {
                forgetting: *forgetting,
                floor: *floor,
                updates: vec![0; m],
                least: vec![0.0; m],
            },
            (FilterKind::Fuzzy(fuzzy), [gain, width]) => {
                Self::Fuzzy { window: fuzzy.window, gain: *gain, width: *width, squares: vec![VecDeque::new(); m] }
            }
            _ => Self::None,
        })
    }

    /// Forgets everything, at the start of a trajectory whose first step has the model's Q and R.
    pub(super) fn start(&mut self, model_q: DMatrix<f64>, model_r: &DMatrix<f64>) {
        match self {
            Self::None => {}
            Self::ProcessNoise { updates, q, .. } => {
                *updates = 0;
                *q = model_q;
            }
            Self::MeasurementNoise { floor, updates, least, .. } => {
                updates.fill(0);
                *least = model_r.diagonal().iter().map(|r| *floor * r).collect();
            }
            Self::Fuzzy { squares, .. } => squares.iter_mut().for_each(VecDeque::clear),
        }
    }

    /// The process noise of the next step, where it is adapted.
    pub(super) const fn process_noise(&self) -> Option<&DMatrix<f64>> {
        match self {
            Self::ProcessNoise { q, .. } => Some(q),
            _ => None,
        }
    }

    /// Takes an update in, and changes R for those that follow; whether it did.
    pub(super) fn adapt(&mut self, evidence: &Evidence<'_>, r: &mut DMatrix<f64>) -> bool {
        let Evidence { update, predicted } = evidence;
        let components = || update.present.iter().copied().zip(update.nu.iter().zip(predicted.iter()));
        match self {
            Self::None => return false,
            Self::ProcessNoise { forgetting, updates, q } => {
                *updates += 1;
                let d = fading(*forgetting, *updates);
                let correction = &update.k * &update.nu;
                *q = &*q * (1.0 - d) + &correction * correction.transpose() * d;
                return false;
            }
            Self::MeasurementNoise { forgetting, updates, least, .. } => {
                for (i, (nu, predicted)) in components() {
                    updates[i] += 1;
                    let d = fading(*forgetting, updates[i]);
                    r[(i, i)] = ((1.0 - d) * r[(i, i)] + d * (nu * nu - predicted)).max(least[i]);
                }
            }
            Self::Fuzzy { window, gain, width, squares } => {
                for (i, (nu, predicted)) in components() {
                    let squares = &mut squares[i];
                    squares.push_back(nu * nu);
                    if squares.len() > *window {
                        squares.pop_front();
                    }
                    if squares.len() == *window {
                        let mean = squares.iter().sum::<f64>() / count(*window);
                        let mismatch = mean / (predicted + r[(i, i)]) - 1.0;
                        r[(i, i)] *= 1.0 + relative_change(mismatch / *width, *gain);
                    }
                }
            }
        }
        true
    }
}

/// d_k = (1 - b) / (1 - b^(k+1)), without the cancellation of b^(k+1) near 1.
fn fading(b: f64, k: usize) -> f64 {
    let terms = count(k + 1);
    let whole = -(terms * b.ln()).exp_m1();
    if whole > 0.0 { (1.0 - b) / whole } else { 1.0 / terms }
}

/// Three rules on the degree of mismatch over its width: Negative, Zero and Positive, whose memberships sum to 1, ask for
/// -gain, 0 and +gain; the mean of these, weighted by membership.
fn relative_change(mismatch: f64, gain: f64) -> f64 {
    let negative = (-mismatch).clamp(0.0, 1.0);
    let positive = mismatch.clamp(0.0, 1.0);
    let zero = (1.0 - mismatch.abs()).max(0.0);
    gain * (positive - negative) / (negative + zero + positive)
}
