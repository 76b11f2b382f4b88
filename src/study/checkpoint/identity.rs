//! What a checkpoint is a checkpoint of.

use serde::{Deserialize, Serialize};

use super::canon::Canon;
use super::sum::Sum;
use crate::data::{Log, Table, Trajectory};
use crate::model::Problem;

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
        let mut canon = Canon::new(Sum::new());
        canon.problem(problem);
        Self { problem: canon.finish().digest(), log: of_log(log) }
    }

    /// SHA-256 of every number of a log that a filter sees, in hexadecimal digits.
    #[must_use]
    pub fn of_log(log: &Log) -> String {
        hexadecimal(of_log(log))
    }

    /// SHA-256 of the measurements alone, row by row with their names, in hexadecimal digits: what the innovations of two
    /// models are innovations of, whatever else of the log they use.
    #[must_use]
    pub fn of_measurements(log: &Log) -> String {
        of_tables(log, &log.measurements, |trajectory| &trajectory.z)
    }

    /// The same of the true states.
    #[must_use]
    pub fn of_truth(log: &Log) -> String {
        of_tables(log, &log.truth, |trajectory| &trajectory.truth)
    }
}

fn of_tables(log: &Log, names: &[String], table: impl Fn(&Trajectory) -> &Table) -> String {
    let mut sum = Sum::new();
    sum.names(names);
    sum.number(log.trajectories.len() as u64);
    for trajectory in &log.trajectories {
        sum.number(trajectory.len() as u64);
        sum.table(table(trajectory), trajectory.len());
    }
    hexadecimal(sum.digest())
}

fn hexadecimal(bytes: [u8; 32]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn of_log(log: &Log) -> [u8; 32] {
    let Log { source: _, measurements, inputs, truth, trajectories, times: _, ranges: _ } = log;
    let mut sum = Sum::new();
    [measurements, inputs, truth].iter().for_each(|names| sum.names(names));
    sum.number(trajectories.len() as u64);
    for trajectory in trajectories {
        sum.number(trajectory.len() as u64);
        trajectory.time.iter().for_each(|t| sum.value(*t));
        for table in [&trajectory.z, &trajectory.u, &trajectory.truth] {
            sum.table(table, trajectory.len());
        }
    }
    sum.digest()
}
