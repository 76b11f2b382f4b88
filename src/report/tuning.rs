//! What a study found, as one object: `kfgpu tune --json`, result.json and the report are this.

use serde::Serialize;

use super::{
    Bound, Consistency, ConstraintCheck, Effort, FrontPoint, FrontSummary, HeldOutDifference, Linearity, Matrices,
    Named, Rows, StartOf, Validation,
};
use crate::study::Ended;

/// The result of a study. Objectives are values of the f64 reference over what was tuned on: the whole log, or its
/// training rows where `validation` says so. Parameters are in their own units.
#[derive(Debug, Clone, Serialize)]
pub struct Tuning {
    /// The winner.
    pub parameters: Named<f64>,
    /// Bounds that the winner sits on, of the parameters that do.
    pub at_bound: Named<Bound>,
    /// Values that the log was simulated with, of the parameters whose baseline they are not.
    pub simulated_with: Named<f64>,
    /// The winner's objectives.
    pub objectives: Named<f64>,
    /// Rows that updated the tuned filter: nll / this is the nll per step.
    pub measured_rows: usize,
    /// Scores on held-out rows, where there are any.
    pub validation: Option<Validation>,
    /// What they say of the winner beside the baseline.
    pub held_out: Option<HeldOutDifference>,
    /// Whose the baseline's values are.
    pub start_of: StartOf,
    /// Whether the tuned filter's innovations are what its covariances say.
    pub consistency: Consistency,
    /// The rows that this was judged on: held-out ones where there are any and the filter runs there.
    pub consistency_on: Rows,
    /// The winner by other filters on the rows tuned on, where f or h is curved.
    pub linearity: Option<Linearity>,
    /// Search costs against the reference.
    pub certificate: Certificate,
    /// Constraints, held against the winner.
    pub constraints: Vec<ConstraintCheck>,
    /// Whether the winner meets all of them.
    pub feasible: bool,
    /// The non-dominated candidates of a study of several objectives, of which the winner is the recommended one.
    pub front: Option<Vec<FrontPoint>>,
    /// What that front offers.
    pub front_summary: Option<FrontSummary>,
    /// The local searches in f64 that ended the study.
    pub polish: Option<Polish>,
    /// Whether the winner is an optimum by its gradient; `None` where none is there to judge by (see [`Polish::note`]).
    pub converged: Option<bool>,
    /// Predicted distance of the winner to the optimum, in standard errors: sqrt(2 x the predicted gain in nats).
    pub gradient_norm: Option<f64>,
    /// The tuned filter.
    pub matrices: Matrices,
    /// RMSE of the raw measurements, for `rmse` objectives whose states are measured directly.
    pub raw_measurements: Named<f64>,
    /// How it was found.
    #[serde(flatten)]
    pub effort: Effort,
}

/// The result of a study without a usable candidate: whatever a [`Tuning`] has beside its effort is null.
#[derive(Debug, Clone, Serialize)]
pub struct Nothing {
    #[serde(flatten)]
    nulls: Named<()>,
    /// How it went.
    #[serde(flatten)]
    pub effort: Effort,
}

/// The best candidates of the search, scored again by the independent f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// The winner before polish, by the reference.
    pub objectives_f64: Named<f64>,
    /// The same candidate, as the search scored it.
    pub objectives_search: Named<f64>,
    /// Largest relative difference of the two over the re-scored candidates; of a cost that is a distance from 0, relative
    /// to the mean that it is the distance of, and of `nll` to one nat a row at least.
    pub largest_relative_gap: f64,
    /// Largest difference in units of what is promised of single precision.
    pub largest_gap: f64,
    /// Whether both rank the re-scored candidates alike.
    pub order_held: bool,
    /// How far the winner's filter carries a small change of its log, before polish: |change of nll a row| over that of every z
    /// in standard deviations. `None` for linear filters, which carry none.
    pub amplification: Option<f64>,
    /// Whether it is below 1, so that single precision keeps its promise.
    pub promise_holds: bool,
    /// How many of the re-scored candidates are left out of gaps and order because theirs is not.
    pub amplified: usize,
    /// Number of candidates re-scored.
    pub candidates: usize,
    /// How many of them the reference could not run.
    pub refused: usize,
    /// How many of them it finds infeasible or, of a front, dominated by another.
    pub dropped: usize,
}

/// The local searches that ended a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Polish {
    /// Evaluations they took, not counted among the search's.
    pub evaluations: usize,
    /// How many there were.
    pub starts: usize,
    /// Objectives before, by the reference; of a front, the best of each.
    pub before: Named<f64>,
    /// And after.
    pub after: Named<f64>,
    /// Why they ended.
    pub ended: Ended,
    /// Parameters that were put back to their start because the cost is the same there.
    pub left_at_start: Vec<String>,
    /// Members that a front gained.
    pub members: usize,
    /// Why `converged` is not true, in words.
    pub note: Option<String>,
}

impl Nothing {
    /// The keys of a [`Tuning`] beside those of its effort.
    const KEYS: [&str; 21] = [
        "parameters",
        "at_bound",
        "simulated_with",
        "objectives",
        "measured_rows",
        "validation",
        "held_out",
        "start_of",
        "consistency",
        "consistency_on",
        "linearity",
        "certificate",
        "constraints",
        "feasible",
        "front",
        "front_summary",
        "polish",
        "converged",
        "gradient_norm",
        "matrices",
        "raw_measurements",
    ];

    /// Of a study that went like this.
    #[must_use]
    pub fn of(effort: Effort) -> Self {
        Self { nulls: Self::KEYS.map(|key| (key, ())).into_iter().collect(), effort }
    }
}
