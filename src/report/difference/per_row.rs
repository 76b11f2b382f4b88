//! What each held-out row adds to an objective.

use super::parts::Parts;
use crate::data::HeldOut;
use crate::model::Problem;
use crate::objective::{Kind, Objective};
use crate::reference::{self, Step};

/// One objective over the rows that score: each row has a value, and a weight that the sum of values is divided by.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct PerRow {
    /// Trajectory, value, weight; trajectory by trajectory, in time.
    rows: Vec<(usize, f64, f64)>,
}

/// What each row moves the objective by, if it is not what rows are on average: the influence function, whose sum is 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Influence {
    /// By trajectory and row.
    pub(super) rows: Vec<Vec<f64>>,
    /// Of `mismatch`, which is a mean over trajectories, each one's share.
    pub(super) trajectories: Option<Vec<f64>>,
}

/// Every objective of a candidate, row by row; `None` where its filter fails.
pub(super) fn per_row(problem: &Problem, held_out: &HeldOut, candidate: &[f64]) -> Option<Vec<PerRow>> {
    let log = &held_out.log;
    let truth: Vec<Option<usize>> =
        problem.model.states.iter().map(|state| log.truth.iter().position(|name| name == state)).collect();
    let objectives = &problem.tune.objectives;
    let mut all = vec![PerRow::default(); objectives.len()];
    let mut parts: Vec<Parts> = objectives.iter().map(|objective| Parts::new(problem, candidate, objective)).collect();
    let run = reference::visit(problem, log, candidate, &mut |trajectory, step| {
        let known = log.trajectories[trajectory].truth.row(step.row);
        let angles = &problem.model.angles;
        let error = |state: usize| {
            truth[state].map(|column| angles.between_states(state, step.posterior.x[state] - known[column]))
        };
        for ((objective, rows), parts) in objectives.iter().zip(&mut all).zip(&mut parts) {
            let scores = step.row >= held_out.from[trajectory] && step.row >= objective.skip;
            parts.add(objective, (trajectory, &log.trajectories[trajectory]), step, scores);
            if scores {
                rows.rows.extend(share(objective, step, &error).map(|(value, weight)| (trajectory, value, weight)));
            }
        }
    });
    run.ok()?;
    for ((objective, rows), parts) in objectives.iter().zip(&mut all).zip(&parts) {
        match objective.kind {
            Kind::Mismatch => rows.keep_window(objective),
            Kind::NisDistribution | Kind::Whiteness | Kind::Prediction => rows.rows = parts.linearised(objective),
            _ => {}
        }
    }
    Some(all)
}

/// Value and weight of a row; `None` where it does not score, or is made of several [`Parts`].
fn share(objective: &Objective, step: &Step, error: &impl Fn(usize) -> Option<f64>) -> Option<(f64, f64)> {
    let states = step.posterior.x.len();
    let components = |update: &reference::Update| update.present.len() as f64;
    match objective.kind {
        Kind::Nll => step.update.as_ref().map(|update| (update.nll, 1.0)),
        Kind::MseInnovation => step.update.as_ref().map(|update| (update.nu.norm_squared(), components(update))),
        Kind::Mismatch => step.update.as_ref().map(|update| (update.nu.norm_squared(), update.s.trace())),
        Kind::Nis | Kind::NisMean => step.update.as_ref().map(|update| (update.nis, components(update))),
        Kind::NisDistribution | Kind::Whiteness | Kind::Prediction => None,
        // No objective, so that nobody asks.
        Kind::Rejected => None,
        Kind::Nees | Kind::NeesMean => step.nees.map(|nees| (nees, states as f64)),
        Kind::Rmse | Kind::Distance => {
            let all: Vec<usize> = (0..states).filter(|state| error(*state).is_some()).collect();
            let states = if objective.states.is_empty() { &all } else { &objective.states };
            let squared = states.iter().map(|state| error(*state).map(|e| e * e)).sum::<Option<f64>>()?;
            let value = if objective.kind == Kind::Distance { squared.sqrt() } else { squared };
            (!value.is_nan()).then_some((value, 1.0))
        }
    }
}

impl PerRow {
    /// The last rows of each trajectory, with the weight of the last one on all where `ct = "last"`.
    fn keep_window(&mut self, objective: &Objective) {
        let mut kept = Vec::new();
        for rows in self.rows.chunk_by(|a, b| a.0 == b.0) {
            let rows = &rows[rows.len().saturating_sub(objective.window)..];
            let last = rows.last().map_or(f64::NAN, |row| row.2);
            kept.extend(
                rows.iter().map(|(t, value, weight)| (*t, *value, if objective.ct_last { last } else { *weight })),
            );
        }
        self.rows = kept;
    }

    /// The objective.
    #[cfg(test)]
    pub(super) fn cost(&self, objective: &Objective) -> f64 {
        let (value, weight) = self.sums();
        let mean = value / weight;
        match objective.kind {
            Kind::Nll | Kind::Distance => value,
            Kind::Nis | Kind::Nees => (mean - 1.0).abs(),
            Kind::Rmse => mean.sqrt(),
            Kind::Mismatch => {
                let each: Vec<f64> = self.mismatches().collect();
                each.iter().sum::<f64>() / each.len() as f64
            }
            Kind::MseInnovation
            | Kind::NisMean
            | Kind::NeesMean
            | Kind::NisDistribution
            | Kind::Whiteness
            | Kind::Prediction
            | Kind::Rejected => mean,
        }
    }

    fn sums(&self) -> (f64, f64) {
        self.rows.iter().fold((0.0, 0.0), |(value, weight), row| (value + row.1, weight + row.2))
    }

    /// |sum of values / sum of weights - 1| of each trajectory.
    fn mismatches(&self) -> impl Iterator<Item = f64> {
        self.trajectories().map(|rows| (ratio(rows) - 1.0).abs())
    }

    fn trajectories(&self) -> impl Iterator<Item = &[(usize, f64, f64)]> {
        self.rows.chunk_by(|a, b| a.0 == b.0)
    }

    /// The derivative of the objective by what each row adds (the delta method).
    pub(super) fn influence(&self, objective: &Objective) -> Influence {
        let (value, weight) = self.sums();
        let mean = value / weight;
        let slope = match objective.kind {
            Kind::Nll | Kind::Distance => weight,
            Kind::Nis | Kind::Nees => (mean - 1.0).signum(),
            Kind::Rmse => 0.5 / mean.sqrt(),
            Kind::Mismatch => return self.influence_on_mismatch(),
            Kind::MseInnovation
            | Kind::NisMean
            | Kind::NeesMean
            | Kind::NisDistribution
            | Kind::Whiteness
            | Kind::Prediction
            | Kind::Rejected => 1.0,
        };
        let of = |row: &(usize, f64, f64)| slope * (row.1 - mean * row.2) / weight;
        Influence { rows: self.trajectories().map(|rows| rows.iter().map(of).collect()).collect(), trajectories: None }
    }

    fn influence_on_mismatch(&self) -> Influence {
        let each: Vec<f64> = self.mismatches().collect();
        let count = each.len() as f64;
        let mean = each.iter().sum::<f64>() / count;
        let of = |rows: &[(usize, f64, f64)]| {
            let (ratio, weight) = (ratio(rows), rows.iter().map(|row| row.2).sum::<f64>());
            rows.iter().map(|row| (ratio - 1.0).signum() * (row.1 - ratio * row.2) / weight / count).collect()
        };
        let trajectories = each.iter().map(|mismatch| (mismatch - mean) / count).collect();
        Influence { rows: self.trajectories().map(of).collect(), trajectories: Some(trajectories) }
    }
}

fn ratio(rows: &[(usize, f64, f64)]) -> f64 {
    rows.iter().map(|row| row.1).sum::<f64>() / rows.iter().map(|row| row.2).sum::<f64>()
}
