//! Folders that a verb fills with files of fixed names.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use super::files::{try_writing_in, write_whole};
use super::lock::Lock;
use super::{aside, paths};

/// A folder that could be written to before the work started, and that no other kfgpu writes to meanwhile.
#[derive(Debug)]
pub(super) struct OutFolder {
    path: PathBuf,
    _lock: Option<Lock>,
}

impl OutFolder {
    /// Makes the folder where it does not exist, locks it and tries to write in it. What killed runs left half written
    /// is removed.
    pub(super) fn prepare(path: &Path) -> anyhow::Result<Self> {
        fs::create_dir_all(path).with_context(|| {
            format!("cannot make the output folder {} (choose a folder you may write to)", path.display())
        })?;
        let lock = Lock::of_folder(path)?;
        try_writing_in(path)?;
        aside::remove_leftovers(path, is_ours);
        Ok(Self { path: path.to_path_buf(), _lock: lock })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a file of the folder is there.
    pub(super) fn holds(&self, name: &str) -> bool {
        self.path.join(name).exists()
    }

    /// Refuses to replace files of these names, which `what` are.
    pub(super) fn refuse_existing<'a>(
        &self,
        names: impl IntoIterator<Item = &'a str>,
        what: &str,
    ) -> anyhow::Result<()> {
        let mut names = names.into_iter();
        let Some(name) = names.find(|name| self.holds(name)) else { return Ok(()) };
        bail!("{} exists (choose another folder, or give --force to replace {what})", self.path.join(name).display())
    }

    /// Writes one file of the folder.
    pub(super) fn write(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        write_whole(&self.path.join(name), fill)
    }

    /// Removes one file of the folder, if it is there.
    pub(super) fn remove(&self, name: &str) -> anyhow::Result<()> {
        let path = self.path.join(name);
        match fs::remove_file(&path) {
            // A file in place of a folder holds no other.
            Err(error) if !matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
                Err(error).with_context(|| format!("cannot remove the old {}", path.display()))
            }
            _ => Ok(()),
        }
    }

    /// Moves these files, which may lie in folders of this one, to a new folder beside it, from which paths lead where
    /// they led from here. A file that is the one at `stays` is copied.
    pub(super) fn move_aside(&self, names: &[String], stays: &Path) -> anyhow::Result<PathBuf> {
        let to = aside::numbered(&self.path)?;
        let carry = |name: &String| {
            let (from, to) = (self.path.join(name), to.join(name));
            fs::create_dir_all(to.parent().unwrap_or(&to))?;
            if paths::are_one(&from, stays) { fs::copy(from, to).map(drop) } else { fs::rename(from, to) }
        };
        names.iter().try_for_each(carry).with_context(|| {
            let (from, to) = (self.path.display(), to.display());
            format!("cannot keep the earlier run of {from} in {to} (give --force to replace it)")
        })?;
        Ok(to)
    }
}

/// Whether a file of this name may be one that a verb writes in a folder.
fn is_ours(name: &str) -> bool {
    let known = ["json", "md", "toml", "csv", "svg", "kfgpu"];
    name == "writable" || name.rsplit_once('.').is_some_and(|(_, extension)| known.contains(&extension))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_under_a_file_is_refused_before_work_starts() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = OutFolder::prepare(&file.path().join("out")).unwrap_err();
        assert!(error.to_string().starts_with("cannot make the output folder"), "{error}");
    }

    #[test]
    fn what_is_moved_aside_keeps_its_place_below() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutFolder::prepare(&root.path().join("out")).unwrap();
        let names = ["a.csv", "figures/b.svg", "tuned.toml"];
        fs::create_dir(folder.path().join("figures")).unwrap();
        names.iter().for_each(|name| fs::write(folder.path().join(name), *name).unwrap());
        let stays = folder.path().join("tuned.toml");
        let to = folder.move_aside(&names.map(str::to_owned), &stays).unwrap();
        assert_eq!(to, root.path().join("out.1"));
        names.iter().for_each(|name| assert_eq!(fs::read_to_string(to.join(name)).unwrap(), *name));
        assert_eq!(names.map(|name| folder.holds(name)), [false, false, true]);
    }
}
