//! What is read back of a result.json.

use serde::{Deserialize, Serialize};

use crate::evaluate::Device;
use crate::report::{LogFacts, Named, Part, Standing};

/// A finished study, as `tune --out` left it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The folder or file that it was read from.
    #[serde(skip_deserializing)]
    pub path: String,
    /// Its problem file.
    pub problem: String,
    /// Its log.
    pub log: LogFacts,
    /// Its optimiser.
    pub algorithm: String,
    /// The seed of that.
    pub seed: u64,
    /// Values of the searched parameters.
    pub parameters: Named<f64>,
    /// Their units.
    #[serde(default)]
    pub units: Named<Option<String>>,
    /// Objectives on what was tuned on.
    pub objectives: Named<Option<f64>>,
    /// Options of the objectives.
    #[serde(default)]
    pub definitions: Named<String>,
    /// The baseline, with its objectives there.
    pub baseline: RunBaseline,
    /// Scores on held-out rows.
    pub validation: Option<RunValidation>,
    /// What they say of the winner beside the baseline; results of older versions have none.
    #[serde(default)]
    pub held_out: Option<RunHeldOut>,
    /// NIS and verdict.
    pub consistency: RunConsistency,
    /// The rows of those: `in_sample` or `held_out`.
    #[serde(default)]
    pub consistency_on: String,
    /// Whether every constraint is met.
    #[serde(default)]
    pub feasible: Option<bool>,
    /// Candidates evaluated.
    pub evaluations: u64,
    /// Why the search ended.
    pub stop: String,
    /// Time of the whole study \[s\].
    pub wall_s: f64,
    /// Where it was computed.
    pub device: Device,
}

/// The user's own candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunBaseline {
    /// Its parameters.
    pub parameters: Named<f64>,
    /// Objectives on what was tuned on; `None` where its filter fails.
    pub objectives: Option<Named<Option<f64>>>,
}

/// The part of a validation that a comparison needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunValidation {
    /// `time` or `trajectory`.
    pub by: String,
    /// The share held out.
    pub share: f64,
    /// Whether fresh realisations are.
    pub fresh: bool,
    /// Rows tuned on.
    pub train: Part,
    /// Rows held out.
    pub held_out: Part,
    /// Objectives of the baseline there.
    pub baseline: Option<Named<Option<f64>>>,
    /// Objectives of the winner.
    pub winner: Option<Named<Option<f64>>>,
    /// Whether the winner is worse.
    pub worse: bool,
}

/// What held-out rows say of the winner beside the baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunHeldOut {
    /// Baseline less winner under the first objective.
    pub difference: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// Of all objectives together.
    pub verdict: Standing,
}

/// The part of a verdict that a comparison needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunConsistency {
    /// Sum of NIS / present components; `None` without measurements.
    pub nis_mean: Option<f64>,
    /// Lower end of its 95 % band.
    pub nis_low: Option<f64>,
    /// Upper end.
    pub nis_high: Option<f64>,
    /// The verdict's name.
    pub verdict: String,
}

/// Why a result cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RunError {
    /// No JSON, or not the JSON of a result.
    #[error(
        "{path}:{line}:{column}: is not a result of `kfgpu tune`: {message} (name a folder that `tune --out` wrote, or run the study again)"
    )]
    Broken {
        /// The file.
        path: String,
        /// 1-based line.
        line: usize,
        /// 1-based column.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// A study without a usable candidate.
    #[error("{path}: the run found no usable candidate, so there is nothing to compare (leave it out)")]
    Failed {
        /// The file.
        path: String,
    },
}

impl Run {
    /// Reads the text of a result.json; `path` is what the run is called, `file` what messages name.
    ///
    /// # Errors
    /// If it is not the result of a study, or of one without a usable candidate.
    pub fn read(text: &str, path: &str, file: &str) -> Result<Self, RunError> {
        let value: serde_json::Value = serde_json::from_str(text).map_err(|error| broken(file, &error))?;
        if value.get("evaluations").is_some() && value.get("parameters").is_some_and(serde_json::Value::is_null) {
            return Err(RunError::Failed { path: file.to_owned() });
        }
        let run: Self = serde_json::from_str(text).map_err(|error| broken(file, &error))?;
        Ok(Self { path: path.to_owned(), ..run })
    }

    /// An objective's value on what was tuned on, or on held-out rows.
    #[must_use]
    pub fn objective(&self, name: &str, held_out: bool) -> Option<f64> {
        let objectives = if held_out { self.validation.as_ref()?.winner.as_ref()? } else { &self.objectives };
        objectives.get(name).copied().flatten()
    }

    /// The names of its objectives.
    pub(super) fn objective_list(&self) -> String {
        self.objectives.iter().map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    }
}

/// The parser says the place a second time.
fn broken(file: &str, error: &serde_json::Error) -> RunError {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default().to_owned();
    RunError::Broken { path: file.to_owned(), line: error.line(), column: error.column(), message }
}
