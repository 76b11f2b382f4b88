//! Parameters that ran to a bound.

use std::fmt;

use serde::Serialize;

use crate::model::{Scale, Search};

/// Closer to a bound than this share of the range (on the parameter's scale) is at the bound.
const AT_BOUND: f64 = 1e-3;

/// A bound that a parameter sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Bound {
    Lower,
    Upper,
}

impl Bound {
    /// The bound that `value` sits on, if it sits on one.
    #[must_use]
    pub fn of(search: &Search, value: f64) -> Option<Self> {
        let on_scale = |v: f64| if search.scale == Scale::Log { v.ln() } else { v };
        let (min, max) = (on_scale(search.min), on_scale(search.max));
        let margin = AT_BOUND * (max - min);
        let ranged = margin.is_finite() && margin > 0.0;
        if ranged && on_scale(value) <= min + margin {
            Some(Self::Lower)
        } else if ranged && on_scale(value) >= max - margin {
            Some(Self::Upper)
        } else {
            None
        }
    }

    /// Where it lies, in the parameter's unit.
    #[must_use]
    pub const fn value(self, search: &Search) -> f64 {
        match self {
            Self::Lower => search.min,
            Self::Upper => search.max,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        })
    }
}
