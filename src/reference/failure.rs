//! Why a filter run stopped.

use crate::data::Log;

/// A filter run that could not go on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{log}:{line}: trajectory {trajectory}, row {row}: {what}")]
pub struct Failure {
    /// [`Log::source`].
    pub log: String,
    /// Index of the trajectory.
    pub trajectory: usize,
    /// Index of the row within it.
    pub row: usize,
    /// 1-based line of the row in the log's source.
    pub line: u64,
    /// What happened there.
    pub what: Cause,
}

/// What stopped a filter run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// Q, R or P0 is no covariance for this candidate.
    #[error("`{matrix}` is no covariance for this candidate ({}; narrow the bounds of its parameters)", wanted(matrix))]
    NotCovariance {
        /// `Q`, `R` or `P0`.
        matrix: &'static str,
    },
    /// R and P are singular in one direction.
    #[error("the innovation covariance S is not positive definite (give every measurement some noise)")]
    NotPositive,
    /// Rounding, or a singular start, left a P without a root.
    #[error(
        "the covariance P of the state is not positive definite, so there are no sigma points (give every state some noise)"
    )]
    NoSigmaPoints,
    /// An overflow, or a NaN from a formula or an input.
    #[error("the filter met a number that is not finite (check the formulas, their parameters and the inputs)")]
    NotFinite,
    /// R is singular or no covariance, which only smoothing needs.
    #[error(
        "the measurement noise covariance R is not positive definite, which smoothing needs (give every measurement some noise)"
    )]
    SingularNoise,
    /// Several models are smoothed by no recursion that is built.
    #[error("the filter of several models has no smoother (leave smoothing out)")]
    NoSmoother,
    /// `first = "predict"` has no interval to use.
    #[error("first = \"predict\" has no interval, because the log's intervals differ (give first_dt)")]
    NoFirstInterval,
    /// A setting of the filter is outside its range for this candidate.
    #[error("`filter.{key}` is outside its range for this candidate (check the bounds of its parameters)")]
    Setting {
        /// Its key.
        key: &'static str,
    },
    /// The log has other measurement or input columns than the model.
    #[error("the log's measurements and inputs are not the model's (check [data])")]
    WrongColumns,
}

fn wanted(matrix: &str) -> &'static str {
    if matrix == "Q" { "it must be positive semidefinite" } else { "it must be positive definite" }
}

impl Failure {
    pub(super) fn at(log: &Log, trajectory: usize, row: usize, what: Cause) -> Self {
        let line = log.trajectories.get(trajectory).and_then(|t| t.line.get(row)).copied().unwrap_or(0);
        Self { log: log.source.clone(), trajectory, row, line, what }
    }
}
