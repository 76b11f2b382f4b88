//! The standard workloads, embedded in the library: a problem file and its log each.

use std::fmt;
use std::str::FromStr;

use crate::data::{Log, LogError, Table, Trajectory};
use crate::model::{Problem, ProblemError};

/// Three linear Kalman filters of three shapes; `benches/workloads/README.md` describes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Workload {
    /// Rocket: n = 3, m = 1, 200 rows, 1 searched parameter.
    A,
    /// Constant velocity on three axes: n = 6, m = 3, 1,000 rows, 6 searched parameters.
    B,
    /// Constant velocity on two axes: n = 4, m = 2, 100,000 rows, 4 searched parameters.
    C,
}

impl Workload {
    /// Every workload.
    pub const ALL: [Self; 3] = [Self::A, Self::B, Self::C];

    /// Its letter.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::C => "C",
        }
    }

    /// The problem, with objectives `nll`, `mse_innovation` and `nis`.
    ///
    /// # Errors
    /// None with the embedded text; the type says that it is parsed like any other problem file.
    pub fn problem(self) -> Result<Problem, ProblemError> {
        let text = match self {
            Self::A => include_str!("../../benches/workloads/A.toml"),
            Self::B => include_str!("../../benches/workloads/B.toml"),
            Self::C => include_str!("../../benches/workloads/C.toml"),
        };
        Problem::parse(text, &format!("workload {self}"))
    }

    /// The log of [`Self::problem`], unit steps.
    ///
    /// # Errors
    /// None with the embedded data; the type says that it is read like any other log.
    pub fn log(self, problem: &Problem) -> Result<Log, LogError> {
        let csv = match self {
            Self::A => include_str!("../../benches/workloads/A.csv"),
            Self::B => include_str!("../../benches/workloads/B.csv"),
            Self::C => include_str!("../../benches/workloads/C.csv"),
        };
        Log::read(&problem.data, csv.as_bytes(), &format!("workload {self}"))
    }
}

impl fmt::Display for Workload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A workload that does not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("workload: expected A, B or C, found \"{0}\"")]
pub struct UnknownWorkload(String);

impl FromStr for Workload {
    type Err = UnknownWorkload;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|w| w.name().eq_ignore_ascii_case(name));
        found.ok_or_else(|| UnknownWorkload(name.to_owned()))
    }
}

/// The first `rows` rows of every trajectory.
pub(super) fn truncate(log: &mut Log, rows: usize) {
    for trajectory in &mut log.trajectories {
        let Trajectory { time, z, u, truth, line, .. } = trajectory;
        let kept = rows.min(time.len());
        time.truncate(kept);
        line.truncate(kept);
        for table in [z, u, truth] {
            let mut short = Table::new(table.columns());
            (0..kept).for_each(|k| short.push(table.row(k)));
            *table = short;
        }
    }
}
