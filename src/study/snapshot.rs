//! A search between two generations, as it can be taken up again.

use serde::{Deserialize, Serialize};

use super::front::Front;
use super::record::{FINALISTS, Reached, Record};
use super::{Generation, Scored, StudyError};
use crate::evaluate::Device;

/// Everything that the rest of a search and its outcome depend on, but for the study and the evaluator.
///
/// Checkpoints store the fields in this order: who adds one raises [`super::Checkpoint::VERSION`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Name of the optimiser.
    pub algorithm: String,
    /// Its state, by [`crate::optimize::Optimizer::save`].
    #[serde(with = "block")]
    pub optimizer: Vec<u8>,
    /// The best distinct candidates so far, best first.
    pub archive: Vec<Scored>,
    /// The user's start, if generation 0 held it and it did not fail.
    pub start: Option<Scored>,
    /// One row a finished generation.
    pub history: Vec<Generation>,
    /// Generations since the last gain.
    pub stalled: usize,
    /// What was reached by that gain.
    pub reached: Option<Reached>,
    /// The front so far, with several objectives.
    pub front: Option<Front>,
    /// Time inside the evaluator so far, in seconds.
    pub evaluate_s: f64,
    /// Time of the search so far, in seconds.
    pub wall_s: f64,
    /// Where the last generation was computed. Costs of two precisions do not compare.
    pub device: Device,
}

impl Snapshot {
    pub(super) fn of(algorithm: &str, optimizer: Vec<u8>, record: &Record, device: Device) -> Self {
        Self {
            algorithm: algorithm.to_owned(),
            optimizer,
            archive: record.archive.members().to_vec(),
            start: record.start.clone(),
            history: record.history.clone(),
            stalled: record.stalled,
            reached: record.reached,
            front: record.front.clone(),
            evaluate_s: record.evaluate_s,
            wall_s: record.seconds(),
            device,
        }
    }

    /// Evaluations so far.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.history.last().map_or(0, |row| row.evaluations)
    }

    /// How many of them failed.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.history.iter().fold(0, |sum, row| sum.saturating_add(row.failed as u64))
    }

    /// Whether it can be one of a search by this optimiser, over so many parameters and objectives.
    pub(super) fn check(&self, algorithm: &str, dimension: usize, objectives: usize) -> Result<(), StudyError> {
        let shaped = |s: &Scored| s.candidate.len() == dimension && s.costs.len() == objectives;
        let finite = |s: &Scored| s.costs.iter().all(|x| x.is_finite()) && s.violation >= 0.0;
        let numbered = self.history.iter().enumerate().all(|(i, row)| row.generation == i);
        let growing = self.history.windows(2).all(|rows| rows[0].evaluations <= rows[1].evaluations);
        let counted = self.failed() <= self.evaluations() && self.evaluations() < u64::MAX / 2;
        let times = [self.wall_s, self.evaluate_s];
        let scored = || self.archive.iter().chain(&self.start);
        let checks = [
            (self.algorithm == algorithm, "its algorithm is another"),
            (scored().all(shaped), "its numbers of parameters and objectives are others"),
            (scored().all(finite) && self.archive.len() <= FINALISTS, "its best candidates cannot be"),
            (Front::fits(self.front.as_ref(), dimension, objectives), "its front cannot be"),
            (!self.history.is_empty() && numbered && growing, "its history has gaps"),
            (counted && self.stalled <= self.history.len(), "its counts cannot be"),
            (times.iter().all(|t| (0.0..f64::INFINITY).contains(t)), "its times are no times"),
        ];
        let wrong = checks.into_iter().find(|(holds, _)| !holds);
        wrong.map_or(Ok(()), |(_, problem)| Err(StudyError::Snapshot { problem }))
    }
}

/// Bytes in one piece; serde's own form of a vector takes them one by one.
mod block {
    use serde::de::{Deserializer, Visitor};
    use serde::ser::Serializer;
    use std::fmt;

    pub(super) fn serialize<S: Serializer>(bytes: &[u8], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_bytes(bytes)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u8>, D::Error> {
        from.deserialize_bytes(Block)
    }

    struct Block;

    impl Visitor<'_> for Block {
        type Value = Vec<u8>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("bytes")
        }

        fn visit_bytes<E>(self, bytes: &[u8]) -> Result<Vec<u8>, E> {
            Ok(bytes.to_vec())
        }
    }
}
