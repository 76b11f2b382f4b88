//! `kfgpu init`: a first problem file for a log.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use clap::Args;

use super::console::Console;
use super::{Ending, files, paths};
use crate::model;

/// Write a commented problem file for a log, with bounds and starts drawn from its data.
///
/// Columns are told by their names and content. What is not as usual is said on stderr and written into the file: a unit
/// of time (epochs in ms, us, ns; dates that count days or months), decimal commas, lines before the header, rows of
/// units and of sums, columns named like inputs, latitude and longitude, placeholders such as -9999, frozen values,
/// jumps. A time column that cannot be read is an error; one that does not increase is left out with a warning.
#[derive(Debug, Args)]
pub(super) struct Init {
    /// Log (CSV with a header); `-` reads standard input.
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
        let Some(out) = self.out.as_deref().filter(|out| *out != Path::new("-")) else {
            files::print(&self.draft(&self.log, console)?)?;
            return Ok(Ending::Done);
        };
        paths::ensure_not_read(Some(out), &[Some(&self.log)])?;
        ensure!(self.force || !out.exists(), "{} exists (give --force to replace it)", out.display());
        let text = self.draft(&paths::seen_from(files::folder_of(out), &self.log), console)?;
        files::write_whole(out, |file| Ok(file.write_all(text.as_bytes())?))?;
        console.note(format_args!("wrote {0}: look it over, then run `kfgpu tune {0}`", out.display()));
        Ok(Ending::Done)
    }

    /// The text, in which the log is called `name`.
    fn draft(&self, name: &Path, console: Console) -> anyhow::Result<String> {
        let draft = if self.log == Path::new("-") {
            model::draft(&self.log, io::stdin().lock())?
        } else {
            let file = File::open(&self.log).with_context(|| format!("cannot read {}", self.log.display()))?;
            model::draft(name, file)?
        };
        draft.warnings.iter().for_each(|warning| console.warn(warning));
        Ok(draft.text)
    }
}
