//! Paths in written problem files.

use std::path::{Component, Path, PathBuf};

use anyhow::bail;

/// `file` as seen from `folder`, both as the process sees them: relative where they share a folder below the root, so
/// that the tree can move, else absolute. An absolute `file` stays as the user gave it.
pub(super) fn seen_from(folder: &Path, file: &Path) -> PathBuf {
    if file.is_absolute() {
        return file.to_path_buf();
    }
    relative(folder, file).or_else(|| file.canonicalize().ok()).unwrap_or_else(|| file.to_path_buf())
}

/// `file` as seen from `folder`, if they share a folder below the root.
pub(super) fn relative(folder: &Path, file: &Path) -> Option<PathBuf> {
    let (folder, file) = (folder.canonicalize().ok()?, file.canonicalize().ok()?);
    let shared = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let is_name = |c: &Component| matches!(c, Component::Normal(_));
    if !folder.components().take(shared).any(|c| is_name(&c)) {
        return None;
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    Some(up.chain(file.components().skip(shared)).collect())
}

/// Whether both are there and the same.
pub(super) fn are_one(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Refuses to write over what the command reads; `--force` is for other files.
pub(super) fn ensure_not_read(out: Option<&Path>, inputs: &[Option<&Path>]) -> anyhow::Result<()> {
    match out.filter(|out| inputs.iter().flatten().any(|input| are_one(out, input))) {
        Some(out) => bail!("{} is read by this command and would be replaced (choose another name)", out.display()),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_is_found_again_from_the_folder() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path().canonicalize().unwrap();
        fs::create_dir_all(root.join("out/first")).unwrap();
        fs::create_dir_all(root.join("data")).unwrap();
        fs::write(root.join("data/log.csv"), "t,z\n").unwrap();
        // Tests share the process's folder, so relative paths are made from it.
        let here = std::env::current_dir().unwrap().canonicalize().unwrap();
        let to_root: PathBuf =
            here.components().skip(1).map(|_| Component::ParentDir).chain(root.components().skip(1)).collect();
        let seen = seen_from(&to_root.join("out/first"), &to_root.join("data/log.csv"));
        assert_eq!(seen, Path::new("../../data/log.csv"));
        assert!(root.join("out/first").join(&seen).exists(), "{seen:?}");
        let absolute = root.join("data/log.csv");
        assert_eq!(seen_from(&to_root, &absolute), absolute);
    }
}
