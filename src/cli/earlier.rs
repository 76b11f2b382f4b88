//! What stands in the folder of `tune --out` before the run: an earlier run of the same study is kept beside it, and
//! whatever else would be overwritten is refused.

use std::fs;
use std::path::Path;

use anyhow::bail;
use serde::Deserialize;

use super::console::Console;
use super::folder::OutFolder;
use super::load::Origin;
use super::{paths, pictures, run_files};
use crate::model::Problem;
use crate::study::Checkpoint;

/// Files that a run is about to write anew.
#[derive(Debug, Default)]
pub(super) struct Earlier {
    files: Vec<String>,
}

/// Who wrote the files of a folder.
#[derive(Debug, Deserialize)]
struct Owner {
    problem: String,
    log: Source,
}

#[derive(Debug, Deserialize)]
struct Source {
    source: String,
}

impl Earlier {
    /// Looks at a folder for a run of `problem` on the log of `origin`.
    ///
    /// # Errors
    /// If it holds the run of another problem on another log, or files of the same names that are no run's.
    pub(super) fn of(folder: &OutFolder, problem: &Problem, origin: &Origin) -> anyhow::Result<Self> {
        // The problem itself may be the tuned.toml of the folder: it is the user's own, and only copied.
        let is_problem = |name: &str| paths::are_one(&folder.path().join(name), Path::new(&problem.source));
        let data = if let Origin::BuiltIn(name, _) = origin { Some(*name) } else { None };
        let names = run_files::names().map(str::to_owned).chain(pictures::names()).chain(data.map(str::to_owned));
        let files: Vec<String> = names.filter(|name| folder.holds(name)).collect();
        let Some(first) = files.iter().find(|name| !is_problem(name)) else { return Ok(Self::default()) };
        let (folder_name, advice) =
            (folder.path().display(), "choose another folder, or give --force to replace what is there");
        match Owner::of(folder) {
            None => bail!("{folder_name} holds {first}, which is of no run of kfgpu ({advice})"),
            Some(owner) if owner.is_same(problem, origin) => Ok(Self { files }),
            Some(owner) => {
                bail!("{folder_name} holds a run of {}, not of {} ({advice})", owner.problem, problem.source)
            }
        }
    }

    /// Makes way for the run: what is there moves to a numbered folder beside this one.
    pub(super) fn make_way(&self, folder: &OutFolder, problem: &Problem, console: Console) -> anyhow::Result<()> {
        if self.files.is_empty() {
            return Ok(());
        }
        let kept = folder.move_aside(&self.files, Path::new(&problem.source))?;
        pictures::remove_folder(folder);
        console.note(format_args!("kept the earlier run of {} in {}", folder.path().display(), kept.display()));
        Ok(())
    }
}

impl Owner {
    /// By the result, or by the checkpoint of a run that has none yet.
    fn of(folder: &OutFolder) -> Option<Self> {
        let result = fs::read(folder.path().join(run_files::RESULT)).ok();
        result.and_then(|bytes| serde_json::from_slice(&bytes).ok()).or_else(|| {
            let source = Checkpoint::open(&folder.path().join(run_files::CHECKPOINT)).ok()?.source;
            Some(Self { problem: source.problem, log: Source { source: source.log.unwrap_or_default() } })
        })
    }

    /// Whether it is the same problem file, or another for the same log: runs that one compares.
    fn is_same(&self, problem: &Problem, origin: &Origin) -> bool {
        let same = |a: &str, b: &Path| Path::new(a) == b || paths::are_one(Path::new(a), b);
        let log = || origin.file().is_some_and(|log| same(&self.log.source, log));
        same(&self.problem, Path::new(&problem.source)) || log()
    }
}
