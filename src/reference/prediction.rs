//! `prediction`: what a filter's estimates say of measurements several rows later.

use std::collections::VecDeque;

use nalgebra::DVector;

use super::estimate::{Update, count};
use super::evaluate::Scope;
use crate::data::Trajectory;
use crate::model::{Angles, Expr, Formula, Problem, Start};

/// Keeps the estimates of earlier rows and takes them through f, one formula after the other, up to the row that is measured.
#[derive(Debug)]
pub(crate) struct Predictor {
    f: Vec<Formula>,
    h: Vec<Formula>,
    angles: Angles,
    parameters: Vec<f64>,
    ahead: Vec<usize>,
    from_measurement: bool,
    trajectory: Option<usize>,
    /// Predicted states of the latest rows of the current trajectory, the last row's last.
    past: VecDeque<DVector<f64>>,
    stack: Vec<f64>,
}

impl Predictor {
    /// For a candidate, so many rows `ahead`, each at least 1.
    ///
    /// # Panics
    /// If `candidate` does not have one value per searched parameter.
    pub(crate) fn new(problem: &Problem, candidate: &[f64], ahead: &[usize]) -> Self {
        let compile = |formulas: &[Expr]| formulas.iter().map(Formula::of).collect();
        Self {
            f: compile(&problem.model.f),
            h: compile(&problem.model.h),
            angles: problem.model.angles.clone(),
            parameters: problem.parameters.resolve(candidate),
            ahead: ahead.to_vec(),
            from_measurement: problem.model.x0 == Start::Measurement,
            trajectory: None,
            past: VecDeque::new(),
            stack: Vec::new(),
        }
    }

    /// Passes a row of trajectory number `index`, every one of which has to pass in order, with the state predicted for it. For
    /// each distance the sum of squared errors of the present components and their number, 0 where no estimate is so old.
    pub(crate) fn row(
        &mut self,
        index: usize,
        (trajectory, row): (&Trajectory, usize),
        prior: &DVector<f64>,
        update: Option<&Update>,
    ) -> Vec<(f64, usize)> {
        if self.trajectory.replace(index) != Some(index) {
            self.past.clear();
            // What x0 was taken from is predicted by nothing, and itself no prediction.
            if self.from_measurement {
                return vec![(0.0, 0); self.ahead.len()];
            }
        }
        self.past.push_back(prior.clone());
        if self.past.len() > self.ahead.iter().copied().max().unwrap_or(0) {
            self.past.pop_front();
        }
        let ahead = std::mem::take(&mut self.ahead);
        let errors = ahead.iter().map(|ahead| match (update, *ahead) {
            // The innovation, whatever the filter takes for the mean of h.
            (Some(update), 1) => (update.nu.norm_squared(), update.present.len()),
            (Some(_), ahead) => self.squared_error(trajectory, row, ahead),
            (None, _) => (0.0, 0),
        });
        let errors = errors.collect();
        self.ahead = ahead;
        errors
    }

    /// Of the state that was predicted for the row `ahead - 1` rows ago.
    fn squared_error(&mut self, trajectory: &Trajectory, row: usize, ahead: usize) -> (f64, usize) {
        let Some(state) = self.past.len().checked_sub(ahead).map(|at| self.past[at].clone()) else { return (0.0, 0) };
        let Self { f, h, angles, parameters, stack, .. } = self;
        let mut states = state.as_slice().to_vec();
        for k in row + 1 - ahead..row {
            let dt = trajectory.dt(k).unwrap_or(f64::NAN);
            let scope = Scope { states: &states, parameters, inputs: trajectory.u.row(k), dt };
            states = f.iter().map(|formula| scope.value(formula, stack)).collect();
        }
        let scope = Scope { states: &states, parameters, inputs: trajectory.u.row(row), dt: f64::NAN };
        let mut sum = (0.0, 0);
        for (i, (formula, z)) in h.iter().zip(trajectory.z.row(row)).enumerate().filter(|(_, (_, z))| !z.is_nan()) {
            let error = angles.between_measurements(i, z - scope.value(formula, stack));
            sum = (sum.0 + error.powi(2), sum.1 + 1);
        }
        sum
    }
}

/// Sums of squared errors, one a distance.
#[derive(Debug)]
pub(super) struct Prediction {
    predictor: Predictor,
    sums: Vec<(f64, usize)>,
}

impl Prediction {
    pub(super) fn new(problem: &Problem, candidate: &[f64], ahead: &[usize]) -> Self {
        Self { predictor: Predictor::new(problem, candidate, ahead), sums: vec![(0.0, 0); ahead.len()] }
    }

    /// As [`Predictor::row`]; counts it where it `scores`.
    pub(super) fn row(
        &mut self,
        index: usize,
        place: (&Trajectory, usize),
        (prior, update): (&DVector<f64>, Option<&Update>),
        scores: bool,
    ) {
        let errors = self.predictor.row(index, place, prior, update);
        if scores {
            self.sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum = (sum.0 + error.0, sum.1 + error.1));
        }
    }

    /// The mean over the distances of mean squares; NaN where one of them has no row.
    pub(super) fn cost(&self) -> f64 {
        let mean = |(sum, components): &(f64, usize)| sum / count(*components);
        self.sums.iter().map(mean).sum::<f64>() / count(self.sums.len())
    }
}
