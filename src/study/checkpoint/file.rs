//! The file of a running search.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::{Checkpoint, Identity, Source};
use crate::study::{Generation, Observer, Scored, Snapshot};

/// Writes a checkpoint after every generation, whole or not at all: under a temporary name beside the file, which is then
/// renamed. A process that ends at any moment leaves the old file or the new one.
///
/// Files above [`Self::SMALL`] (a population of many thousands, or a history as long) are left out while their writing
/// would take more than a fifth of the time; the last state is always written. Every second or so, and at the end, the
/// file is also brought to the disk, against loss of power.
///
/// A write that fails does not end the search: the file stays as it was and [`Self::failure`] says why.
#[derive(Debug)]
pub struct CheckpointFile {
    path: PathBuf,
    identity: Identity,
    source: Source,
    /// Generations in the file.
    written: Option<usize>,
    last: Option<Write>,
    /// When the file was last brought to the disk, and how long that took.
    synced: (Instant, Duration),
    failure: Option<String>,
}

/// A write that has taken place.
#[derive(Debug, Clone, Copy)]
struct Write {
    bytes: usize,
    end: Instant,
    took: Duration,
}

impl CheckpointFile {
    /// Files of so many bytes are written after every generation, in about a millisecond.
    pub const SMALL: usize = 1 << 20;

    /// A file for the search of the problem and log with this identity.
    #[must_use]
    pub fn new(path: PathBuf, identity: Identity, source: Source) -> Self {
        let synced = (Instant::now(), Duration::ZERO);
        Self { path, identity, source, written: None, last: None, synced, failure: None }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Generations in the file, if this search has written it.
    #[must_use]
    pub const fn written(&self) -> Option<usize> {
        self.written
    }

    /// Why the last write failed, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Whether a write like the last one may take place now.
    fn is_due(&self) -> bool {
        self.last.is_none_or(|last| last.bytes <= Self::SMALL || last.end.elapsed() >= 4 * last.took)
    }

    fn write(&mut self, snapshot: Snapshot, ended: bool) -> io::Result<()> {
        let begin = Instant::now();
        let generations = snapshot.history.len();
        // The source is cloned with every write: a problem file is small beside a population.
        let checkpoint = Checkpoint::new(self.identity, self.source.clone(), snapshot);
        let bytes = checkpoint.to_bytes().map_err(io::Error::other)?;
        let (at, took) = self.synced;
        let to_disk = ended || at.elapsed() >= (20 * took).max(Duration::from_secs(1));
        let syncing = replace(&self.path, &bytes, to_disk)?;
        let end = Instant::now();
        if to_disk {
            self.synced = (end, syncing);
        }
        self.last = Some(Write { bytes: bytes.len(), end, took: (end - begin).saturating_sub(syncing) });
        self.written = Some(generations);
        Ok(())
    }
}

impl Observer for CheckpointFile {
    fn generation(&mut self, _row: &Generation, _best: Option<&Scored>) {}

    fn keeps_states(&self) -> bool {
        true
    }

    fn state(&mut self, make: &dyn Fn() -> Snapshot, ended: bool) {
        if !ended && !self.is_due() {
            return;
        }
        self.failure = self.write(make(), ended).err().map(|error| error.to_string());
    }
}

/// Writes `path` whole or leaves it as it was; how long it took to bring it to the disk.
fn replace(path: &Path, bytes: &[u8], to_disk: bool) -> io::Result<Duration> {
    let temporary = temporary_name(path);
    let write = || {
        let mut file = File::create(&temporary)?;
        file.write_all(bytes)?;
        let begin = Instant::now();
        if to_disk {
            file.sync_all()?;
        }
        Ok(begin.elapsed())
    };
    let written = write().and_then(|syncing| fs::rename(&temporary, path).map(|()| syncing));
    if written.is_err() {
        // The first error is the one to report; a temporary file that never came to be cannot be removed either.
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// `.NAME.tmp` beside the file. Without the number of the process: what a killed one leaves, the next one takes over.
fn temporary_name(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".tmp");
    path.with_file_name(name)
}
