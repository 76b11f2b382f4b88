//! What a study found, as one object: `kfgpu tune --json`, result.json and the text report are this.

use serde::Serialize;

use super::{Bound, Consistency, Matrices, Named};
use crate::evaluate::Device;

/// The result of a study. Objectives are values of the f64 reference over the whole log unless said otherwise; parameters
/// are in their own units.
#[derive(Debug, Clone, Serialize)]
pub struct Tuning {
    /// Problem file.
    pub problem: String,
    /// The log.
    pub log: LogFacts,
    /// Optimiser, by its name in the registry.
    pub algorithm: String,
    /// The winner.
    pub parameters: Named<f64>,
    /// Units, where the problem file gives them.
    pub units: Named<Option<String>>,
    /// Bounds that the winner sits on.
    pub at_bound: Named<Bound>,
    /// The winner's objectives.
    pub objectives: Named<f64>,
    /// The user's start values.
    pub baseline: Scored,
    /// Scores on held-out rows.
    pub validation: Option<Scored>,
    /// Whether the tuned filter's innovations are what its covariances say.
    pub consistency: Consistency,
    /// Search costs against the reference.
    pub certificate: Certificate,
    /// The non-dominated candidates of a study of several objectives.
    pub front: Option<Vec<Scored>>,
    /// Candidates evaluated, polish apart.
    pub evaluations: u64,
    /// Generations after the initial one.
    pub generations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Why the search ended.
    pub stop: String,
    /// Where candidates were computed.
    pub device: Device,
    /// The whole study [s].
    pub wall_s: f64,
    /// The part of it spent evaluating [s].
    pub evaluate_s: f64,
    /// The local search in f64 that ended the study.
    pub polish: Option<Polish>,
    /// The tuned filter.
    pub matrices: Matrices,
    /// RMSE of the raw measurements, for `rmse` objectives whose states are measured directly.
    pub raw_measurements: Named<f64>,
    /// What the user should look at.
    pub warnings: Vec<String>,
}

/// The log of a study.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LogFacts {
    /// File name.
    pub source: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Rows that updated the filter.
    pub measured_rows: usize,
}

/// Parameters and their objectives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scored {
    /// Values in their own units.
    pub parameters: Named<f64>,
    /// Objectives; `None` when the filter could not run with these parameters.
    pub objectives: Option<Named<f64>>,
}

/// The best candidates of the search, scored again by the independent f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// The best candidate of the search, by the reference.
    pub objectives_f64: Named<f64>,
    /// The same candidate, as the search scored it.
    pub objectives_search: Named<f64>,
    /// Largest relative difference of the two over the re-scored candidates.
    pub largest_relative_gap: f64,
    /// Whether both rank the re-scored candidates alike.
    pub order_held: bool,
    /// Number of candidates re-scored.
    pub candidates: usize,
}

/// The local search that ended a study of one objective.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Polish {
    /// Reference runs it took.
    pub evaluations: u64,
    /// The objective it started from.
    pub before: f64,
    /// The objective it ended with.
    pub after: f64,
}
