//! `kfgpu simulate`: a log drawn from the model.

use std::path::PathBuf;

use clap::Args;

use super::console::Console;
use super::files::{self, Destination};
use super::{Ending, memory, paths};
use crate::data::Summary;
use crate::model::Problem;

/// Draw truth and measurements from a problem's model, as its `[simulate]` table says, and write them as CSV.
#[derive(Debug, Args)]
pub(super) struct Simulate {
    /// Problem file (TOML) with a `[simulate]` table.
    problem: PathBuf,

    /// Seed of the draw (default: the file's `simulate.seed`); another seed is another realisation of the same truth.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// File for the log, written whole or not at all; `-` is standard output (default: standard output).
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Replace the file of --out if it exists (default: keep an earlier table under a number, and refuse any other
    /// file).
    #[arg(long)]
    force: bool,
}

impl Simulate {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        paths::ensure_not_read(self.out.as_deref(), &[Some(&self.problem)])?;
        let mut destination = Destination::prepare(self.out.as_deref())?;
        let problem = Problem::open(&self.problem)?;
        memory::ensure_log_fits(&problem)?;
        let log = crate::simulate::simulate(&problem, self.seed)?;
        console.note(Summary::of(&log));
        let header = files::first_line(|out| Ok(log.write_csv(&problem.data, out)?));
        destination.respect(&header, self.force)?;
        destination.write(console, |out| Ok(log.write_csv(&problem.data, out)?))?;
        Ok(Ending::Done)
    }
}
