//! Which filter runs, and the settings that it has besides the model.

use std::fmt;

use super::{Expr, Symbol};

/// Filter kinds. All of them are linear Kalman filters (affine f and h); the adaptive ones change Q or R on the way, from
/// what the innovations of the log say, and start every trajectory anew from the model's.
///
/// Settings are formulas of parameters, so they can be searched as anything else.
#[derive(Debug, Clone, PartialEq)]
pub enum FilterKind {
    /// The linear Kalman filter.
    Kalman,
    /// Sage-Husa, process noise: Q_k = (1 - d_k) Q_(k-1) + d_k K nu nu' K', which stays a covariance. After A. P. Sage and
    /// G. W. Husa, Adaptive filtering with unknown prior statistics, Joint Automatic Control Conference (1969), 760-769.
    SageHusa {
        /// b of d_k = (1 - b) / (1 - b^(k+1)), above 0 and up to 1 (then d_k = 1 / (k + 1)).
        forgetting: Expr,
    },
    /// Sage-Husa, measurement noise: R_k = (1 - d_k) R_(k-1) + d_k (nu^2 - H P H') for each component, kept at or above
    /// `floor` times the model's R. R must be diagonal.
    SageHusaR {
        /// b, as above.
        forgetting: Expr,
        /// Least share of the model's R, above 0 and up to 1.
        floor: Expr,
    },
    /// Fuzzy adaptation of each component's R by its degree of mismatch: mean of the last squared innovations over S, less 1.
    /// R must be diagonal.
    Fuzzy {
        /// Squared innovations that the mean is taken over; R rests until a component has that many.
        window: usize,
        /// Largest relative change of R in one step, from 0 to below 1.
        gain: Expr,
        /// Degree of mismatch at which the change is largest, above 0.
        width: Expr,
    },
}

/// Values that a setting may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Above 0, up to 1.
    Share,
    /// From 0 to below 1.
    BelowOne,
    /// Above 0.
    Positive,
}

/// A setting of a filter kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting<'a> {
    /// Its key in `[filter]`.
    pub key: &'static str,
    /// Its formula, of parameters.
    pub formula: &'a Expr,
    /// What it may be; a candidate for which it is something else fails.
    pub range: Range,
}

impl FilterKind {
    /// The names that `[filter] kind` takes.
    pub const NAMES: [&'static str; 4] = ["kalman", "sage-husa", "sage-husa-r", "fuzzy"];

    /// Its name in problem files and reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Kalman => Self::NAMES[0],
            Self::SageHusa { .. } => Self::NAMES[1],
            Self::SageHusaR { .. } => Self::NAMES[2],
            Self::Fuzzy { .. } => Self::NAMES[3],
        }
    }

    /// Whether Q or R change on the way, so that the model's are only where they start.
    #[must_use]
    pub const fn is_adaptive(&self) -> bool {
        !matches!(self, Self::Kalman)
    }

    /// Its settings that are formulas.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting<'_>> {
        let setting = |key, formula, range| Setting { key, formula, range };
        match self {
            Self::Kalman => vec![],
            Self::SageHusa { forgetting } => vec![setting("forgetting", forgetting, Range::Share)],
            Self::SageHusaR { forgetting, floor } => {
                vec![setting("forgetting", forgetting, Range::Share), setting("floor", floor, Range::Share)]
            }
            Self::Fuzzy { gain, width, .. } => {
                vec![setting("gain", gain, Range::BelowOne), setting("width", width, Range::Positive)]
            }
        }
    }
}

impl Setting<'_> {
    /// Its value for all parameters' values.
    #[must_use]
    pub fn value(&self, parameters: &[f64]) -> f64 {
        self.formula.evaluate(&|symbol| match symbol {
            Symbol::Parameter(i) => parameters.get(i).copied().unwrap_or(f64::NAN),
            Symbol::State(_) | Symbol::Input(_) | Symbol::Dt => f64::NAN,
        })
    }
}

impl Range {
    /// Whether `value` is allowed; NaN is not.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        match self {
            Self::Share => value > 0.0 && value <= 1.0,
            Self::BelowOne => (0.0..1.0).contains(&value),
            Self::Positive => value > 0.0 && value.is_finite(),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Share => "a number above 0, up to 1",
            Self::BelowOne => "a number from 0 to below 1",
            Self::Positive => "a number above 0",
        })
    }
}
