//! What keeps a study from running.

use crate::optimize::{OptimizeError, RestoreError};

/// Why a study could not run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StudyError {
    /// The optimiser could not be built.
    #[error(transparent)]
    Optimize(#[from] OptimizeError),
    /// Every parameter is fixed.
    #[error("no parameter is searched: give at least one a range, such as r = {{ min = 0.1, max = 45 }}")]
    NothingSearched,
    /// The first generation does not fit.
    #[error(
        "{evaluations} evaluations do not hold one generation of {population}: raise evaluations or lower population"
    )]
    BudgetTooSmall {
        /// Evaluations allowed.
        evaluations: u64,
        /// Candidates of generation 0.
        population: usize,
    },
    /// More objectives than a front is found for.
    #[error(
        "{objectives} objectives: a front of at most {limit} is searched (keep those that matter most, and bound the \
         others by constraints)"
    )]
    TooManyObjectives {
        /// Objectives received.
        objectives: usize,
        /// Most that there may be.
        limit: usize,
    },
    /// The oracle leaves out what the constraints bound.
    #[error(
        "the oracle returned {received} values for {expected} objectives and constraints: give it those of \
         reference::scores"
    )]
    Oracle {
        /// Objectives and constraints.
        expected: usize,
        /// Values received.
        received: usize,
    },
    /// The optimiser refuses its saved state.
    #[error(transparent)]
    Restore(#[from] RestoreError),
    /// The saved search is another one.
    #[error("the saved search is not one of this study: {problem} (resume it with the study that saved it)")]
    Snapshot {
        /// What does not fit.
        problem: &'static str,
    },
    /// The evaluator broke its contract.
    #[error("the evaluator returned {received} costs for {expected} candidates: it must return one row each")]
    Evaluator {
        /// Candidates sent.
        expected: usize,
        /// Rows received.
        received: usize,
    },
}
