//! How a filter's error runs along the track.

use crate::data::Log;
use crate::model::Problem;
use crate::reference::{self, Failure};

/// An error below this counts as converged; Fig. 3 starts at some 60.
const SMALL: f64 = 10.0;

/// The estimates of a filter along a track, by the reference.
#[derive(Debug, Clone)]
pub(super) struct Path {
    /// (d, v, a) of each row.
    pub(super) states: Vec<[f64; 3]>,
    /// Euclidean error of all three states at each row, k = 0 first.
    pub(super) errors: Vec<f64>,
}

impl Path {
    pub(super) fn of(problem: &Problem, log: &Log, r: f64) -> Result<Self, Failure> {
        let run = reference::run(problem, log, &[r])?;
        let states: Vec<[f64; 3]> = run
            .trajectories
            .iter()
            .flatten()
            .map(|step| [step.posterior.x[0], step.posterior.x[1], step.posterior.x[2]])
            .collect();
        let truth = &log.trajectories[0].truth;
        let error = |(k, x): (usize, &[f64; 3])| {
            x.iter().zip(truth.row(k)).map(|(x, truth)| (x - truth).powi(2)).sum::<f64>().sqrt()
        };
        let errors = states.iter().enumerate().map(error).collect();
        Ok(Self { states, errors })
    }

    /// First k from which the error stays small.
    #[must_use]
    pub(super) fn settled_at(&self) -> usize {
        self.errors.iter().rposition(|error| *error >= SMALL).map_or(0, |last| last + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settled_after_the_last_large_error() {
        let path = |errors: &[f64]| Path { states: Vec::new(), errors: errors.to_vec() }.settled_at();
        assert_eq!(path(&[50.0, 9.0, 11.0, 9.0, 1.0]), 3);
        assert_eq!((path(&[1.0]), path(&[11.0])), (0, 1));
    }
}
