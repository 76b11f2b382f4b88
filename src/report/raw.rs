//! The error of the measurements themselves: what a filter has to beat.

use crate::data::Log;
use crate::model::{ExprKind, Problem, Symbol};
use crate::objective::{Kind, Objective};

/// RMSE of the raw measurements of an objective's states, over the rows that the objective scores; `None` unless the
/// objective is `rmse` and each of its states is measured directly (a component of h is that state alone).
///
/// A row counts when all those measurements and their truth are there.
#[must_use]
pub fn raw_rmse(problem: &Problem, log: &Log, objective: &Objective) -> Option<f64> {
    if objective.kind != Kind::Rmse || objective.states.is_empty() {
        return None;
    }
    // (measurement column, truth column) of each state.
    let columns: Vec<(usize, usize)> =
        objective.states.iter().map(|&state| direct(problem, log, state)).collect::<Option<_>>()?;
    let mut sum = 0.0;
    let mut rows = 0_u32;
    for trajectory in &log.trajectories {
        for k in objective.skip..trajectory.len() {
            let (z, truth) = (trajectory.z.row(k), trajectory.truth.row(k));
            let squared: f64 = columns.iter().map(|&(i, j)| (z[i] - truth[j]).powi(2)).sum();
            if !squared.is_nan() {
                sum += squared;
                rows += 1;
            }
        }
    }
    (rows > 0).then(|| (sum / f64::from(rows)).sqrt())
}

fn direct(problem: &Problem, log: &Log, state: usize) -> Option<(usize, usize)> {
    let measured = problem.model.h.iter().position(|h| h.kind == ExprKind::Symbol(Symbol::State(state)))?;
    let truth = log.truth.iter().position(|name| *name == problem.model.states[state])?;
    Some((measured, truth))
}
