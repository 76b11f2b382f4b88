//! `kfgpu tape`: the traced step and what it costs.

use std::path::PathBuf;

use clap::Args;

use super::console::Console;
use super::options::PrecisionChoice;
use super::{Ending, files, load};
use crate::evaluate::{CpuEvaluator, CpuOptions};

/// Print the straight-line program that every candidate runs, and its operation counts.
///
/// Operations are counted as + - * / one each, a fused multiply-add two, logarithms left out.
#[derive(Debug, Args)]
pub(super) struct Tape {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Log to trace for in place of the problem file's (default: the file's `data.file`); what is constant over the log
    /// is folded into the program.
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Number format the program is meant for; `auto` is f64. f32 may start with another form of the covariance.
    #[arg(long, value_enum, default_value_t = PrecisionChoice::Auto, value_name = "FORMAT")]
    precision: PrecisionChoice,
}

impl Tape {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let options = CpuOptions { precision: self.precision.into(), ..CpuOptions::default() };
        let evaluator = CpuEvaluator::new(&loaded.problem, &loaded.log, options)?;
        files::print(&evaluator.program().to_string())?;
        Ok(Ending::Done)
    }
}
