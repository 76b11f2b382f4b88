//! What the numbers of a filter run can say.

use std::fmt;

use serde::Serialize;

/// The judgement on a filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No test rejects it, and no parameter is at a bound.
    Consistent,
    /// A few rows carry the sum of NIS.
    Outliers,
    /// NIS above its band: the filter trusts itself too much.
    Overconfident,
    /// NIS below its band: the filter trusts itself too little.
    Underconfident,
    /// The innovations predict each other.
    InnovationsCorrelated,
    /// NIS of the first rows alone is wrong: P0 does not allow for the error of x0, or for far more.
    WrongStart,
    /// NIS is larger at some times than at others.
    ChangesWithTime,
    /// A searched parameter ran to its bound.
    ParameterAtBound,
    /// Large NIS is more frequent than its distribution allows, though the mean is right.
    HeavyTails,
    /// Large NIS is rarer than its distribution allows, though the mean is right.
    LightTails,
    /// NIS of single rows is not distributed as it should be, though mean and tails are right.
    WrongDistribution,
    /// Nothing is wrong so far, but no measurement has innovations enough to tell whether they are white.
    TooFewInnovations,
    /// Nothing was measured.
    NothingMeasured,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Consistent => "consistent",
            Self::Outliers => "outliers",
            Self::Overconfident => "overconfident",
            Self::Underconfident => "underconfident",
            Self::InnovationsCorrelated => "innovations correlated",
            Self::WrongStart => "wrong start",
            Self::ChangesWithTime => "changes with time",
            Self::ParameterAtBound => "parameter at its bound",
            Self::HeavyTails => "heavy tails",
            Self::LightTails => "light tails",
            Self::WrongDistribution => "wrong distribution",
            Self::TooFewInnovations => "too few innovations",
            Self::NothingMeasured => "nothing measured",
        })
    }
}

/// One thing that is wrong, or that nothing is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Of which kind.
    pub verdict: Verdict,
    /// What it rests on and what to do.
    pub advice: String,
}
