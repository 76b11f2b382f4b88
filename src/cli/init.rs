//! `kfgpu init`: a first problem file for a log.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::ensure;
use clap::Args;

use super::console::Console;
use super::{Ending, files};
use crate::model;

/// Write a commented problem file for a log, with bounds and starts drawn from its data.
#[derive(Debug, Args)]
pub(super) struct Init {
    /// Log (CSV with a header).
    log: PathBuf,

    /// File to write, whole or not at all; `-` is standard output (default: standard output).
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Replace the file if it exists (default: refuse, so that no edited problem file is lost).
    #[arg(long)]
    force: bool,
}

impl Init {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let file = self.out.as_deref().filter(|out| *out != Path::new("-"));
        let Some(out) = file else {
            files::print(&model::draft(&self.log, Path::new(""))?)?;
            return Ok(Ending::Done);
        };
        ensure!(self.force || !out.exists(), "{} exists (give --force to replace it)", out.display());
        let folder = out.parent().unwrap_or_else(|| Path::new(""));
        let text = model::draft(&self.log, folder)?;
        files::write_whole(out, |file| Ok(file.write_all(text.as_bytes())?))?;
        console.note(format_args!("wrote {0}: look it over, then run `kfgpu tune {0}`", out.display()));
        Ok(Ending::Done)
    }
}
