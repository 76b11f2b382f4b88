//! A filter run as CSV: one line a row of the log.

use std::io::Write;

use crate::data::{Log, Trajectory};
use crate::model::Problem;
use crate::number::exact;
use crate::reference::{Estimate, Step};

/// Which entries of the posterior covariance are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Covariance {
    /// The upper triangle, row by row.
    Triangle,
    /// The variances.
    Diagonal,
}

/// What a [`RunTable`] has besides its fixed columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Columns {
    /// Entries of every covariance.
    pub covariance: Covariance,
    /// Whether smoothed states and covariances stand at the end.
    pub smoothed: bool,
}

/// Writes trajectory (where the log has them), time as the log writes it, posterior states, covariance `P_a_b`, prior innovations
/// `nu_z`, their variances `S_z`, and `nis`; of a filter of several models the probability `p_mode` of each after the row; of
/// robust filters `rejected`, one less the weight of the row; then smoothed states `x_smoothed` and covariance
/// `P_a_b_smoothed`. A cell is
/// empty where nothing was measured; numbers read back bit for bit.
#[derive(Debug)]
pub struct RunTable<'a, W: Write> {
    log: &'a Log,
    /// Whether trajectories have names.
    named: bool,
    /// Entries of P, in order.
    entries: Vec<(usize, usize)>,
    robust: bool,
    smoothed: bool,
    table: csv::Writer<W>,
}

impl<'a, W: Write> RunTable<'a, W> {
    /// Writes the header.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn new(problem: &Problem, log: &'a Log, columns: Columns, out: W) -> csv::Result<Self> {
        let named = log.trajectories.iter().any(|t| !t.id.is_empty());
        let entries = entries(problem.model.states.len(), columns.covariance);
        let mut table = csv::Writer::from_writer(out);
        table.write_record(header(problem, named, &entries, columns.smoothed))?;
        Ok(Self { log, named, entries, robust: problem.robust.is_some(), smoothed: columns.smoothed, table })
    }

    /// Writes one row of trajectory number `trajectory`, with its smoothed estimate where there are such columns.
    ///
    /// # Errors
    /// When `out` cannot be written.
    ///
    /// # Panics
    /// If the log has no such trajectory.
    pub fn row(&mut self, trajectory: usize, step: &Step, smoothed: Option<&Estimate>) -> csv::Result<()> {
        let trajectory = &self.log.trajectories[trajectory];
        let time = self.log.time_text(trajectory, step.row);
        let mut cells = row(trajectory, (self.named, &time), step, &self.entries);
        if self.robust {
            cells.push(step.update.as_ref().map_or_else(String::new, |update| exact(update.rejected)));
        }
        if self.smoothed {
            let n = step.posterior.x.len();
            match smoothed {
                Some(smoothed) => cells.extend(estimate(smoothed, &self.entries)),
                None => cells.resize(cells.len() + n + self.entries.len(), String::new()),
            }
        }
        self.table.write_record(cells)
    }

    /// Writes what is still buffered.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn finish(mut self) -> csv::Result<()> {
        Ok(self.table.flush()?)
    }
}

fn entries(n: usize, covariance: Covariance) -> Vec<(usize, usize)> {
    let last = |i| if covariance == Covariance::Triangle { n } else { i + 1 };
    (0..n).flat_map(|i| (i..last(i)).map(move |j| (i, j))).collect()
}

fn header(problem: &Problem, named: bool, entries: &[(usize, usize)], smoothed: bool) -> Vec<String> {
    let states = &problem.model.states;
    let mut header = Vec::new();
    header.extend(named.then(|| problem.data.trajectory.clone().unwrap_or_else(|| "trajectory".to_owned())));
    header.push(problem.data.time.clone().unwrap_or_else(|| "time".to_owned()));
    header.extend(states.iter().cloned());
    header.extend(entries.iter().map(|&(i, j)| format!("P_{}_{}", states[i], states[j])));
    header.extend(problem.model.measurements.iter().map(|z| format!("nu_{z}")));
    header.extend(problem.model.measurements.iter().map(|z| format!("S_{z}")));
    header.push("nis".to_owned());
    header.extend(problem.modes.iter().map(|mode| format!("p_{}", mode.name)));
    header.extend(problem.robust.as_ref().map(|_| "rejected".to_owned()));
    if smoothed {
        header.extend(states.iter().map(|x| format!("{x}_smoothed")));
        header.extend(entries.iter().map(|&(i, j)| format!("P_{}_{}_smoothed", states[i], states[j])));
    }
    header
}

/// States, then entries of the covariance.
fn estimate<'a>(estimate: &'a Estimate, entries: &'a [(usize, usize)]) -> impl Iterator<Item = String> + 'a {
    let covariance = entries.iter().map(|&(i, j)| exact(estimate.p[(i, j)]));
    estimate.x.iter().map(|x| exact(*x)).chain(covariance)
}

fn row(trajectory: &Trajectory, (named, time): (bool, &str), step: &Step, entries: &[(usize, usize)]) -> Vec<String> {
    let m = trajectory.z.columns();
    let mut cells = Vec::with_capacity(3 + step.posterior.x.len() + entries.len() + 2 * m);
    cells.extend(named.then(|| trajectory.id.clone()));
    cells.push(time.to_owned());
    cells.extend(estimate(&step.posterior, entries));
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
    cells.extend(step.modes.iter().map(|probability| exact(*probability)));
    cells
}
