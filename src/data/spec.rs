//! What a problem file says of its log.

use super::{Format, TimeUnit};
use std::ops::Range;

/// The `[data]` table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataSpec {
    /// CSV file, relative to the problem file; `-` = standard input; `None` when `[simulate]` makes the log.
    pub file: Option<String>,
    /// Time column; unit steps without.
    pub time: Option<String>,
    /// What times count; seconds without.
    pub time_unit: Option<TimeUnit>,
    /// Names of the measurements, m: their columns, unless sensors share some ([`SensorSpec`]).
    pub measurements: Vec<String>,
    /// The sensors, whose measurements follow each other in [`Self::measurements`]; empty where one row measures all.
    pub sensors: Vec<SensorSpec>,
    /// Column that says which sensor a row is of, where sensors have a [`SensorSpec::when`].
    pub sensor: Option<String>,
    /// Values of that column whose rows are left out.
    pub ignore_sensors: Vec<String>,
    /// For each input the measurements whose h alone reads it; `None` where every step needs it, as without an entry.
    pub readers: Vec<Option<Vec<usize>>>,
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

/// A `[[sensor]]` table, as far as the log is concerned.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SensorSpec {
    /// Its name.
    pub name: String,
    /// Columns of the log that it measures, at least one.
    pub columns: Vec<String>,
    /// What the sensor column holds in its rows; without one it has a row wherever one of its columns is filled.
    pub when: Option<String>,
}

impl DataSpec {
    /// The column of each measurement, m.
    pub(crate) fn columns(&self) -> Vec<&str> {
        if self.sensors.is_empty() {
            return self.measurements.iter().map(String::as_str).collect();
        }
        self.sensors.iter().flat_map(|sensor| &sensor.columns).map(String::as_str).collect()
    }

    /// Which measurements each sensor has.
    pub(crate) fn sensor_ranges(&self) -> Vec<Range<usize>> {
        let mut end = 0;
        let range = |sensor: &SensorSpec| {
            end += sensor.columns.len();
            end - sensor.columns.len()..end
        };
        self.sensors.iter().map(range).collect()
    }
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
