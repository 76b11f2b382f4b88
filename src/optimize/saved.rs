//! States of optimisers as bytes (postcard), and their checks on the way back.

use serde::{Serialize, de::DeserializeOwned};

use super::RestoreError;
use crate::population::Population;

/// The state as bytes; `None` if it cannot be written, which plain numbers always can.
pub(super) fn write(state: &impl Serialize) -> Option<Vec<u8>> {
    postcard::to_stdvec(state).ok()
}

/// Reads the saved state of one optimiser.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reader {
    /// Name in the registry.
    pub(super) algorithm: &'static str,
    /// Number of coordinates.
    pub(super) dimension: usize,
}

impl Reader {
    /// All of `saved` as a state; what the numbers mean is still to be checked.
    pub(super) fn read<T: DeserializeOwned>(self, saved: &[u8]) -> Result<T, RestoreError> {
        match postcard::take_from_bytes(saved) {
            Ok((state, [])) => Ok(state),
            _ => Err(self.refuse("its bytes are not a state of this algorithm")),
        }
    }

    /// `problem` unless `holds`.
    pub(super) fn ensure(self, holds: bool, problem: &'static str) -> Result<(), RestoreError> {
        if holds { Ok(()) } else { Err(self.refuse(problem)) }
    }

    /// The number of generations told, of which there is at least one and at most one more than `generations`.
    pub(super) fn told(self, told: usize, generations: usize) -> Result<usize, RestoreError> {
        let possible = told >= 1 && told - 1 <= generations;
        self.ensure(possible, "its generation is not one of this search").map(|()| told)
    }

    /// Exactly `rows` positions (or velocities).
    pub(super) fn positions(self, values: Vec<f64>, rows: usize) -> Result<Population, RestoreError> {
        let whole = self.dimension > 0 && rows.checked_mul(self.dimension) == Some(values.len());
        self.ensure(whole, "its population or its number of coordinates is another")?;
        Ok(Population::from_rows(self.dimension, values))
    }

    const fn refuse(self, problem: &'static str) -> RestoreError {
        RestoreError { algorithm: self.algorithm, problem }
    }
}
