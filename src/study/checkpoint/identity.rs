//! What a checkpoint is a checkpoint of.

use std::fmt::{self, Write as _};

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::data::{Log, Table};
use crate::model::{Problem, TuneSpec};

/// SHA-256 of whatever of a problem and a log the bits of a search depend on.
///
/// Of the problem that is model, parameters, filter, algorithm, objectives, constraints, population, generations (they
/// shape the phases of some algorithms), seed, and whether the start joins; not the limits that stop a search early, nor
/// pick, polish, device or threads. Of the log it is every number that a filter sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Identity {
    /// Of the problem.
    pub problem: [u8; 32],
    /// Of the log.
    pub log: [u8; 32],
}

impl Identity {
    /// Of a problem and the log it is searched on.
    #[must_use]
    pub fn of(problem: &Problem, log: &Log) -> Self {
        Self { problem: of_problem(problem), log: of_log(log) }
    }

    /// SHA-256 of every number of a log that a filter sees, in hexadecimal digits.
    #[must_use]
    pub fn of_log(log: &Log) -> String {
        of_log(log).iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// By the `Debug` form of its parts: that has every digit of every number, and what is added to them later.
fn of_problem(problem: &Problem) -> [u8; 32] {
    // Nothing is left out unseen: a new field has to be put on one side or the other.
    let Problem { source: _, text: _, data: _, model, parameters, filter, tune, simulate: _ } = problem;
    #[rustfmt::skip]
    let TuneSpec {
        algorithm, objectives, constraints, population, generations, seed, include_start,
        evaluations: _, wall_time: _, stall: _, target: _, polish: _, pick: _,
    } = tune;
    let mut sum = Sum(Sha256::new());
    let search = (algorithm, objectives, constraints, population, generations, seed, include_start);
    // Hashing cannot fail.
    let (model, filter) = (model.without_spans(), filter.without_spans());
    let _ = write!(sum, "{model:?} {parameters:?} {filter:?} {search:?}");
    sum.0.finalize().into()
}

fn of_log(log: &Log) -> [u8; 32] {
    let Log { source: _, measurements, inputs, truth, trajectories, times: _ } = log;
    let mut sum = Sum(Sha256::new());
    let _ = write!(sum, "{measurements:?} {inputs:?} {truth:?} {}", trajectories.len());
    for trajectory in trajectories {
        sum.number(trajectory.len() as u64);
        trajectory.time.iter().for_each(|t| sum.value(*t));
        for table in [&trajectory.z, &trajectory.u, &trajectory.truth] {
            sum.table(table, trajectory.len());
        }
    }
    sum.0.finalize().into()
}

/// A hash that is written to.
struct Sum(Sha256);

impl Sum {
    fn number(&mut self, number: u64) {
        self.0.update(number.to_le_bytes());
    }

    /// Missing values are all the same.
    fn value(&mut self, value: f64) {
        self.number(if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() });
    }

    fn table(&mut self, table: &Table, rows: usize) {
        self.number(table.columns() as u64);
        (0..rows).for_each(|k| table.row(k).iter().for_each(|value| self.value(*value)));
    }
}

impl fmt::Write for Sum {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text);
        Ok(())
    }
}
