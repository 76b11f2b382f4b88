//! One row as two tables: the state before it, and the operations of its step.

use super::machines::Machines;
use super::{Tape, find, sentences};
use crate::cli::console::Console;
use crate::cli::load::Loaded;
use crate::cli::options::PrecisionChoice;
use crate::data::Log;
use crate::evaluate::probe::Probe;
use crate::model::Problem;
use crate::number::significant;
use crate::reference::{self, Estimate};
use crate::table::{Cell, Table};

/// Digits of values: f32 has 7 to 8 of them.
const DIGITS: usize = 9;

impl Tape {
    /// The row's tables, and where machines part.
    pub(super) fn look(&self, row: usize, loaded: &Loaded, console: Console) -> anyhow::Result<String> {
        let Loaded { problem, log, .. } = loaded;
        let candidate = find::candidate(problem, &self.candidate)?;
        let t = find::trajectory(log, self.trajectory.as_deref())?;
        let place = (t, row - find::first_row(problem, log, t, row)?);
        let mut machines = vec![Machines::new(Probe::double(problem, log, place, &candidate)?)];
        if self.precision != PrecisionChoice::F64 {
            match Probe::single(problem, log, place, &candidate) {
                Ok(probe) => machines.push(Machines::new(probe)),
                Err(error) if self.precision == PrecisionChoice::F32 => return Err(error.into()),
                Err(error) => console.warn(format_args!("no column in f32: {error}")),
            }
        }
        let shown = machines.len() - 1;
        self.add_adapter(&mut machines[shown], console)?;
        let reference = prior(problem, log, (t, row), &candidate, console);
        let (trajectory, shown) = (&log.trajectories[t], &machines[shown]);
        let (line, time) = (trajectory.line[row], log.time_text(trajectory, row));
        let operations = operations(shown);
        Ok(format!(
            "# prior of row {row} (line {line}, time {time}); off: from the reference, in its standard deviations\n{}\
             # the step of the row in {}: {} operations; off: from the column before, as a share of an operation's largest term, \
             or of what a standard deviation of the state makes of it\n{operations}{}",
            state(problem, reference.as_ref(), &machines),
            shown.probe.program().precision(),
            operations.rows.len(),
            sentences::of(shown, row),
        ))
    }
}

/// The reference's prior; says why where it has none.
fn prior(problem: &Problem, log: &Log, place: (usize, usize), candidate: &[f64], console: Console) -> Option<Estimate> {
    let mut prior = None;
    let run = reference::visit(problem, log, candidate, &mut |t, step| {
        if (t, step.row) == place {
            prior = Some(step.prior.clone());
        }
    });
    if let (None, Err(failure)) = (&prior, run) {
        console.warn(format_args!("no column for the reference: {failure}"));
    }
    prior
}

/// The prior, one line an entry: the mean, then the upper triangle of P.
fn state(problem: &Problem, reference: Option<&Estimate>, machines: &[Machines]) -> Table {
    let names = &problem.model.states;
    let n = names.len();
    let priors = machines.iter().flat_map(|m| m.all().map(|machine| (&machine.name, m.probe.prior(&machine.seen))));
    let priors: Vec<(&String, Vec<f64>)> = priors.collect();
    let heads = priors.iter().flat_map(|(name, _)| [name.as_str(), "off"]);
    let mut table = Table::of(["entry", "reference"].into_iter().chain(heads));
    let places = (0..n).flat_map(|i| (i..n).map(move |j| (i, Some(j))));
    for (entry, (i, j)) in (0..n).map(|i| (i, None)).chain(places).enumerate() {
        let name = j.map_or_else(|| format!("x.{}", names[i]), |j| format!("P.{}.{}", names[i], names[j]));
        // The value of the reference, and its standard deviation.
        let expected = reference.map(|Estimate { x, p }| {
            let sigma = |i: usize| p[(i, i)].max(0.0).sqrt();
            j.map_or_else(|| (x[i], sigma(i)), |j| (p[(i, j)], sigma(i) * sigma(j)))
        });
        let mut row = vec![Cell::text(name), expected.map_or(Cell::Empty, |(value, _)| Cell::Number(value, DIGITS))];
        for (_, prior) in &priors {
            let off = expected.map(|(value, sigma)| {
                let error = (prior[entry] - value).abs();
                if error > 0.0 { error / if sigma > 0.0 { sigma } else { value.abs() } } else { 0.0 }
            });
            row.extend([Cell::Number(prior[entry], DIGITS), share(off)]);
        }
        table.push(row);
    }
    table
}

/// The operations with their values on every machine.
fn operations(machines: &Machines) -> Table {
    let probe = &machines.probe;
    let lines = probe.program().lines(probe.step().0);
    let in_f64 = machines.in_f64();
    let columns: Vec<_> = in_f64.iter().chain(machines.all()).collect();
    let shares: Vec<Vec<Option<f64>>> =
        columns.windows(2).map(|pair| probe.shares(&pair[1].seen, &pair[0].seen)).collect();
    let heads = columns.iter().skip(1).flat_map(|machine| [machine.name.as_str(), "off"]);
    let mut table = Table::of(["operation", columns[0].name.as_str()].into_iter().chain(heads));
    for (i, line) in lines.into_iter().enumerate() {
        let value = |column: usize| Cell::Number(columns[column].seen.values[i], DIGITS);
        let rest = shares.iter().enumerate().flat_map(|(column, shares)| [value(column + 1), share(shares[i])]);
        table.push([Cell::text(line), value(0)].into_iter().chain(rest));
    }
    table
}

fn share(share: Option<f64>) -> Cell {
    share.map_or(Cell::Empty, |share| Cell::text(significant(share, 2)))
}
