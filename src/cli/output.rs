//! Where `tune` leaves its results and its checkpoint, decided and locked before the search starts.

use std::path::{Path, PathBuf};

use anyhow::ensure;

use super::checkpoint::{self, Resumed};
use super::console::Console;
use super::earlier::Earlier;
use super::files::{folder_of, is_stream};
use super::folder::OutFolder;
use super::load::Origin;
use super::lock::Lock;
use super::{paths, run_files};
use crate::data::Log;
use crate::model::Problem;
use crate::study::CheckpointFile;

/// What the user says of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) out: Option<&'a Path>,
    pub(super) checkpoint: Option<&'a Path>,
    pub(super) force: bool,
}

#[derive(Debug)]
pub(super) struct Output {
    folder: Option<OutFolder>,
    earlier: Earlier,
    file: Option<CheckpointFile>,
    /// On the checkpoint, where it is not that of the folder.
    _lock: Option<Lock>,
}

impl Output {
    /// For a search of `problem` on `log`.
    ///
    /// # Errors
    /// If it cannot be written to, another run writes to it, or what is there may not be replaced.
    pub(super) fn prepare(
        asked: Asked<'_>,
        resumed: Option<&Resumed>,
        problem: &Problem,
        log: &Log,
        origin: &Origin,
    ) -> anyhow::Result<Self> {
        let folder = asked.out.or_else(|| resumed?.folder()).map(OutFolder::prepare).transpose()?;
        let own = folder.as_ref().map(|folder| folder.path().join(run_files::CHECKPOINT));
        let path = asked.checkpoint.map(Path::to_path_buf).or_else(|| own.clone());
        let path = path.or_else(|| Some(resumed?.file().to_path_buf()));
        let read = [Some(Path::new(&problem.source)), origin.file()];
        paths::ensure_not_read(asked.checkpoint, &read)?;
        if let (Some(folder), Some(own)) = (&folder, &own)
            && !own.exists()
        {
            // Of an earlier run it would be kept.
            paths::ensure_not_read(Some(&folder.path().join(run_files::TUNED)), &read)?;
        }
        let goes_on = |path: &Path| resumed.is_some_and(|resumed| paths::are_one(path, resumed.file()));
        let is_own = |path: &Path| own.as_deref().is_some_and(|own| path == own || paths::are_one(path, own));
        let mut earlier = Earlier::default();
        if let (Some(folder), Some(own)) = (&folder, &own)
            && !asked.force
            && !goes_on(own)
        {
            earlier = Earlier::of(folder, problem, origin)?;
        }
        let mut lock = None;
        if let Some(path) = path.as_deref().filter(|path| !is_own(path)) {
            // A folder that is not there is told below.
            lock = if folder_of(path).is_dir() { Lock::of_file(path)? } else { None };
            ensure!(
                asked.force || goes_on(path) || !path.exists() || path.is_dir() || is_stream(path),
                "{0} exists (go on with its search by --resume {0}, or give --force to replace it)",
                path.display()
            );
        }
        let file = path.map(|path: PathBuf| checkpoint::file(&path, problem, log, origin)).transpose()?;
        Ok(Self { folder, earlier, file, _lock: lock })
    }

    /// The folder of results.
    pub(super) const fn folder(&self) -> Option<&OutFolder> {
        self.folder.as_ref()
    }

    /// The search starts: what an earlier run left makes way; the checkpoint to write.
    pub(super) fn begin(&mut self, problem: &Problem, console: Console) -> anyhow::Result<Option<CheckpointFile>> {
        if let Some(folder) = &self.folder {
            self.earlier.make_way(folder, problem, console)?;
        }
        Ok(self.file.take())
    }
}
