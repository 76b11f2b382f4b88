//! Sage-Husa, process noise.

use super::{Adapts, Described, Facts, Range, Setting, Settings};
use crate::model::Expr;
use crate::model::error::Fault;

/// Q_k = (1 - d_k) Q_(k-1) + d_k K nu nu' K', which stays a covariance. After A. P. Sage and G. W. Husa, Adaptive filtering
/// with unknown prior statistics, Joint Automatic Control Conference (1969), 760-769.
#[derive(Debug, Clone, PartialEq)]
pub struct SageHusa {
    /// b of d_k = (1 - b) / (1 - b^(k+1)), above 0 and up to 1 (then d_k = 1 / (k + 1)).
    pub forgetting: Expr,
}

impl Described for SageHusa {
    const NAME: &'static str = "sage-husa";
    const KEYS: &'static [&'static str] = &["forgetting"];

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        Ok(Self { forgetting: settings.formula("forgetting", 0.98)? })
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        vec![Setting::new("forgetting", &self.forgetting, Range::Share)]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: false, adapts: Adapts::ProcessNoise, noise_floor: None }
    }
}
