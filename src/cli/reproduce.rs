//! `kfgpu reproduce`: published studies run again.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::Ending;
use super::console::Console;
use super::folder::OutFolder;
use super::{files, options};
use crate::reproduce::{self, Options, Progress, PublishedStudy, Reproduction, STUDIES, Target};

/// Run a published study again: its table beside ours, and targets that pass or fail (exit code 1 if one fails).
///
/// Studies: kf-pio (pigeon-inspired optimisation against particle swarms, one objective), moma (a multi-objective
/// memetic algorithm against adaptive filters), or all of them. docs/reproductions.md shows both as they were run.
#[derive(Debug, Args)]
pub(super) struct Reproduce {
    /// Study, or `all`.
    name: String,

    /// Fewer repetitions, and wider tolerances where the smaller sample needs them (default: the full study); the
    /// result says what was left out.
    #[arg(long)]
    quick: bool,

    /// Seed of the drawn data and of every search; the same seed gives the same numbers on any number of threads.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Threads that data sets are spread over (default: one per core). No result depends on it.
    #[arg(long, value_name = "N", value_parser = options::threads)]
    threads: Option<NonZeroUsize>,

    /// Folder for report.md, its figures (SVG), the tables and every number behind them (CSV) and result.json
    /// (default: none is written); with `all`, one folder a study in it.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace the files of an earlier reproduction, or of anything else, in the folder of --out (default: refuse).
    #[arg(long)]
    force: bool,

    /// Print the result as one JSON object on stdout (default: tables), for programs.
    #[arg(long)]
    json: bool,
}

const REPORT: &str = "report.md";
const RESULT: &str = "result.json";

/// Several studies as one JSON object.
#[derive(Debug, Serialize)]
struct All<'a> {
    name: &'static str,
    pass: bool,
    targets: Vec<Target>,
    quick: bool,
    wall_s: f64,
    studies: &'a [Reproduction],
}

impl Reproduce {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let studies: Vec<&PublishedStudy> =
            if self.name == "all" { STUDIES.iter().collect() } else { vec![reproduce::published(&self.name)?] };
        let folders = self.folders(&studies)?;
        let options = Options { seed: self.seed, quick: self.quick, threads: self.threads };
        let mut results = Vec::with_capacity(studies.len());
        for (study, folder) in studies.iter().zip(&folders) {
            let result = study.run(&options, &Bar::new(console, study.name)?)?;
            if let Some(folder) = folder {
                write(folder, &result)?;
            }
            if !self.json {
                files::print(&result.to_string())?;
            }
            results.push(result);
        }
        match results.as_slice() {
            _ if !self.json => {}
            [one] if self.name != "all" => files::print_json(one)?,
            several => files::print_json(&all(several, self.quick))?,
        }
        Ok(ending(&results))
    }

    /// A folder a study, tried before any work starts.
    fn folders(&self, studies: &[&PublishedStudy]) -> anyhow::Result<Vec<Option<OutFolder>>> {
        let folder_of = |study: &&PublishedStudy| {
            let path = |out: &PathBuf| if self.name == "all" { out.join(study.name) } else { out.clone() };
            let prepare = |out: &PathBuf| {
                let folder = OutFolder::prepare(&path(out))?;
                if !self.force {
                    folder.refuse_existing([REPORT, RESULT], "what is there")?;
                }
                Ok(folder)
            };
            self.out.as_ref().map(prepare).transpose()
        };
        studies.iter().map(folder_of).collect()
    }
}

/// A missed target ends the command with 1.
fn ending(results: &[Reproduction]) -> Ending {
    if results.iter().all(Reproduction::passes) { Ending::Done } else { Ending::NotUsable }
}

fn all(studies: &[Reproduction], quick: bool) -> All<'_> {
    let named = |study: &Reproduction| {
        let name = study.name;
        study
            .targets
            .clone()
            .into_iter()
            .map(move |target| Target { name: format!("{name}: {}", target.name), ..target })
    };
    All {
        name: "all",
        pass: studies.iter().all(Reproduction::passes),
        targets: studies.iter().flat_map(named).collect(),
        quick,
        wall_s: studies.iter().map(|study| study.wall_s).sum(),
        studies,
    }
}

fn write(folder: &OutFolder, result: &Reproduction) -> anyhow::Result<()> {
    let figures: Vec<String> = result.figures.iter().map(|figure| format!("{}.svg", figure.name)).collect();
    for (figure, name) in result.figures.iter().zip(&figures) {
        folder.write(name, |out| Ok(out.write_all(figure.svg.as_bytes())?))?;
    }
    let targets = result.target_table();
    for table in [&targets, &result.table].into_iter().chain(&result.tables).chain(&result.data) {
        folder.write(&format!("{}.csv", table.name), |out| Ok(table.write_csv(out)?))?;
    }
    folder.write(REPORT, |out| Ok(out.write_all(result.markdown(&figures).as_bytes())?))?;
    folder.write(RESULT, |out| {
        serde_json::to_writer(&mut *out, result)?;
        Ok(out.write_all(b"\n")?)
    })
}

/// A bar over data sets, or nothing where nobody watches.
#[derive(Debug)]
struct Bar {
    bar: ProgressBar,
    shown: bool,
}

impl Bar {
    fn new(console: Console, study: &'static str) -> anyhow::Result<Self> {
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::hidden());
        let template = "{prefix} {bar:16} {pos}/{len} data sets, {elapsed} so far, {eta} left";
        bar.set_style(ProgressStyle::with_template(template)?);
        bar.set_prefix(study);
        Ok(Self { bar, shown: console.shows_progress() })
    }
}

impl Progress for Bar {
    fn begin(&self, steps: usize) {
        self.bar.set_length(steps as u64);
        // Not before: an empty bar of no length is drawn as a full one.
        if self.shown {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.bar.tick();
        }
    }

    fn advance(&self) {
        self.bar.inc(1);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::{Backend, Device, Precision};
    use crate::reproduce::{Cell, Figure, Required, Table};

    fn result(name: &'static str, measured: f64) -> Reproduction {
        let table = |name| Table {
            name,
            title: "Summary".into(),
            columns: vec!["J".into()],
            rows: vec![vec![Cell::Number(measured, 3)]],
        };
        Reproduction {
            name,
            summary: "A study of nothing.".into(),
            paper: "Nobody, 2000",
            reduced: None,
            seed: 1,
            targets: vec![Target::new("J", Required::AtMost(2.0), measured)],
            table: table("summary"),
            tables: vec![table("more")],
            findings: Vec::new(),
            readings: Vec::new(),
            data: vec![table("runs")],
            figures: vec![Figure { name: "rain".into(), caption: "Rain".into(), svg: "<svg/>".into() }],
            device: Device { backend: Backend::Mock, adapter: "none".into(), precision: Precision::F64 },
            wall_s: 1.5,
        }
    }

    #[test]
    fn one_missed_target_of_any_study_is_not_usable() {
        assert_eq!(ending(&[result("a", 1.0), result("b", 2.0)]), Ending::Done);
        let results = [result("a", 1.0), result("b", 2.5)];
        assert_eq!(ending(&results), Ending::NotUsable);
        let json = serde_json::to_value(all(&results, false)).unwrap();
        assert_eq!((&json["name"], &json["pass"], &json["wall_s"]), (&"all".into(), &false.into(), &3.0.into()));
        assert_eq!(json["targets"][1]["name"], "b: J");
        assert_eq!(json["studies"][0]["targets"][0]["pass"], true);
    }

    #[test]
    fn a_folder_holds_report_tables_and_figures() {
        let folder = tempfile::tempdir().unwrap();
        write(&OutFolder::prepare(folder.path()).unwrap(), &result("a", 1.0)).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!((read("runs.csv").as_str(), read("rain.svg").as_str()), ("J\n1\n", "<svg/>"));
        assert!(read("report.md").contains("![rain](rain.svg)"), "{}", read("report.md"));
        assert!(
            read("targets.csv").starts_with("target,required,measured,pass\nJ,<= 2,1,yes"),
            "{}",
            read("targets.csv")
        );
        assert!(read("result.json").contains("\"more\":[{\"J\":1.0}]"), "{}", read("result.json"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 7, "and nothing else");
    }
}
