//! `kfgpu tape`: the traced step and what it costs; one row of it, as every machine has it.

mod find;
mod machines;
mod row;
mod sentences;

use std::path::PathBuf;

use clap::Args;

use super::console::Console;
use super::options::PrecisionChoice;
use super::{Ending, files, load};
use crate::evaluate::{CpuEvaluator, CpuOptions};

/// Print the straight-line program that every candidate runs, and its operation counts; with --row what it comes to in one
/// row of the log, on every machine.
///
/// Operations are counted as + - * / one each, a fused multiply-add two, logarithms left out. With --row two tables are
/// printed: the prior mean and covariance of the row by the reference, by the lanes of the CPU in f64 and f32 and by a GPU, and
/// every operation of the row's step; then which operation is the first where they part.
#[derive(Debug, Args)]
pub(super) struct Tape {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Log to trace for in place of the problem file's (default: the file's `data.file`); what is constant over the log
    /// is folded into the program.
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Number format the program is meant for; `auto` is f64, with --row f32, where machines part. f32 may start with another
    /// form of the covariance.
    #[arg(long, value_enum, default_value_t = PrecisionChoice::Auto, value_name = "FORMAT")]
    precision: PrecisionChoice,

    /// Row of the log whose operations are shown with their values, counted from 0 in its trajectory as in other messages
    /// (default: none, the program alone is printed).
    #[arg(long, value_name = "K")]
    row: Option<usize>,

    /// Values of searched parameters that the row is run with; one that is not named has its start (default: every start).
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', requires = "row")]
    candidate: Vec<String>,

    /// Trajectory of the row (default: the first).
    #[arg(long, value_name = "NAME", requires = "row")]
    trajectory: Option<String>,

    /// GPU whose name contains this, which may be a software renderer (default: the best real one, if there is one); `kfgpu
    /// devices` lists them.
    #[arg(long, value_name = "NAME", requires = "row")]
    adapter: Option<String>,
}

impl Tape {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let text = match self.row {
            Some(row) => self.look(row, &loaded, console)?,
            None => {
                let options = CpuOptions { precision: self.precision.into(), ..CpuOptions::default() };
                CpuEvaluator::new(&loaded.problem, &loaded.log, options)?.program().to_string()
            }
        };
        files::print(&text)?;
        Ok(Ending::Done)
    }
}
