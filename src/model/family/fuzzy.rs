//! Fuzzy adaptation of the measurement noise.

use super::{Adapts, Described, Facts, Range, Setting, Settings};
use crate::model::Expr;
use crate::model::error::Fault;

/// Each component's R by its degree of mismatch: mean of the last squared innovations over S, less 1. R must be diagonal.
#[derive(Debug, Clone, PartialEq)]
pub struct Fuzzy {
    /// Squared innovations that the mean is taken over; R rests until a component has that many.
    pub window: usize,
    /// Largest relative change of R in one step, from 0 to below 1.
    pub gain: Expr,
    /// Degree of mismatch at which the change is largest, above 0.
    pub width: Expr,
}

/// The squared innovations are carried from row to row, one value a row of the window and component.
const MAX_WINDOW: u32 = 128;

impl Described for Fuzzy {
    const NAME: &'static str = "fuzzy";
    const KEYS: &'static [&'static str] = &["window", "gain", "width"];

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        let window = settings.count("window", 15, 1, MAX_WINDOW)?;
        Ok(Self { window, gain: settings.formula("gain", 0.1)?, width: settings.formula("width", 0.5)? })
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        vec![Setting::new("gain", &self.gain, Range::BelowOne), Setting::new("width", &self.width, Range::Positive)]
    }

    fn sizes(&self) -> Vec<usize> {
        vec![self.window]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: false, adapts: Adapts::MeasurementNoise, noise_floor: None }
    }
}
