//! Settings of a filter that are formulas of parameters.

use crate::model::{Expr, Symbol};
use std::fmt;

/// Values that a setting may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Above 0, up to 1.
    Share,
    /// From 0 to below 1.
    BelowOne,
    /// From 0 to 1.
    Probability,
    /// 1, up to the rounding of what is typed: see [`Self::ROUNDING`].
    One,
    /// Above 0, below 1.
    Inside,
    /// Above 2.
    AboveTwo,
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// Any finite number.
    Any,
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
    /// What the formula is where it is not the setting itself but a condition on several.
    pub condition: Option<&'static str>,
}

impl<'a> Setting<'a> {
    pub(super) const fn new(key: &'static str, formula: &'a Expr, range: Range) -> Self {
        Self { key, formula, range, condition: None }
    }

    /// A condition that is told of under `key`.
    pub(super) const fn condition(key: &'static str, what: &'static str, formula: &'a Expr, range: Range) -> Self {
        Self { key, formula, range, condition: Some(what) }
    }

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
    /// How far a sum of probabilities may be from 1.
    pub const ROUNDING: f64 = 1e-9;

    /// Whether `value` is allowed; NaN is not.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        match self {
            Self::Share => value > 0.0 && value <= 1.0,
            Self::BelowOne => (0.0..1.0).contains(&value),
            Self::Probability => (0.0..=1.0).contains(&value),
            Self::One => (value - 1.0).abs() <= Self::ROUNDING,
            Self::Inside => value > 0.0 && value < 1.0,
            Self::AboveTwo => value > 2.0 && value.is_finite(),
            Self::Positive => value > 0.0 && value.is_finite(),
            Self::NotNegative => value >= 0.0 && value.is_finite(),
            Self::Any => value.is_finite(),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Share => "a number above 0, up to 1",
            Self::BelowOne => "a number from 0 to below 1",
            Self::Probability => "a number from 0 to 1",
            Self::One => "1",
            Self::Inside => "a number above 0, below 1",
            Self::AboveTwo => "a number above 2",
            Self::Positive => "a number above 0",
            Self::NotNegative => "a number from 0",
            Self::Any => "a finite number",
        })
    }
}
