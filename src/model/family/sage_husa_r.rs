//! Sage-Husa, measurement noise.

use super::{Adapts, Described, Facts, Range, Setting, Settings};
use crate::model::Expr;
use crate::model::error::Fault;

/// R_k = (1 - d_k) R_(k-1) + d_k (nu^2 - H P H') for each component, kept at or above `floor` times the model's R, which must
/// be diagonal.
#[derive(Debug, Clone, PartialEq)]
pub struct SageHusaR {
    /// b of d_k = (1 - b) / (1 - b^(k+1)), above 0 and up to 1 (then d_k = 1 / (k + 1)).
    pub forgetting: Expr,
    /// Least share of the model's R, above 0 and up to 1.
    pub floor: Expr,
}

impl SageHusaR {
    fn floor(&self) -> Setting<'_> {
        Setting::new("floor", &self.floor, Range::Share)
    }
}

impl Described for SageHusaR {
    const NAME: &'static str = "sage-husa-r";
    const KEYS: &'static [&'static str] = &["forgetting", "floor"];

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        Ok(Self { forgetting: settings.formula("forgetting", 0.98)?, floor: settings.formula("floor", 0.01)? })
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        let forgetting = Setting::new("forgetting", &self.forgetting, Range::Share);
        vec![forgetting, self.floor()]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: false, adapts: Adapts::MeasurementNoise, noise_floor: Some(self.floor()) }
    }
}
