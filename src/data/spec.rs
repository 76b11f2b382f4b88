//! What a problem file says of its log.

use super::{Format, TimeUnit};

/// The `[data]` table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataSpec {
    /// CSV file, relative to the problem file; `-` = standard input; `None` when `[simulate]` makes the log.
    pub file: Option<String>,
    /// Time column; unit steps without.
    pub time: Option<String>,
    /// What times count; seconds without.
    pub time_unit: Option<TimeUnit>,
    /// Measurement columns, m.
    pub measurements: Vec<String>,
    /// Input columns.
    pub inputs: Vec<String>,
    /// (state, column) pairs of truth.
    pub truth: Vec<(String, String)>,
    /// Trajectory column.
    pub trajectory: Option<String>,
    /// What `tune` holds out; `None` = nothing.
    pub validate: Option<ValidateSpec>,
    /// How the file writes cells and numbers.
    pub format: Format,
}

/// `data.validate`: the share of the log that the search never sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValidateSpec {
    /// Between 0 and 1, both excluded.
    pub share: f64,
    /// What is held out; `None` = trajectories where there are several or the log is simulated, else rows in time.
    pub by: Option<SplitBy>,
}

/// What is held out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SplitBy {
    /// Whole trajectories, or fresh realisations of a simulated log.
    Trajectory,
    /// The last rows of each trajectory.
    Time,
}
