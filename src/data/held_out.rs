//! The rows that a study does not see.

use super::{Log, SplitBy};

/// The rows that a study does not see.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// What the filter runs through: by time the whole log, by trajectory those held out.
    pub log: Log,
    /// The first row of each of its trajectories that scores; a trajectory's length where none does.
    pub from: Vec<usize>,
    /// What is held out.
    pub by: SplitBy,
    /// The share asked for.
    pub share: f64,
}

impl HeldOut {
    /// Whole trajectories.
    pub(crate) fn trajectories(log: Log, share: f64) -> Self {
        Self { from: vec![0; log.trajectories.len()], log, by: SplitBy::Trajectory, share }
    }

    /// Number of rows held out, scored or not.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.log.trajectories.iter().zip(&self.from).map(|(t, from)| t.len() - from).sum()
    }
}
