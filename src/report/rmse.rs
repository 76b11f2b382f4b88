//! Errors of single states against truth.

use nalgebra::DVector;

use super::Named;
use crate::data::{Log, Trajectory};
use crate::model::{Angles, Problem};

/// Squared errors of each state that has truth, over the rows where its own truth is known.
#[derive(Debug, Clone)]
pub struct StateErrors {
    /// Name, place among the states, column of truth.
    states: Vec<(String, usize, usize)>,
    /// Sum of squared errors and number of rows.
    sums: Vec<(f64, f64)>,
    angles: Angles,
}

impl StateErrors {
    /// None yet, for states of `problem` that `log` has truth of.
    #[must_use]
    pub fn new(problem: &Problem, log: &Log) -> Self {
        let states = &problem.model.states;
        let of = |(column, name): (usize, &String)| {
            let state = states.iter().position(|state| state == name)?;
            Some((name.clone(), state, column))
        };
        let states: Vec<_> = log.truth.iter().enumerate().filter_map(of).collect();
        Self { sums: vec![(0.0, 0.0); states.len()], states, angles: problem.model.angles.clone() }
    }

    /// An estimate of a row's state, n.
    ///
    /// # Panics
    /// If the trajectory has no such row.
    pub fn add(&mut self, trajectory: &Trajectory, row: usize, x: &DVector<f64>) {
        let truth = trajectory.truth.row(row);
        for ((_, state, column), (sum, rows)) in self.states.iter().zip(&mut self.sums) {
            let error = self.angles.between_states(*state, x[*state] - truth[*column]);
            if !error.is_nan() {
                *sum += error * error;
                *rows += 1.0;
            }
        }
    }

    /// Root of the mean squared error of each state, in its unit; states without a row of truth are left out.
    #[must_use]
    pub fn rmse(&self) -> Named<f64> {
        let known = self.states.iter().zip(&self.sums).filter(|(_, (_, rows))| *rows > 0.0);
        known.map(|((name, ..), (sum, rows))| (name.as_str(), (sum / rows).sqrt())).collect()
    }
}
