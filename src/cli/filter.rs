//! `kfgpu filter`: one run of one filter.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::console::Console;
use super::files::{self, Destination};
use super::folder::OutFolder;
use super::load::{self, Loaded};
use super::{Ending, memory, paths, pictures};
use crate::objective::Objective;
use crate::reference::{self, Smoothed, Step};
use crate::report::{Columns, Consistency, Covariance, Evidence, Named, RunTable, StateErrors, short};

/// Run one filter over the log in f64, and write its states, covariances and innovations as CSV.
///
/// Columns: trajectory (where the log has them), time as the log writes it, posterior states, posterior covariance `P_a_b`, prior
/// innovations `nu_z`, their variances `S_z`, and `nis`; of a filter of several models (imm) the probability of each after the
/// row, `p_mode`; with --smooth also smoothed states `x_smoothed` and covariance
/// `P_a_b_smoothed`. A cell is empty where nothing was measured.
#[derive(Debug, Args)]
pub(super) struct Filter {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Another problem file whose start values are used, such as the tuned.toml that `tune --out` writes, or that folder
    /// (default: the start values of PROBLEM).
    #[arg(long, value_name = "FILE|DIR")]
    parameters: Option<PathBuf>,

    /// Log to run on in place of the problem file's; `-` reads it from standard input (default: the file's
    /// `data.file`).
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Add columns of smoothed states and covariances, which take all measurements of the trajectory into account, later
    /// ones too (default: the filter's alone, which knows no future); for looking back at a finished log, not for what a
    /// filter would have done at the time. An adaptive filter is smoothed with the Q and R that it used on the way.
    #[arg(long)]
    smooth: bool,

    /// Write only the variances of the covariance (default: its upper triangle), for many states.
    #[arg(long)]
    diagonal: bool,

    /// File for the table, written whole or not at all; `-` is standard output (default: standard output).
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Folder for pictures of the run as SVG: estimates, innovations, NIS, autocorrelation, histogram (default: none is
    /// drawn); it is made if need be.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,

    /// Replace the file of --out and the pictures of --figures if they exist (default: keep an earlier table under a
    /// number, and refuse anything else).
    #[arg(long)]
    force: bool,

    /// Print objectives and consistency as one JSON object on stdout (default: the table, and a summary on stderr), for
    /// programs; the table then goes only to --out.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Summary {
    parameters: Named<f64>,
    objectives: Named<f64>,
    consistency: Consistency,
    rmse: Option<Rmse>,
    warnings: Vec<String>,
}

/// RMSE of each state against its truth, in its unit.
#[derive(Debug, Serialize)]
struct Rmse {
    filter: Named<f64>,
    /// With --smooth.
    smoother: Option<Named<f64>>,
}

/// What is collected while the filter runs.
struct Gathered<'a> {
    loaded: &'a Loaded,
    evidence: Evidence<'a>,
    errors: StateErrors,
}

impl Filter {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let mut table =
            (!self.json || self.out.is_some()).then(|| Destination::prepare(self.out.as_deref())).transpose()?;
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let (problem, log) = (&loaded.problem, &loaded.log);
        let read = [Some(self.problem.as_path()), loaded.origin.file(), self.parameters.as_deref()];
        paths::ensure_not_read(self.out.as_deref(), &read)?;
        let figures = self.figures.as_deref().map(OutFolder::prepare).transpose()?;
        if !self.force {
            figures.as_ref().map(pictures::refuse_existing).transpose()?;
        }
        if let Some(table) = &mut table {
            table.respect(&self.header(&loaded), self.force)?;
        }
        let candidate = load::candidate(problem, self.parameters.as_deref())?;
        if self.smooth {
            memory::ensure_smoother_fits(problem, log)?;
        }
        let smoothed = self.smooth.then(|| reference::smooth(problem, log, &candidate)).transpose()?;
        let mut gathered = Gathered::new(&loaded);
        let costs = match &table {
            None => reference::visit(problem, log, &candidate, &mut |t, step| gathered.add(t, step))?,
            Some(table) => self.write(table, console, &candidate, smoothed.as_deref(), &mut gathered)?,
        };
        let summary = Summary {
            parameters: Named::new(problem.parameters.names(), candidate.iter().copied()),
            objectives: Named::new(problem.tune.objectives.iter().map(Objective::name), costs),
            consistency: gathered.evidence.judge(problem, &candidate),
            rmse: Rmse::of(&gathered, smoothed.as_deref()),
            warnings: loaded.warnings.clone(),
        };
        if let Some(folder) = &figures {
            pictures::write_run(folder, problem, log, &candidate, &summary.consistency.whiteness)?;
        }
        if self.json {
            files::print_json(&summary)?;
        } else {
            for (name, cost) in summary.objectives.iter() {
                console.note(format_args!("{name} = {cost}"));
            }
            summary.rmse.iter().flat_map(Rmse::lines).for_each(|line| console.note(line));
            console.note(&summary.consistency);
        }
        Ok(Ending::Done)
    }

    const fn columns(&self) -> Columns {
        let covariance = if self.diagonal { Covariance::Diagonal } else { Covariance::Triangle };
        Columns { covariance, smoothed: self.smooth }
    }

    /// The first line of the table.
    fn header(&self, Loaded { problem, log, .. }: &Loaded) -> Vec<u8> {
        files::first_line(|out| Ok(RunTable::new(problem, log, self.columns(), out)?.finish()?))
    }

    /// Runs the filter into the table; gives the objectives.
    fn write(
        &self,
        table: &Destination,
        console: Console,
        candidate: &[f64],
        smoothed: Option<&[Vec<Smoothed>]>,
        gathered: &mut Gathered,
    ) -> anyhow::Result<Vec<f64>> {
        let Loaded { problem, log, .. } = gathered.loaded;
        let columns = self.columns();
        let mut costs = Vec::new();
        table.write(console, |out| {
            let mut rows = RunTable::new(problem, log, columns, out)?;
            let mut written = Ok(());
            let mut next = 0;
            costs = reference::visit(problem, log, candidate, &mut |trajectory, step| {
                gathered.add(trajectory, step);
                // Rows come trajectory by trajectory, and both lists begin with the same row.
                let list = smoothed.map_or(&[][..], |all| &all[trajectory]);
                next = if list.first().is_some_and(|first| first.row == step.row) { 0 } else { next };
                let estimate = list.get(next).map(|smoothed| &smoothed.estimate);
                next += 1;
                if written.is_ok() {
                    written = rows.row(trajectory, step, estimate);
                }
            })?;
            written?;
            Ok(rows.finish()?)
        })?;
        Ok(costs)
    }
}

impl<'a> Gathered<'a> {
    fn new(loaded: &'a Loaded) -> Self {
        let Loaded { problem, log, .. } = loaded;
        Self { loaded, evidence: Evidence::new(problem, log), errors: StateErrors::new(problem, log) }
    }

    fn add(&mut self, trajectory: usize, step: &Step) {
        self.evidence.add(trajectory, step);
        self.errors.add(&self.loaded.log.trajectories[trajectory], step.row, &step.posterior.x);
    }
}

impl Rmse {
    /// `None` without truth.
    fn of(gathered: &Gathered, smoothed: Option<&[Vec<Smoothed>]>) -> Option<Self> {
        let filter = gathered.errors.rmse();
        if filter.iter().len() == 0 {
            return None;
        }
        let Loaded { problem, log, .. } = gathered.loaded;
        let smoother = smoothed.map(|all| {
            let mut errors = StateErrors::new(problem, log);
            for (trajectory, rows) in log.trajectories.iter().zip(all) {
                rows.iter().for_each(|s| errors.add(trajectory, s.row, &s.estimate.x));
            }
            errors.rmse()
        });
        Some(Self { filter, smoother })
    }

    fn lines(&self) -> impl Iterator<Item = String> {
        self.filter.iter().map(|(state, filter)| {
            let smoother = self.smoother.as_ref().and_then(|named| named.get(state));
            let smoother = smoother.map_or_else(String::new, |v| format!(", smoother {}", short(*v, 5)));
            format!("rmse of {state}: filter {}{smoother}", short(*filter, 5))
        })
    }
}
