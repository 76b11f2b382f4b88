//! One candidate through a whole log: where each trajectory starts, and what happens at its rows.

use super::families;
use super::filter::Filter;
use super::score::{Scorer, Seen};
use super::step::{Moment, Run, Step, Truth};
use super::{Cause, Failure};
use crate::data::{HeldOut, Log, Trajectory};
use crate::model::{First, Problem};
use crate::objective::Objective;

/// Runs the filter of `candidate` (searched parameters in their own units) over the whole log.
///
/// # Errors
/// When S is not positive definite or a number is not finite, with the place.
///
/// # Panics
/// If `candidate` does not have one value per searched parameter.
pub fn run(problem: &Problem, log: &Log, candidate: &[f64]) -> Result<Run, Failure> {
    let truth = Truth::of(problem, log);
    let mut trajectories = vec![Vec::new(); log.trajectories.len()];
    walk(problem, log, candidate, &mut |moment| {
        trajectories[moment.trajectory].push(moment.step(log, &truth));
    })?;
    Ok(Run { candidate: candidate.to_vec(), trajectories })
}

/// As [`run`], but keeps no row: each goes to `visit`, with the index of its trajectory. Gives the problem's objectives.
///
/// # Errors
/// As [`run`]; the rows before the failure have been visited.
///
/// # Panics
/// As [`run`].
pub fn visit(
    problem: &Problem,
    log: &Log,
    candidate: &[f64],
    visit: &mut impl FnMut(usize, &Step),
) -> Result<Vec<f64>, Failure> {
    let truth = Truth::of(problem, log);
    let mut scorer = Scorer::new((problem, candidate), &truth, &problem.tune.objectives);
    walk(problem, log, candidate, &mut |moment| {
        let step = moment.step(log, &truth);
        let place = (&log.trajectories[moment.trajectory], moment.row);
        scorer.row(moment.trajectory, place, Seen::of(&moment, true), || step.nees);
        visit(moment.trajectory, &step);
    })?;
    Ok(scorer.costs())
}

/// The problem's objectives for a candidate: [`run`] and [`super::score`] in one pass that keeps no rows.
///
/// # Errors
/// As [`run`].
///
/// # Panics
/// As [`run`].
pub fn costs(problem: &Problem, log: &Log, candidate: &[f64]) -> Result<Vec<f64>, Failure> {
    scores_where(problem, (log, candidate), &problem.tune.objectives, |_, _| true)
}

/// As [`costs`], with what the problem's constraints bound behind the objectives: what a study's oracle gives.
///
/// # Errors
/// As [`run`].
///
/// # Panics
/// As [`run`].
pub fn scores(problem: &Problem, log: &Log, candidate: &[f64]) -> Result<Vec<f64>, Failure> {
    scores_where(problem, (log, candidate), &problem.tune.scorers(), |_, _| true)
}

/// The problem's objectives for a candidate over held-out rows alone; the filter runs through the rows before them.
///
/// `skip` still counts from a trajectory's first row, and `mismatch` averages over the last of the held-out rows.
///
/// # Errors
/// As [`run`], also where the failure is in a row that does not score.
///
/// # Panics
/// As [`run`], and if `held_out.from` has not one entry a trajectory.
pub fn costs_held_out(problem: &Problem, held_out: &HeldOut, candidate: &[f64]) -> Result<Vec<f64>, Failure> {
    let place = (&held_out.log, candidate);
    scores_where(problem, place, &problem.tune.objectives, |trajectory, row| row >= held_out.from[trajectory])
}

/// As [`costs_held_out`], with what the problem's constraints bound behind the objectives.
///
/// # Errors
/// As [`costs_held_out`].
///
/// # Panics
/// As [`costs_held_out`].
pub fn scores_held_out(problem: &Problem, held_out: &HeldOut, candidate: &[f64]) -> Result<Vec<f64>, Failure> {
    let place = (&held_out.log, candidate);
    scores_where(problem, place, &problem.tune.scorers(), |trajectory, row| row >= held_out.from[trajectory])
}

/// Values over the rows for which `counts` (trajectory, row) is true.
fn scores_where(
    problem: &Problem,
    (log, candidate): (&Log, &[f64]),
    scorers: &[Objective],
    counts: impl Fn(usize, usize) -> bool,
) -> Result<Vec<f64>, Failure> {
    let truth = Truth::of(problem, log);
    let mut scorer = Scorer::new((problem, candidate), &truth, scorers);
    walk(problem, log, candidate, &mut |moment| {
        let trajectory = &log.trajectories[moment.trajectory];
        let nees = || truth.nees(trajectory, &moment);
        let seen = Seen::of(&moment, counts(moment.trajectory, moment.row));
        scorer.row(moment.trajectory, (trajectory, moment.row), seen, nees);
    })?;
    Ok(scorer.costs())
}

/// Shows every row to `visit`, trajectory by trajectory.
pub(super) fn walk(
    problem: &Problem,
    log: &Log,
    candidate: &[f64],
    visit: &mut impl FnMut(Moment),
) -> Result<(), Failure> {
    let model = &problem.model;
    let mut filter = families::of(problem, log, problem.parameters.resolve(candidate))
        .map_err(|cause| Failure::at(log, 0, 0, cause))?;
    if log.measurements.len() != model.measurements.len() || log.inputs.len() != model.inputs.len() {
        return Err(Failure::at(log, 0, 0, Cause::WrongColumns));
    }
    let first_dt = match model.first {
        First::Update => None,
        First::Predict { dt } => {
            Some(dt.or_else(|| log.regular_dt()).ok_or_else(|| Failure::at(log, 0, 0, Cause::NoFirstInterval))?)
        }
    };
    for (index, trajectory) in log.trajectories.iter().enumerate() {
        let mut row = 0;
        walk_trajectory(filter.as_mut(), trajectory, first_dt, &mut row, &mut |row, filter, updated| {
            let state = filter.state();
            let update = updated.then_some(state.update);
            visit(Moment { trajectory: index, row, update, state });
        })
        .map_err(|what| Failure::at(log, index, row, what))?;
    }
    Ok(())
}

/// `row` tells the caller where an error happened.
fn walk_trajectory(
    filter: &mut dyn Filter,
    trajectory: &Trajectory,
    first_dt: Option<f64>,
    row: &mut usize,
    visit: &mut impl FnMut(usize, &dyn Filter, bool),
) -> Result<(), Cause> {
    if filter.starts_from_measurement() {
        let Some(first) = (0..trajectory.len()).find(|&k| trajectory.is_complete(k)) else { return Ok(()) };
        *row = first;
        filter.start_from(trajectory.z.row(first), trajectory.u.row(first), trajectory.dt(first))?;
        visit(first, filter, false);
        *row = first + 1;
    } else {
        filter.start(first_dt, trajectory.dt(0))?;
    }
    while *row < trajectory.len() {
        let k = *row;
        if let Some(dt) = k.checked_sub(1).and_then(|before| trajectory.dt(before)) {
            filter.predict(dt, trajectory.u.row(k - 1))?;
        }
        let updated = filter.update(trajectory.z.row(k), trajectory.u.row(k))?;
        visit(k, filter, updated);
        *row += 1;
    }
    Ok(())
}
