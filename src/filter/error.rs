//! Why a filter cannot be traced.

use crate::tape::TooLarge;

/// Why a problem cannot be traced.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A Jacobian depends on the state.
    #[error("{formula} `{name}` is not linear in the states: the kalman filter needs linear f and h")]
    NotLinear {
        /// `f` or `h`.
        formula: &'static str,
        /// The state or measurement it belongs to.
        name: String,
    },
    /// The log was not read for this problem.
    #[error(
        "the log has {} measurements and {} inputs, and the problem {} and {}: read the log by the problem's [data]",
        found[0], found[1], expected[0], expected[1]
    )]
    WrongColumns {
        /// Numbers of measurements and inputs of the log.
        found: [usize; 2],
        /// Numbers of measurements and inputs of the model.
        expected: [usize; 2],
    },
    /// No step before the first row.
    #[error("first = \"predict\" has no interval, because the log has not one interval throughout: give first_dt")]
    NoFirstInterval,
    /// No candidate that was tried stays finite.
    #[error(
        "single precision deviates from one run of the filter, and none of the start and 63 candidates between the bounds \
         stays finite through the log: check f, h and the bounds, or use --precision f64"
    )]
    NoNominal,
    /// More values than the operations can name.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// f32 has lost it: P grows too far while nothing is measured.
    #[error(
        "after a stretch without measurements single precision finds {objective} = {single} where double precision finds \
         {double}: use --precision f64"
    )]
    LostInSingle {
        /// Name of the objective.
        objective: String,
        /// Its value in f32.
        single: String,
        /// Its value in f64.
        double: String,
    },
}

impl TraceError {
    /// Whether double precision has what single has not.
    #[must_use]
    pub const fn needs_f64(&self) -> bool {
        matches!(self, Self::LostInSingle { .. } | Self::NoNominal)
    }
}
