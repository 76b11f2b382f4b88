//! `tune --checkpoint` and `tune --resume`.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use super::console::Console;
use super::evaluator::{self, Notices};
use super::files;
use super::load::{self, Loaded, Origin};
use super::options::{Compute, DeviceChoice, PrecisionChoice};
use super::paths;
use super::run_files::{self, CHECKPOINT};
use crate::data::Log;
use crate::evaluate::{Backend, Device, Precision};
use crate::model::Problem;
use crate::study::{Checkpoint, CheckpointFile, Generation, Identity, Observer, Scored, Snapshot, Source};

/// A search to go on with.
#[derive(Debug)]
pub(super) struct Resumed {
    checkpoint: Checkpoint,
    file: PathBuf,
    /// The folder of results, where that was named.
    folder: Option<PathBuf>,
}

impl Resumed {
    /// From a checkpoint, the folder of results that it is in, or another file there.
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        let folder = path.is_dir().then(|| path.to_path_buf());
        let file = match &folder {
            Some(folder) => folder.join(CHECKPOINT),
            None if run_files::is_of_run(path) => path.with_file_name(CHECKPOINT),
            None => path.to_path_buf(),
        };
        let checkpoint = Checkpoint::open(&file).with_context(|| cannot(&file))?;
        Ok(Self { checkpoint, file, folder })
    }

    /// The checkpoint itself, to be written on.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }

    /// The folder of results, where that was named.
    pub(super) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The search as it stood.
    pub(super) const fn snapshot(&self) -> &Snapshot {
        &self.checkpoint.snapshot
    }

    /// The problem of the checkpoint, with its flags.
    pub(super) fn problem(&self) -> anyhow::Result<Problem> {
        let Source { problem, text, .. } = &self.checkpoint.source;
        Problem::parse(text, problem).with_context(|| cannot(&self.file))
    }

    /// The log that the checkpoint names, or `data`, for its problem.
    pub(super) fn log(&self, problem: Problem, data: Option<&str>, console: Console) -> anyhow::Result<Loaded> {
        let source = &self.checkpoint.source;
        let found = if data.is_none() { self.log_file()? } else { None };
        let data = data.or(found.as_deref());
        let is_built_in = data.is_none() && problem.data.file.as_deref().is_some_and(|file| file != "-");
        let path = (!is_built_in).then(|| Path::new(&source.problem));
        load::log_of(problem, path, data, console)
    }

    /// The file of the log, if it was one: where it lies as seen from the checkpoint, so that a project may be renamed or
    /// copied; else where it was, so that the folder of results may move alone; else beside the checkpoint. It is called
    /// as the user called it where that is still the same file.
    fn log_file(&self) -> anyhow::Result<Option<String>> {
        let Source { log, log_absolute, log_from_here, .. } = &self.checkpoint.source;
        let Some(named) = log.as_deref().map(Path::new) else { return Ok(None) };
        let folder = files::folder_of(&self.file);
        let from_here = log_from_here.as_ref().map(|file| folder.join(file));
        let beside = named.file_name().map(|name| folder.join(name));
        let places = [from_here, log_absolute.as_ref().map(PathBuf::from), beside];
        let Some(found) = places.into_iter().flatten().find(|place| place.is_file()) else {
            bail!(
                "{}: its log {} is neither where it was nor beside the checkpoint (name it with --data)",
                cannot(&self.file),
                named.display()
            );
        };
        let called = if paths::are_one(named, &found) { named.to_path_buf() } else { found.canonicalize()? };
        Ok(Some(called.display().to_string()))
    }

    /// Whether it is a search of this problem and log.
    pub(super) fn check(&self, problem: &Problem, log: &Log) -> anyhow::Result<()> {
        self.checkpoint.check(problem, log).with_context(|| cannot(&self.file))
    }

    /// How to compute: in the same precision, without which old and new costs would not compare, and on the same device
    /// unless another one is asked for or it is no longer there.
    pub(super) fn compute(&self, asked: &Compute) -> anyhow::Result<Compute> {
        let Device { backend, adapter, precision } = &self.checkpoint.snapshot.device;
        let same = match precision {
            Precision::F32 => PrecisionChoice::F32,
            Precision::F64 => PrecisionChoice::F64,
        };
        if asked.precision != PrecisionChoice::Auto && asked.precision != same {
            bail!(
                "{}: the search ran in {precision}, and costs in two precisions do not compare (leave out --precision, \
                 or start anew without --resume)",
                cannot(&self.file)
            );
        }
        let compute = Compute { precision: same, ..asked.clone() };
        if asked.device != DeviceChoice::Auto || asked.adapter.is_some() {
            return Ok(compute);
        }
        if *backend == Backend::Gpu && evaluator::has_adapter(&adapter.name) {
            return Ok(Compute { device: DeviceChoice::Gpu, adapter: Some(adapter.name.clone()), ..compute });
        }
        Ok(Compute { device: DeviceChoice::Cpu, adapter: None, ..compute })
    }
}

fn cannot(file: &Path) -> String {
    format!("cannot resume from {}", file.display())
}

/// The file to write while this problem is searched on this log.
pub(super) fn file(path: &Path, problem: &Problem, log: &Log, origin: &Origin) -> anyhow::Result<CheckpointFile> {
    files::prepare_file(path)?;
    anyhow::ensure!(
        !files::is_stream(path),
        "cannot keep a checkpoint in {}: it is no file (name one that can be read again)",
        path.display()
    );
    let log_file = origin.file();
    let source = Source {
        problem: problem.source.clone(),
        text: problem.text.clone(),
        log: log_file.map(|file| file.display().to_string()),
        log_absolute: log_file.and_then(|file| Some(file.canonicalize().ok()?.display().to_string())),
        log_from_here: log_file
            .and_then(|file| Some(paths::relative(files::folder_of(path), file)?.display().to_string())),
    };
    Ok(CheckpointFile::new(path.to_path_buf(), Identity::of(problem, log), source))
}

/// Writes the file, and tells the user once when that fails.
pub(super) struct Keeper {
    file: CheckpointFile,
    notices: Notices,
    has_failed: bool,
}

impl Keeper {
    pub(super) const fn new(file: CheckpointFile, notices: Notices) -> Self {
        Self { file, notices, has_failed: false }
    }
}

impl Observer for Keeper {
    fn generation(&mut self, row: &Generation, best: Option<&Scored>) {
        self.file.generation(row, best);
    }

    fn keeps_states(&self) -> bool {
        self.file.keeps_states()
    }

    fn state(&mut self, make: &dyn Fn() -> Snapshot, ended: bool) {
        self.file.state(make, ended);
        let Some(failure) = self.file.failure().filter(|_| !self.has_failed) else { return };
        self.has_failed = true;
        self.notices.warn(&format!(
            "cannot write the checkpoint {}: {failure} (the search goes on, and tries again after every generation)",
            self.file.path().display()
        ));
    }
}
