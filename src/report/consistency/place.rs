//! Where in a log something was found.

use std::fmt;

use serde::Serialize;

use crate::data::Log;
use crate::report::short;

/// A row of the log, as a person and a program find it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// The value of the trajectory column; empty where the log has none.
    pub trajectory: String,
    /// Row of the trajectory, from 0.
    pub row: usize,
    /// Its time \[s\].
    pub time: f64,
    /// 1-based line in the source.
    pub line: u64,
}

impl Place {
    pub(super) fn of(log: &Log, trajectory: usize, row: usize) -> Self {
        let found = &log.trajectories[trajectory];
        Self { trajectory: found.id.clone(), row, time: found.time[row], line: found.line[row] }
    }

    /// Its time, with the trajectory where there are several.
    pub(super) fn moment(&self) -> String {
        let time = short(self.time, 10);
        if self.trajectory.is_empty() { time } else { format!("{time} of trajectory `{}`", self.trajectory) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} (row {}, time {})", self.line, self.row, self.moment())
    }
}
