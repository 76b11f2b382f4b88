//! A row of a filter run, as the walk passes it and as it is kept, with what truth says of it.

use nalgebra::DVector;

use super::estimate::{Estimate, Update};
use super::filter::State;
use super::square_root::solve_transposed;
use crate::data::{Log, Trajectory};
use crate::model::{Angles, Problem};

/// Everything a filter run computed, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The candidate, searched parameters in their own units.
    pub candidate: Vec<f64>,
    /// One list of steps per trajectory of the log. With `x0 = "measurement"` a list begins at the first complete
    /// measurement, and is empty where there is none.
    pub trajectories: Vec<Vec<Step>>,
}

/// One row of a filter run.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Row of the trajectory.
    pub row: usize,
    /// Its time \[s\].
    pub time: f64,
    /// Before the measurement.
    pub prior: Estimate,
    /// The measurement's effect; `None` where nothing was measured or the row was the source of x0.
    pub update: Option<Update>,
    /// After the measurement.
    pub posterior: Estimate,
    /// e' P^-1 e of the posterior where truth of all states is there; NaN when P is not positive definite.
    pub nees: Option<f64>,
    /// The probabilities of the modes after the measurement; empty for a filter of one model.
    pub modes: Vec<f64>,
}

/// A row as the walk passes it.
#[derive(Clone, Copy)]
pub(super) struct Moment<'a> {
    pub(super) trajectory: usize,
    pub(super) row: usize,
    /// What the measurement did; `None` where there was none.
    pub(super) update: Option<&'a Update>,
    pub(super) state: State<'a>,
}

impl Moment<'_> {
    pub(super) fn step(&self, log: &Log, truth: &Truth) -> Step {
        let trajectory = &log.trajectories[self.trajectory];
        Step {
            row: self.row,
            time: trajectory.time[self.row],
            prior: self.state.prior.clone(),
            update: self.update.cloned(),
            posterior: self.state.posterior.clone(),
            nees: truth.nees(trajectory, self),
            modes: self.state.modes.to_vec(),
        }
    }
}

/// Which truth columns hold which states.
pub(super) struct Truth {
    /// For each state, its column of [`Trajectory::truth`].
    pub(super) column: Vec<Option<usize>>,
    angles: Angles,
}

impl Truth {
    pub(super) fn of(problem: &Problem, log: &Log) -> Self {
        let column = problem.model.states.iter().map(|s| log.truth.iter().position(|t| t == s)).collect();
        Self { column, angles: problem.model.angles.clone() }
    }

    /// Error of state `i` at a row, of an angle in [-pi, pi); `None` where its truth is unknown.
    pub(super) fn error(&self, trajectory: &Trajectory, row: usize, i: usize, x: &DVector<f64>) -> Option<f64> {
        let truth = trajectory.truth.row(row)[self.column[i]?];
        (!truth.is_nan()).then(|| self.angles.between_states(i, x[i] - truth))
    }

    /// e' P^-1 e where truth of all states is there; NaN when P is not positive definite.
    pub(super) fn nees(&self, trajectory: &Trajectory, moment: &Moment<'_>) -> Option<f64> {
        let Moment { row, state: State { posterior, posterior_root: root, .. }, .. } = moment;
        let n = self.column.len();
        let error: Option<Vec<f64>> = (0..n).map(|i| self.error(trajectory, *row, i, &posterior.x)).collect();
        let error = DVector::from_vec(error?);
        let known = |i: usize| root[(i, i)].abs() <= 8.0 * f64::EPSILON * posterior.p[(i, i)].sqrt();
        let mut normalised = DVector::zeros(n);
        solve_transposed(root, &error, &mut normalised);
        Some(if (0..n).any(known) { f64::NAN } else { normalised.norm_squared() })
    }
}
