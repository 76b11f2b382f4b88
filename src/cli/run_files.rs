//! What the files of `tune --out DIR` are called.

use std::path::{Path, PathBuf};

use anyhow::ensure;

/// By which a folder is known to be that of a finished run.
pub(super) const RESULT: &str = "result.json";
/// All others, but for pictures and the checkpoint.
pub(super) const OTHERS: [&str; 4] = ["report.md", TUNED, "history.csv", "front.csv"];
/// The checkpoint of the search.
pub(super) const CHECKPOINT: &str = "checkpoint.kfgpu";
/// The problem with the winner as its start.
pub(super) const TUNED: &str = "tuned.toml";

/// The names of all of them, but for pictures.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    [RESULT, CHECKPOINT].into_iter().chain(OTHERS)
}

/// Whether a file is called like one of a run.
pub(super) fn is_of_run(path: &Path) -> bool {
    path.file_name().is_some_and(|file| names().any(|known| known == file))
}

/// The file of this name where the folder of a run is meant, by itself or by any of its files; else `path`.
pub(super) fn file_in(path: &Path, name: &'static str) -> anyhow::Result<PathBuf> {
    let file = if path.is_dir() {
        path.join(name)
    } else if is_of_run(path) {
        path.with_file_name(name)
    } else {
        return Ok(path.to_path_buf());
    };
    ensure!(
        file.exists() || !path.exists(),
        "{}: is not the folder of a finished run, because it has no {name} (name a folder that `tune --out` wrote)",
        path.display()
    );
    Ok(file)
}
