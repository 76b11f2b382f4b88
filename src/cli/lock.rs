//! Locks on what a run writes: two that write the same files at once would leave a mixture.
//!
//! A lock is one of the operating system on an empty file, so that a process that is killed holds none.

use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use super::files::folder_of;
use super::run_files::CHECKPOINT;

/// The file that is locked in a folder of results.
pub(super) const NAME: &str = ".kfgpu.lock";

/// Held until it is dropped, or until the process ends in any way.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// On a folder; `None` where its file system has no locks.
    ///
    /// # Errors
    /// If another process holds it, or nothing can be written there.
    pub(super) fn of_folder(folder: &Path) -> anyhow::Result<Option<Self>> {
        Self::take(folder.join(NAME), &format!("the folder {}", folder.display()))
    }

    /// On a checkpoint, which need not be there: that of a folder of results has the lock of the folder.
    ///
    /// # Errors
    /// As [`Self::of_folder`].
    pub(super) fn of_file(file: &Path) -> anyhow::Result<Option<Self>> {
        if file.file_name().is_some_and(|name| name == CHECKPOINT) {
            return Self::of_folder(folder_of(file));
        }
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        Self::take(folder_of(file).join(format!(".{name}.lock")), &file.display().to_string())
    }

    fn take(path: PathBuf, what: &str) -> anyhow::Result<Option<Self>> {
        loop {
            let opened = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
            let mut file = opened.with_context(|| format!("cannot lock {what} (choose a place you may write to)"))?;
            match file.try_lock() {
                Ok(()) if is_still(&file, &path) => {
                    // Only a message reads it.
                    let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
                    return Ok(Some(Self { path, _file: file }));
                }
                // Whoever held it has just removed the file that was opened here.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let holder = fs::read_to_string(&path).ok().filter(|id| id.parse::<u32>().is_ok());
                    let holder = holder.map_or_else(String::new, |id| format!(" (process {id})"));
                    bail!("another kfgpu{holder} is writing {what}: wait until it ends, or choose another place");
                }
                Err(TryLockError::Error(_)) => return Ok(None),
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Where it stays, the next run takes it over.
        let _ = fs::remove_file(&self.path);
    }
}

/// Whether the file that is open is the one at `path`.
fn is_still(file: &File, path: &Path) -> bool {
    matches!((file.metadata(), fs::metadata(path)), (Ok(open), Ok(named)) if is_same(&open, &named))
}

#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
fn is_same(_: &Metadata, _: &Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_it_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        // What a killed process leaves is no lock.
        fs::write(folder.path().join(NAME), "4000000000").unwrap();
        let held = Lock::of_folder(folder.path()).unwrap();
        assert!(held.is_some(), "this file system has locks");
        let refused = Lock::of_folder(folder.path()).unwrap_err().to_string();
        let expected = format!("another kfgpu (process {}) is writing the folder ", std::process::id());
        assert!(refused.starts_with(&expected), "{refused}");
        let file = Lock::of_file(&folder.path().join("run.kfgpu")).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "a file has a lock of its own");
        drop((held, file));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(Lock::of_folder(folder.path()).unwrap().is_some(), "it can be taken again");
    }
}
