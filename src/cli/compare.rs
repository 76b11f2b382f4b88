//! `kfgpu compare`: runs side by side.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;

use super::Ending;
use super::console::Console;
use super::{files, run_files};
use crate::report::{Comparison, Run};

/// Put the results of runs side by side: parameters, objectives, consistency and cost of the search.
///
/// A run is a folder that `tune --out` wrote, or one of the files there. Where runs did not score the same rows in the same way
/// (another log, other objectives, another split) it says so, and names no best one.
#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Run folders, or files in them, at least two; the others are compared with the first.
    #[arg(required = true, num_args = 2.., value_name = "RUN")]
    runs: Vec<PathBuf>,

    /// Print the comparison as one JSON object on stdout (default: a table), for programs.
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub(super) fn run(&self, _console: Console) -> anyhow::Result<Ending> {
        let runs = self.runs.iter().map(|path| open(path)).collect::<anyhow::Result<Vec<Run>>>()?;
        let comparison = Comparison::of(runs)?;
        if self.json {
            files::print_json(&comparison)?;
        } else {
            files::print(&comparison.to_string())?;
        }
        Ok(Ending::Done)
    }
}

fn open(path: &Path) -> anyhow::Result<Run> {
    let shown = path.display();
    let file = run_files::file_in(path, run_files::RESULT)?;
    if !file.is_file() {
        bail!("{shown}: no such run (name a folder that `tune --out` wrote, or its {})", run_files::RESULT);
    }
    let bytes = fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
    let text = String::from_utf8(bytes)
        .ok()
        .with_context(|| format!("{}: is not text (name a folder that `tune --out` wrote)", file.display()))?;
    Ok(Run::read(&text, &shown.to_string(), &file.display().to_string())?)
}
