//! `kfgpu check`: whether a filter still fits its log, as an exit code.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Args;
use serde::Serialize;

use super::console::Console;
use super::{Ending, files, load};
use crate::data::Log;
use crate::model::Problem;
use crate::reference;
use crate::report::{Bound, Consistency, Evidence, FilterScore, Linearity, LinearityVerdict, Named, Test, short};
use crate::table::Table;

/// Check that a filter is consistent with a log: exit 0 if every target is met, 1 if not, for CI.
///
/// Targets are the tests of the verdict that `tune` prints: the mean NIS is 1, in the first 20 measured rows of each
/// trajectory and in all; it is the same at all times; no single row carries it; its tails and its distribution are those
/// of chi-square; and the innovations of every measurement are white. No searched parameter is at its bound. Of right
/// filters at most 4 in 100 fail. A log with too few measurements to tell fails, because it proves nothing. The parameters
/// are taken as given; nothing is searched.
#[derive(Debug, Args)]
pub(super) struct Check {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Another problem file whose start values are used, such as the tuned.toml that `tune --out` writes, or that folder
    /// (default: the start values of PROBLEM).
    #[arg(long, value_name = "FILE|DIR")]
    parameters: Option<PathBuf>,

    /// Log to check on in place of the problem file's; `-` reads it from standard input (default: the file's
    /// `data.file`), such as the newest recording.
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Other filters to run on the same log with the same parameters, separated by commas: `extended`, `iterated`, `unscented`,
    /// `cubature`, and `kalman` where f and h are affine (default: none). A table of their scores and a sentence say whether
    /// linearising costs on this log; the exit code does not depend on them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    filters: Vec<String>,

    /// Print targets and consistency as one JSON object on stdout (default: a table and the verdict), for programs.
    #[arg(long)]
    json: bool,
}

/// One thing that has to hold.
#[derive(Debug, Serialize)]
struct Target {
    name: String,
    required: String,
    /// NaN where there is too little to measure it on.
    measured: f64,
    /// NaN where it is no test.
    p_value: f64,
    pass: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    pass: bool,
    targets: Vec<Target>,
    parameters: Named<f64>,
    consistency: Consistency,
    /// Filters beside the problem's own, where they were asked for, and what they say together.
    #[serde(skip_serializing_if = "Option::is_none")]
    linearity: Option<Vec<FilterScore>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<LinearityVerdict>,
    warnings: Vec<String>,
}

impl Check {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let (problem, log) = (&loaded.problem, &loaded.log);
        let candidate = load::candidate(problem, self.parameters.as_deref())?;
        let linearity = self.linearity(problem, log, &candidate)?;
        if let Some(linearity) = linearity.as_ref().filter(|_| !self.json) {
            files::print(&format!("{linearity}\n"))?;
        }
        let mut evidence = Evidence::new(problem, log);
        reference::visit(problem, log, &candidate, &mut |trajectory, step| evidence.add(trajectory, step))?;
        let consistency = evidence.judge(problem, &candidate);
        let targets = targets(problem, &consistency, &candidate);
        let (linearity, verdict) = linearity.map(|found| (found.filters, found.verdict)).unzip();
        let report = Report {
            pass: targets.iter().all(|target| target.pass),
            targets,
            parameters: Named::new(problem.parameters.names(), candidate),
            consistency,
            linearity,
            verdict,
            warnings: loaded.warnings,
        };
        if self.json {
            files::print_json(&report)?;
        } else {
            files::print(&report.to_string())?;
        }
        Ok(if report.pass { Ending::Done } else { Ending::NotUsable })
    }

    /// The problem by the filters asked for; `None` without any.
    fn linearity(&self, problem: &Problem, log: &Log, candidate: &[f64]) -> anyhow::Result<Option<Linearity>> {
        let named = |name: &String| problem.with_filter(name.trim()).map_err(|error| anyhow!("--filters: {error}"));
        let others = self.filters.iter().map(named).collect::<anyhow::Result<Vec<Problem>>>()?;
        Ok((!others.is_empty()).then(|| Linearity::of(problem, &others, log, candidate, true)))
    }
}

/// Every test of the verdict, a measurement that has too little for one, and the bounds of what is searched.
fn targets(problem: &Problem, consistency: &Consistency, candidate: &[f64]) -> Vec<Target> {
    let test = |test: &Test| Target {
        name: test.name.clone(),
        required: test.required.clone(),
        measured: test.measured,
        p_value: test.p_value,
        pass: test.pass,
    };
    let is_tested = |name: &String| consistency.whiteness.iter().any(|w| w.measurement == *name && w.is_tested());
    let untested = problem.model.measurements.iter().filter(|name| !is_tested(name)).map(|name| Target {
        name: format!("largest autocorrelation of {name}"),
        required: "enough innovations to tell".to_owned(),
        measured: f64::NAN,
        p_value: f64::NAN,
        pass: false,
    });
    let at_bound = problem
        .parameters
        .searched()
        .zip(candidate)
        .filter(|((_, search), value)| Bound::of(search, **value).is_some());
    let at_bound = at_bound.count();
    let bounds = Target {
        name: "searched parameters at a bound".to_owned(),
        required: "0".to_owned(),
        measured: at_bound as f64,
        p_value: f64::NAN,
        pass: at_bound == 0,
    };
    consistency.tests.iter().map(test).chain(untested).chain([bounds]).collect()
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut table = Table::of(["target", "measured", "required", "result"]);
        for Target { name, required, measured, pass, .. } in &self.targets {
            let result = if *pass { "pass" } else { "FAIL" };
            let measured = if measured.is_nan() { "-".to_owned() } else { short(*measured, 4) };
            table.push([name.clone(), measured, required.clone(), result.to_owned()]);
        }
        writeln!(f, "{table}\n{}", self.consistency)?;
        writeln!(f, "check {}", if self.pass { "passed" } else { "failed" })
    }
}
