//! What stands where something is to be written: kept under a number, or removed where a killed process left it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

/// The first of `path.1`, `path.2`, ... that is free.
pub(super) fn numbered(path: &Path) -> anyhow::Result<PathBuf> {
    // `.` and `..` have a name only in full.
    let whole = if path.file_name().is_some() { path.to_path_buf() } else { path.canonicalize()? };
    let numbered = |n: u32| {
        let mut name = whole.clone().into_os_string();
        name.push(format!(".{n}"));
        PathBuf::from(name)
    };
    (1..u32::MAX).map(numbered).find(|path| !path.exists()).context("every number is taken")
}

/// Removes the temporary files `.NAME.PROCESS.tmp` of processes that are no more, of names that are `ours`. That this
/// fails harms nobody.
pub(super) fn remove_leftovers(folder: &Path, ours: impl Fn(&str) -> bool) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let left = name.to_str().and_then(temporary).is_some_and(|(name, id)| ours(name) && !is_running(id));
        if left {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The name of a temporary file, as `files::temporary_name` makes it, in its parts.
fn temporary(name: &str) -> Option<(&str, u32)> {
    let (name, id) = name.strip_prefix('.')?.strip_suffix(".tmp")?.rsplit_once('.')?;
    Some((name, id.parse().ok()?))
}

/// Whether there is such a process, as far as can be told.
#[cfg(unix)]
fn is_running(process: u32) -> bool {
    use nix::{errno::Errno, sys::signal, unistd::Pid};
    let id = i32::try_from(process).ok().filter(|id| *id > 0);
    id.is_some_and(|id| signal::kill(Pid::from_raw(id), None) != Err(Errno::ESRCH))
}

#[cfg(not(unix))]
const fn is_running(_process: u32) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_free_number_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        assert_eq!(numbered(&path).unwrap(), folder.path().join("run.csv.1"));
        fs::write(folder.path().join("run.csv.1"), "").unwrap();
        assert_eq!(numbered(&path).unwrap(), folder.path().join("run.csv.2"));
        let here = numbered(Path::new(".")).unwrap();
        assert!(here.is_absolute() && here.parent().is_some_and(Path::is_dir), "{here:?}");
    }

    #[cfg(unix)]
    #[test]
    fn only_what_nobody_writes_any_more_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str| fs::write(folder.path().join(name), "half").unwrap();
        // No Linux has so many processes.
        let dead = i32::MAX;
        let running = format!(".history.csv.{}.tmp", std::process::id());
        let kept = [running.as_str(), "history.csv", ".notes.txt.2147483647.tmp", ".history.csv.tmp", ".tmp"];
        kept.iter().for_each(|name| write(name));
        write(&format!(".history.csv.{dead}.tmp"));
        remove_leftovers(folder.path(), |name| name.ends_with(".csv"));
        let mut left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        left.sort();
        let mut kept = kept;
        kept.sort_unstable();
        assert_eq!(left, kept);
    }
}
