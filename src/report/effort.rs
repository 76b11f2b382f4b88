//! How a study went, whether it found anything or not.

use serde::{Deserialize, Serialize};

use super::Named;
use crate::data::Log;
use crate::evaluate::Device;
use crate::model::Problem;
use crate::objective::{Kind, Objective};
use crate::study::{Identity, Outcome, StopReason};

/// How a study went, found or not.
#[derive(Debug, Clone, Serialize)]
pub struct Effort {
    /// Problem file.
    pub problem: String,
    /// The log.
    pub log: LogFacts,
    /// Optimiser, by its name in the registry.
    pub algorithm: String,
    /// Units of the searched parameters, where the problem file gives them.
    pub units: Named<Option<String>>,
    /// Bounds of the searched parameters that have them.
    pub bounds: Named<Option<[f64; 2]>>,
    /// What each objective scores: its options, in words.
    pub definitions: Named<String>,
    /// The user's start values.
    pub baseline: Scored,
    /// Candidates evaluated, polish apart.
    pub evaluations: u64,
    /// How many of them failed.
    pub failed: u64,
    /// Generations after the initial one.
    pub generations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Why the search ended.
    pub stop: StopReason,
    /// Where candidates were computed.
    pub device: Device,
    /// The whole study \[s\].
    pub wall_s: f64,
    /// The part of it spent evaluating \[s\].
    pub evaluate_s: f64,
    /// What the user should look at.
    pub warnings: Vec<String>,
}

/// The log of a study.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogFacts {
    /// File name.
    pub source: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of trajectories.
    pub trajectories: usize,
    /// First and last time as the log writes them, where its times count from its first row.
    #[serde(default)]
    pub span: Option<[String; 2]>,
    /// What dt counts.
    #[serde(default = "seconds")]
    pub time_unit: String,
    /// SHA-256 of its numbers, so that two results can be told to be of the same log.
    #[serde(default)]
    pub sha256: String,
    /// The same of its measurements alone, which two models may score whatever else of it they use.
    #[serde(default)]
    pub measurements_sha256: String,
    /// The same of its true states.
    #[serde(default)]
    pub truth_sha256: String,
}

/// Parameters and their objectives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scored {
    /// Values in their own units.
    pub parameters: Named<f64>,
    /// Objectives; `None` when the filter could not run with these parameters.
    pub objectives: Option<Named<f64>>,
}

/// The unit of results written before there was another.
fn seconds() -> String {
    "s".to_owned()
}

impl LogFacts {
    /// Of a whole log, before anything is held out.
    #[must_use]
    pub fn of(log: &Log) -> Self {
        Self {
            source: log.source.clone(),
            rows: log.rows(),
            trajectories: log.trajectories.len(),
            span: log.stamps(),
            time_unit: log.times.unit.counted().to_owned(),
            sha256: Identity::of_log(log),
            measurements_sha256: Identity::of_measurements(log),
            truth_sha256: Identity::of_truth(log),
        }
    }
}

impl Effort {
    /// Of a finished study of `problem` over `log`, computed on `device`.
    #[must_use]
    pub fn of(problem: &Problem, log: LogFacts, outcome: &Outcome, device: Device, warnings: Vec<String>) -> Self {
        let baseline = &outcome.baseline;
        let units = problem.parameters.searched().map(|(parameter, _)| parameter.unit.clone());
        let bounds = problem.parameters.searched().map(|(_, search)| [search.min, search.max]);
        let bounds = bounds.map(|bounds| bounds.iter().all(|b| b.is_finite()).then_some(bounds));
        let definitions = problem.tune.objectives.iter().map(|objective| definition(objective, &problem.model.states));
        Self {
            problem: problem.source.clone(),
            log,
            algorithm: outcome.algorithm.to_owned(),
            units: Named::new(problem.parameters.names(), units),
            bounds: Named::new(problem.parameters.names(), bounds),
            definitions: Named::new(problem.tune.objectives.iter().map(Objective::name), definitions),
            baseline: Scored {
                parameters: parameters(problem, &baseline.candidate),
                objectives: baseline.objectives.as_ref().map(|values| objectives(problem, values)),
            },
            evaluations: outcome.evaluations,
            failed: outcome.failed,
            generations: outcome.generations.saturating_sub(1),
            seed: problem.tune.seed,
            stop: outcome.stop,
            device,
            wall_s: outcome.wall_s,
            evaluate_s: outcome.evaluate_s,
            warnings,
        }
    }
}

/// The options of an objective, in words.
fn definition(objective: &Objective, states: &[String]) -> String {
    let named = objective.states.iter().filter_map(|i| states.get(*i)).map(|s| format!("`{s}`")).collect::<Vec<_>>();
    let window = match (objective.kind, objective.ct_last) {
        (Kind::Mismatch, false) => format!("last {} measured rows", objective.window),
        (Kind::Mismatch, true) => format!("last {} measured rows, Ct of the last", objective.window),
        (Kind::Whiteness, _) => format!("{} lags", objective.lags),
        (Kind::Prediction, _) => {
            let ahead: Vec<String> = objective.horizons().iter().map(usize::to_string).collect();
            format!("{} rows ahead", ahead.join(", "))
        }
        _ => String::new(),
    };
    let named = if named.is_empty() { String::new() } else { format!("states {}", named.join(", ")) };
    let skip = if objective.skip > 0 { format!("without the first {} rows", objective.skip) } else { String::new() };
    let parts: Vec<String> = [named, window, skip].into_iter().filter(|part| !part.is_empty()).collect();
    if parts.is_empty() { "every row".to_owned() } else { parts.join("; ") }
}

pub(super) fn parameters(problem: &Problem, candidate: &[f64]) -> Named<f64> {
    Named::new(problem.parameters.names(), candidate.iter().copied())
}

pub(super) fn objectives(problem: &Problem, values: &[f64]) -> Named<f64> {
    Named::new(problem.tune.objectives.iter().map(Objective::name), values.iter().copied())
}
