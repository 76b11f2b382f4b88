//! `kfgpu filter`: one run of one filter.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::console::Console;
use super::files::{self, Destination, OutFolder};
use super::load::{self, Loaded};
use super::{Ending, pictures};
use crate::model::Problem;
use crate::objective::Objective;
use crate::reference;
use crate::report::{Consistency, Covariance, Evidence, Named, RunTable};

/// Run one filter over the log in f64, and write its states, covariances and innovations as CSV.
///
/// Columns: trajectory (where the log has them), time, posterior states, posterior covariance `P_a_b`, prior
/// innovations `nu_z`, their variances `S_z`, and `nis`. A cell is empty where nothing was measured.
#[derive(Debug, Args)]
pub(super) struct Filter {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Another problem file whose start values are used, such as the tuned.toml that `tune --out` writes (default: the
    /// start values of PROBLEM).
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,

    /// Log to run on in place of the problem file's; `-` reads it from standard input (default: the file's
    /// `data.file`).
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

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
    warnings: Vec<String>,
}

impl Filter {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let table =
            (!self.json || self.out.is_some()).then(|| Destination::prepare(self.out.as_deref())).transpose()?;
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let (problem, log) = (&loaded.problem, &loaded.log);
        let candidate = match &self.parameters {
            Some(path) => problem.candidate_from(&Problem::open(path)?)?,
            None => problem.parameters.baseline(),
        };
        if let Some(folder) = &self.figures {
            OutFolder::prepare(folder)?;
        }
        let mut evidence = Evidence::new(problem, log);
        let costs = match &table {
            None => reference::visit(problem, log, &candidate, &mut |t, step| evidence.add(t, step))?,
            Some(table) => self.write(table, &loaded, &candidate, &mut evidence)?,
        };
        let summary = Summary {
            parameters: Named::new(problem.parameters.names(), candidate.iter().copied()),
            objectives: Named::new(problem.tune.objectives.iter().map(Objective::name), costs),
            consistency: evidence.judge(problem, &candidate),
            warnings: loaded.warnings.clone(),
        };
        if let Some(folder) = &self.figures {
            pictures::write_run(folder, (problem, log), &candidate, &summary.consistency.whiteness)?;
        }
        if self.json {
            files::print_json(&summary)?;
        } else {
            for (name, cost) in summary.objectives.iter() {
                console.note(format_args!("{name} = {cost}"));
            }
            console.note(&summary.consistency);
        }
        Ok(Ending::Done)
    }

    /// Runs the filter into the table; gives the objectives.
    fn write(
        &self,
        table: &Destination,
        Loaded { problem, log, .. }: &Loaded,
        candidate: &[f64],
        evidence: &mut Evidence,
    ) -> anyhow::Result<Vec<f64>> {
        let covariance = if self.diagonal { Covariance::Diagonal } else { Covariance::Triangle };
        let mut costs = Vec::new();
        table.write(|out| {
            let mut rows = RunTable::new(problem, log, covariance, out)?;
            let mut written = Ok(());
            costs = reference::visit(problem, log, candidate, &mut |trajectory, step| {
                evidence.add(trajectory, step);
                if written.is_ok() {
                    written = rows.row(trajectory, step);
                }
            })?;
            written?;
            Ok(rows.finish()?)
        })?;
        Ok(costs)
    }
}
