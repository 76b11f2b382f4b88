//! How far a filter carries a small change of its measurements.
//!
//! A nonlinear filter that has lost its track is chaotic: two runs that differ by rounding part, and no arithmetic keeps its
//! likelihood. Where it has not, a change of every z by a share of its standard deviation changes the likelihood a row by
//! about that share over the root of the number of rows.

use rand_distr::{Distribution, StandardNormal};

use super::Failure;
use super::estimate::{Update, count};
use super::run::walk;
use crate::data::{Log, Table};
use crate::model::Problem;
use crate::random::{Purpose, Stream};

/// The change, in standard deviations of an innovation.
const CHANGE: f64 = 1e-9;
/// Draws of it, of which the worst counts.
const DRAWS: u64 = 3;

/// The amplification A of `candidate`: |nll' - nll| over the number of measured rows and over 1e-9, where nll' is that of
/// the log with every z changed by a normal draw of 1e-9 standard deviations; the largest of three draws, which are the same
/// in every call. Below 1 the filter takes small changes in; far above 1 its nll depends on the last digits of the log.
///
/// The standard deviation is that of the component's innovation, sqrt(S_ii), in the row, and at most the median of its rows:
/// a diffuse start or a gap, where S is far above all that follows, would count as amplification otherwise. Infinite where a
/// changed log makes the filter fail, NaN where nothing is measured.
///
/// # Errors
/// As [`super::run`], of the log as it is.
///
/// # Panics
/// As [`super::run`].
pub fn amplification(problem: &Problem, log: &Log, candidate: &[f64]) -> Result<f64, Failure> {
    let components = log.measurements.len();
    let mut deviations: Deviations =
        log.trajectories.iter().map(|t| vec![vec![f64::NAN; components]; t.len()]).collect();
    let (nll, rows) = likelihood(problem, log, candidate, &mut |trajectory, row, update| {
        for (component, variance) in update.present.iter().zip(update.s.diagonal().iter()) {
            deviations[trajectory][row][*component] = variance.sqrt();
        }
    })?;
    (0..components).for_each(|component| limit(&mut deviations, component));
    let mut worst = 0.0f64;
    for draw in 0..DRAWS {
        let changed = changed(log, &deviations, draw);
        let found = likelihood(problem, &changed, candidate, &mut |_, _, _| {});
        worst = worst.max(found.map_or(f64::INFINITY, |(found, _)| (found - nll).abs()));
    }
    Ok(worst / count(rows) / CHANGE)
}

/// By trajectory, row and component; NaN where there is no update.
type Deviations = Vec<Vec<Vec<f64>>>;

/// nll and the number of rows that it is of, each shown to `see` with its trajectory and row.
fn likelihood(
    problem: &Problem,
    log: &Log,
    candidate: &[f64],
    see: &mut impl FnMut(usize, usize, &Update),
) -> Result<(f64, usize), Failure> {
    let (mut nll, mut rows) = (0.0, 0);
    walk(problem, log, candidate, &mut |moment| {
        if let Some(update) = moment.update {
            nll += update.nll;
            rows += 1;
            see(moment.trajectory, moment.row, update);
        }
    })?;
    Ok((nll, rows))
}

/// Cuts what is above the component's median.
fn limit(deviations: &mut Deviations, component: usize) {
    let all = deviations.iter().flatten().map(|row| row[component]);
    let mut sorted: Vec<f64> = all.filter(|deviation| !deviation.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2) else { return };
    let above = deviations.iter_mut().flatten().filter(|row| row[component] > *median);
    above.for_each(|row| row[component] = *median);
}

/// The log with other measurements.
fn changed(log: &Log, deviations: &Deviations, draw: u64) -> Log {
    let mut log = log.clone();
    for (index, (trajectory, deviations)) in (0..).zip(log.trajectories.iter_mut().zip(deviations)) {
        let mut z = Table::new(trajectory.z.columns());
        for (row, (k, deviations)) in (0..).zip(deviations.iter().enumerate()) {
            let mut stream = Stream::new(draw, Purpose::Amplification, index, row);
            let cells = trajectory.z.row(k).iter().zip(deviations).map(|(z, deviation)| {
                let normal: f64 = StandardNormal.sample(&mut stream);
                if deviation.is_nan() { *z } else { z + CHANGE * normal * deviation }
            });
            z.push(&cells.collect::<Vec<f64>>());
        }
        trajectory.z = z;
    }
    log
}
