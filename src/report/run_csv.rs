//! A filter run as CSV: one line a row of the log.

use std::io::Write;

use super::number::exact;
use crate::data::{Log, Trajectory};
use crate::model::Problem;
use crate::reference::{Run, Step};

/// Which entries of the posterior covariance are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Covariance {
    /// The upper triangle, row by row.
    Triangle,
    /// The variances.
    Diagonal,
}

/// Writes trajectory (where the log has them), time [s], posterior states, covariance `P_a_b`, prior innovations
/// `nu_z`, their variances `S_z`, and `nis`. A cell is empty where nothing was measured; numbers read back bit for bit.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_run(problem: &Problem, log: &Log, run: &Run, covariance: Covariance, out: impl Write) -> csv::Result<()> {
    let named = log.trajectories.iter().any(|t| !t.id.is_empty());
    let entries = entries(problem.model.states.len(), covariance);
    let mut table = csv::Writer::from_writer(out);
    table.write_record(header(problem, named, &entries))?;
    for (trajectory, steps) in log.trajectories.iter().zip(&run.trajectories) {
        for step in steps {
            table.write_record(row(trajectory, named, step, &entries))?;
        }
    }
    Ok(table.flush()?)
}

fn entries(n: usize, covariance: Covariance) -> Vec<(usize, usize)> {
    let last = |i| if covariance == Covariance::Triangle { n } else { i + 1 };
    (0..n).flat_map(|i| (i..last(i)).map(move |j| (i, j))).collect()
}

fn header(problem: &Problem, named: bool, entries: &[(usize, usize)]) -> Vec<String> {
    let states = &problem.model.states;
    let mut header = Vec::new();
    header.extend(named.then(|| problem.data.trajectory.clone().unwrap_or_else(|| "trajectory".to_owned())));
    header.push(problem.data.time.clone().unwrap_or_else(|| "time".to_owned()));
    header.extend(states.iter().cloned());
    header.extend(entries.iter().map(|&(i, j)| format!("P_{}_{}", states[i], states[j])));
    header.extend(problem.model.measurements.iter().map(|z| format!("nu_{z}")));
    header.extend(problem.model.measurements.iter().map(|z| format!("S_{z}")));
    header.push("nis".to_owned());
    header
}

fn row(trajectory: &Trajectory, named: bool, step: &Step, entries: &[(usize, usize)]) -> Vec<String> {
    let m = trajectory.z.columns();
    let mut cells = Vec::with_capacity(3 + step.posterior.x.len() + entries.len() + 2 * m);
    cells.extend(named.then(|| trajectory.id.clone()));
    cells.push(exact(step.time));
    cells.extend(step.posterior.x.iter().map(|x| exact(*x)));
    cells.extend(entries.iter().map(|&(i, j)| exact(step.posterior.p[(i, j)])));
    let mut innovations = vec![String::new(); m];
    let mut variances = vec![String::new(); m];
    if let Some(update) = &step.update {
        for (i, &component) in update.present.iter().enumerate() {
            innovations[component] = exact(update.nu[i]);
            variances[component] = exact(update.s[(i, i)]);
        }
    }
    cells.extend(innovations);
    cells.extend(variances);
    cells.push(step.update.as_ref().map_or_else(String::new, |update| exact(update.nis)));
    cells
}
