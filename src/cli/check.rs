//! `kfgpu check`: whether a filter still fits its log, as an exit code.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::console::Console;
use super::{Ending, files, load};
use crate::reference;
use crate::report::{Consistency, Evidence, Named, TextTable, Whiteness, short};

/// Check that a filter is consistent with a log: exit 0 if every target is met, 1 if not, for CI.
///
/// Targets: the mean NIS is within its 95 % chi-square band, and the innovations of every measurement are white (no
/// autocorrelation of 0.1 or more, or none that a Ljung-Box test at 1 % finds significant). Of right filters about 7 in
/// 100 fail. A log with too few measurements to tell fails, because it proves nothing. The parameters are taken as given;
/// nothing is searched.
#[derive(Debug, Args)]
pub(super) struct Check {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Another problem file whose start values are used, such as the tuned.toml that `tune --out` writes (default: the
    /// start values of PROBLEM).
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,

    /// Log to check on in place of the problem file's; `-` reads it from standard input (default: the file's
    /// `data.file`), such as the newest recording.
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

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
    pass: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    pass: bool,
    targets: Vec<Target>,
    parameters: Named<f64>,
    consistency: Consistency,
    warnings: Vec<String>,
}

impl Check {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let (problem, log) = (&loaded.problem, &loaded.log);
        let candidate = load::candidate(problem, self.parameters.as_deref())?;
        let mut evidence = Evidence::new(problem, log);
        reference::visit(problem, log, &candidate, &mut |trajectory, step| evidence.add(trajectory, step))?;
        let consistency = evidence.judge(problem, &candidate);
        let targets = targets(&consistency, &log.measurements);
        let report = Report {
            pass: targets.iter().all(|target| target.pass),
            targets,
            parameters: Named::new(problem.parameters.names(), candidate),
            consistency,
            warnings: loaded.warnings,
        };
        if self.json {
            files::print_json(&report)?;
        } else {
            files::print(&report.to_string())?;
        }
        Ok(if report.pass { Ending::Done } else { Ending::NotUsable })
    }
}

/// NIS, then the whiteness of each measurement.
fn targets(consistency: &Consistency, measurements: &[String]) -> Vec<Target> {
    let Consistency { nis_mean, nis_low, nis_high, .. } = *consistency;
    let nis = Target {
        name: "mean NIS".to_owned(),
        required: format!("{nis_low:.3}..{nis_high:.3}"),
        measured: nis_mean,
        pass: (nis_low..=nis_high).contains(&nis_mean),
    };
    let significance = Whiteness::SIGNIFICANCE / measurements.len() as f64;
    let white = measurements.iter().map(|name| {
        let tested = consistency.whiteness.iter().find(|w| w.measurement == *name && w.is_tested());
        Target {
            name: format!("largest autocorrelation of {name}"),
            required: tested.map_or_else(
                || "enough innovations to tell".to_owned(),
                |w| format!("below 0.1, or Ljung-Box p of at least {} (is {:.1e})", short(significance, 2), w.p_value),
            ),
            measured: tested.map_or(f64::NAN, |w| w.autocorrelation.iter().fold(0.0, |max: f64, r| max.max(r.abs()))),
            pass: tested.is_some_and(|w| !w.correlated),
        }
    });
    std::iter::once(nis).chain(white).collect()
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut table = TextTable::new(["target", "measured", "required", "result"]);
        for Target { name, required, measured, pass } in &self.targets {
            let result = if *pass { "pass" } else { "FAIL" };
            let measured = if measured.is_nan() { "-".to_owned() } else { short(*measured, 4) };
            table.push([name.clone(), measured, required.clone(), result.to_owned()]);
        }
        writeln!(f, "{table}\n{}", self.consistency)?;
        writeln!(f, "check {}", if self.pass { "passed" } else { "failed" })
    }
}
