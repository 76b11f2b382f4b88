//! `kfgpu bench`: filter-steps per second.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::ensure;
use clap::{Args, ValueEnum};

use super::console::Console;
use super::options::{self, PrecisionChoice};
use super::{Ending, files, load};
use crate::bench::{self, Adapter, Options, Subject, Suite, Target, Workload};
use crate::precision::Precision;

/// Measure how many filter-steps a second this machine does (one step = one candidate over one row).
///
/// By default the CPU (all threads and one, f64 and f32) is compared with every GPU: time in kernels by the adapter's
/// timestamps, time end to end, and from how many candidates on the GPU is faster. `--device cpu` or `gpu` measures one
/// of them alone.
#[derive(Debug, Args)]
pub(super) struct Bench {
    /// Problem file to measure (default: the standard workload that --workload names).
    #[arg(conflicts_with = "workload")]
    problem: Option<PathBuf>,

    /// Standard workload: A (3 states, 1 measurement, 200 rows), B (6 states, 3 measurements, 1,000 rows) or C (4
    /// states, 2 measurements, 100,000 rows); default A.
    #[arg(long, value_name = "LETTER", ignore_case = true)]
    workload: Option<Workload>,

    /// Candidates a run (default: 1024 for one device; in a comparison about 2^24 filter-steps, 1,024 to 65,536
    /// candidates); more fill more lanes and threads.
    #[arg(long, value_name = "N", value_parser = options::candidates)]
    n: Option<NonZeroUsize>,

    /// Use only the first rows of each trajectory (default: all), for programs too slow for the whole log.
    #[arg(long, value_name = "ROWS")]
    t: Option<NonZeroUsize>,

    /// Number format; `auto` is f64 on one CPU, f32 on one GPU, and both in a comparison.
    #[arg(long, value_enum, default_value_t = PrecisionChoice::Auto, value_name = "FORMAT")]
    precision: PrecisionChoice,

    /// Threads of the CPU (default: 1 with --device cpu, so that figures compare core by core; in a comparison one a
    /// core, and 1).
    #[arg(long, value_name = "N", value_parser = options::threads)]
    threads: Option<NonZeroUsize>,

    /// What to measure; `all` compares the CPU with every GPU.
    #[arg(long, value_enum, default_value_t = DeviceChoice::All, value_name = "DEVICE")]
    device: DeviceChoice,

    /// Measure the adapter whose name contains this (default: every GPU, or with --device gpu the best). A software
    /// adapter is measured only when it is named here, or with --software.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,

    /// Compare with software adapters too (default: hardware only). They run on the CPU and say nothing of a GPU's
    /// speed.
    #[arg(long, conflicts_with = "adapter")]
    software: bool,

    /// Arithmetic limit of the one device measured, in GFLOP/s of the number format used, to print the share of it that
    /// is reached (default: not printed).
    #[arg(long, value_name = "GFLOPS")]
    peak_gflops: Option<f64>,

    /// Timed runs, of which the median counts (default: 5).
    #[arg(long, value_name = "N")]
    repetitions: Option<NonZeroUsize>,

    /// Start no further run of a device after this long, in seconds (default: 30).
    #[arg(long, value_name = "SECONDS")]
    budget: Option<f64>,

    /// Print one JSON object on stdout (default: a short table), for programs.
    #[arg(long)]
    json: bool,
}

#[cfg(feature = "gpu")]
use super::stderr::without_desktop as drivers;

/// Without GPUs no driver is loaded.
#[cfg(not(feature = "gpu"))]
fn drivers<T>(work: impl FnOnce() -> T) -> T {
    work()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DeviceChoice {
    Cpu,
    Gpu,
    All,
}

impl Bench {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        self.refuse_contradictions()?;
        let options = self.options(console)?;
        if self.device == DeviceChoice::All {
            let suite = self.suite(console)?;
            let found = drivers(|| bench::compare(&options, &suite))?;
            self.print(&found)
        } else {
            self.print(&drivers(|| bench::run(&options))?)
        }
    }

    fn print(&self, found: &(impl serde::Serialize + std::fmt::Display)) -> anyhow::Result<Ending> {
        if self.json {
            files::print_json(found)?;
        } else {
            files::print(&found.to_string())?;
        }
        Ok(Ending::Done)
    }

    fn refuse_contradictions(&self) -> anyhow::Result<()> {
        let Self { device, adapter, peak_gflops, .. } = self;
        ensure!(
            *device != DeviceChoice::Cpu || adapter.is_none(),
            "--adapter names a GPU, and --device is cpu: leave one of them out"
        );
        ensure!(
            *device == DeviceChoice::All || !self.software,
            "--software adds software adapters to a comparison: use --device all, or name one with --adapter"
        );
        ensure!(
            *device != DeviceChoice::Gpu || self.threads.is_none(),
            "--threads is for the CPU, and --device is gpu: leave one of them out"
        );
        if let Some(peak) = peak_gflops {
            ensure!(*peak > 0.0 && peak.is_finite(), "--peak-gflops is {peak}: expected a positive number");
            ensure!(
                *device != DeviceChoice::All,
                "--peak-gflops is the limit of one device: say which with --device cpu or --device gpu"
            );
        }
        Ok(())
    }

    fn options(&self, console: Console) -> anyhow::Result<Options> {
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
        options.repetitions = self.repetitions.map_or(options.repetitions, NonZeroUsize::get);
        options.peak_gflops = self.peak_gflops;
        if self.device == DeviceChoice::Gpu {
            options.target = Target::Gpu { adapter: self.adapter.clone() };
            if self.precision == PrecisionChoice::Auto {
                options.precision = Precision::F32;
            }
        } else if let Some(threads) = self.threads {
            options.target = Target::Cpu { threads: threads.get() };
        }
        if let Some(budget) = self.budget {
            let valid = Duration::try_from_secs_f64(budget).ok();
            ensure!(valid.is_some(), "--budget is {budget}: expected a time in seconds, 0 or more");
            options.budget = valid.unwrap_or(options.budget);
        }
        Ok(options)
    }

    /// What a comparison measures.
    fn suite(&self, console: Console) -> anyhow::Result<Suite> {
        let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = match self.threads {
            Some(threads) => vec![threads.get()],
            None if cores == 1 => vec![1],
            None => vec![cores, 1],
        };
        let precisions = match self.precision {
            PrecisionChoice::Auto => vec![Precision::F64, Precision::F32],
            one => vec![one.into()],
        };
        let candidates = self.n.map(NonZeroUsize::get);
        Ok(Suite { threads, adapters: self.adapters(console)?, precisions, candidates })
    }

    fn adapters(&self, console: Console) -> anyhow::Result<Vec<Adapter>> {
        let found = drivers(bench::adapters);
        if let Some(wanted) = &self.adapter {
            let lower = wanted.to_lowercase();
            let known: Vec<String> = found.iter().map(|a| format!("`{}`", a.name)).collect();
            let named: Vec<Adapter> = found.into_iter().filter(|a| a.name.to_lowercase().contains(&lower)).collect();
            let known = if known.is_empty() { "none: there is no adapter".to_owned() } else { known.join(", ") };
            ensure!(!named.is_empty(), "no adapter is called `{wanted}`: expected part of one of {known}");
            return Ok(named);
        }
        let (software, mut chosen): (Vec<Adapter>, Vec<Adapter>) = found.into_iter().partition(|a| a.software);
        if chosen.is_empty() && !self.software {
            console.note("no GPU adapter: the CPU alone is measured");
        }
        for adapter in software {
            if self.software {
                chosen.push(adapter);
            } else {
                console.note(format_args!("software adapter `{}` is left out (--software measures it)", adapter.name));
            }
        }
        Ok(chosen)
    }
}
