//! `kfgpu bench`: filter-steps per second.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::ensure;
use clap::{Args, ValueEnum};

use super::console::Console;
use super::options::{self, PrecisionChoice};
use super::{Ending, files, load};
use crate::bench::{self, Options, Subject, Workload};

/// Measure how many filter-steps a second this machine does (one step = one candidate over one row).
#[derive(Debug, Args)]
pub(super) struct Bench {
    /// Problem file to measure (default: the standard workload that --workload names).
    #[arg(conflicts_with = "workload")]
    problem: Option<PathBuf>,

    /// Standard workload: A (3 states, 1 measurement, 200 rows), B (6 states, 3 measurements, 1,000 rows) or C (4
    /// states, 2 measurements, 100,000 rows); default A.
    #[arg(long, value_name = "LETTER", ignore_case = true)]
    workload: Option<Workload>,

    /// Candidates a run (default: 1024); more fill more lanes and threads.
    #[arg(long, value_name = "N", value_parser = options::candidates)]
    n: Option<NonZeroUsize>,

    /// Use only the first rows of each trajectory (default: all), for programs too slow for the whole log.
    #[arg(long, value_name = "ROWS")]
    t: Option<NonZeroUsize>,

    /// Number format; `auto` is f64.
    #[arg(long, value_enum, default_value_t = PrecisionChoice::Auto, value_name = "FORMAT")]
    precision: PrecisionChoice,

    /// Threads (default: 1, so that figures compare core by core).
    #[arg(long, value_name = "N", value_parser = options::threads)]
    threads: Option<NonZeroUsize>,

    /// Where to compute; this version has the CPU only.
    #[arg(long, value_enum, default_value_t = DeviceChoice::Cpu, value_name = "DEVICE")]
    device: DeviceChoice,

    /// Timed runs, of which the median counts (default: 5).
    #[arg(long, value_name = "N")]
    repetitions: Option<NonZeroUsize>,

    /// Start no further run after this long, in seconds (default: 30).
    #[arg(long, value_name = "SECONDS")]
    budget: Option<f64>,

    /// Print one JSON object on stdout (default: a short table), for programs.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DeviceChoice {
    Cpu,
}

impl Bench {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let report = bench::run(&self.options(console)?)?;
        if self.json {
            files::print_json(&report)?;
        } else {
            files::print(&report.to_string())?;
        }
        Ok(Ending::Done)
    }

    fn options(&self, console: Console) -> anyhow::Result<Options> {
        let DeviceChoice::Cpu = self.device;
        let subject = match &self.problem {
            Some(path) => {
                let loaded = load::load(Some(path), None, console)?;
                Subject::Problem(Box::new((loaded.problem, loaded.log)))
            }
            None => Subject::Workload(self.workload.unwrap_or(Workload::A)),
        };
        let mut options = Options::new(subject);
        options.candidates = self.n.map_or(options.candidates, NonZeroUsize::get);
        options.rows = self.t.map(NonZeroUsize::get);
        options.precision = self.precision.into();
        options.threads = self.threads.map_or(options.threads, NonZeroUsize::get);
        options.repetitions = self.repetitions.map_or(options.repetitions, NonZeroUsize::get);
        if let Some(budget) = self.budget {
            let valid = Duration::try_from_secs_f64(budget).ok();
            ensure!(valid.is_some(), "--budget is {budget}: expected a time in seconds, 0 or more");
            options.budget = valid.unwrap_or(options.budget);
        }
        Ok(options)
    }
}
