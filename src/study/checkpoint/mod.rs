//! Checkpoints: a search between two generations as a file.
//!
//! ```text
//! magic "kfgpuCP\n" | version u32 | length u64 | SHA-256 of magic to length and of the body | body: `length` bytes
//! ```
//!
//! Numbers are little-endian; the body is a [`Checkpoint`] in postcard. Nothing of a file is believed before its
//! checksum is right, and nothing of a checkpoint before its [`Identity`] is that of the problem and log at hand.

mod canon;
mod differences;
mod error;
mod file;
mod identity;
mod sum;
#[cfg(test)]
mod tests;

pub use error::CheckpointError;
pub use file::CheckpointFile;
pub use identity::Identity;

use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::Snapshot;
use crate::data::Log;
use crate::model::Problem;
use crate::words::shorten;

const MAGIC: [u8; 8] = *b"kfgpuCP\n";
/// Magic, version and length; the checksum follows.
const FIXED: usize = MAGIC.len() + 4 + 8;
const HEADER: usize = FIXED + 32;

/// Number of the arithmetic: one for each entry under *Numerics* in CHANGELOG.md, by which the bits of some search have
/// moved. A test compares the two.
pub const NUMERICS: u32 = 13;

/// A search that can be resumed, and what it is a search of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Version of kfgpu that wrote it: another one may compute other bits.
    pub written_by: String,
    /// Its [`NUMERICS`].
    pub numerics: u32,
    /// Of problem and log.
    pub identity: Identity,
    /// Where they come from.
    pub source: Source,
    /// The search.
    pub snapshot: Snapshot,
}

/// Where problem and log of a checkpoint come from, to find them again.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Source {
    /// Name of the problem, for messages and reports.
    pub problem: String,
    /// The problem file's text, with whatever flags have put in place of its keys.
    pub text: String,
    /// The log's file as the user named it.
    pub log: Option<String>,
    /// The same file, wherever the process runs.
    pub log_absolute: Option<String>,
    /// The same file as seen from the folder of the checkpoint, wherever the two of them are moved.
    pub log_from_here: Option<String>,
}

impl Checkpoint {
    /// Version of the file format.
    pub const VERSION: u32 = 3;

    /// Of this state, written by this build.
    #[must_use]
    pub fn new(identity: Identity, source: Source, snapshot: Snapshot) -> Self {
        Self { written_by: env!("CARGO_PKG_VERSION").to_owned(), numerics: NUMERICS, identity, source, snapshot }
    }

    /// Reads the bytes of a file; whatever they are, it does not panic, and takes memory in proportion to them.
    ///
    /// # Errors
    /// If they are not a whole checkpoint of this version of kfgpu.
    ///
    /// ```
    /// use kfgpu::study::{Checkpoint, CheckpointError};
    /// assert_eq!(Checkpoint::read(b""), Err(CheckpointError::Empty));
    /// assert_eq!(Checkpoint::read(b"t,z\n0,1.5\n"), Err(CheckpointError::NotACheckpoint));
    /// ```
    pub fn read(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let body = body(bytes)?;
        let Ok((checkpoint, [])) = postcard::take_from_bytes::<Self>(body) else {
            return Err(CheckpointError::Content);
        };
        let this = env!("CARGO_PKG_VERSION");
        let Self { written_by, numerics, .. } = &checkpoint;
        if (written_by.as_str(), *numerics) != (this, NUMERICS) {
            let written_by = shorten(written_by);
            return Err(CheckpointError::Build { written_by, numerics: *numerics, this, expected: NUMERICS });
        }
        Ok(checkpoint)
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// [`CheckpointError::Content`] if the checkpoint has no postcard form; every one has.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CheckpointError> {
        postcard::to_stdvec(self).map(|body| Self::seal(&body)).map_err(|_| CheckpointError::Content)
    }

    /// A body under its header, with a checksum that holds; for tests of what is read behind one.
    #[doc(hidden)]
    #[must_use]
    pub fn seal(body: &[u8]) -> Vec<u8> {
        let fixed = [&MAGIC[..], &Self::VERSION.to_le_bytes(), &(body.len() as u64).to_le_bytes()].concat();
        [&fixed, &checksum(&fixed, body)[..], body].concat()
    }

    /// Whether it is a checkpoint of this problem and this log.
    ///
    /// # Errors
    /// Which of the two is another one, and in what the problems differ.
    pub fn check(&self, problem: &Problem, log: &Log) -> Result<(), CheckpointError> {
        let identity = Identity::of(problem, log);
        if self.identity.problem != identity.problem {
            let differences = differences::of_searches(&self.source.text, &problem.text);
            return Err(CheckpointError::AnotherProblem { differences });
        }
        if self.identity.log != identity.log {
            let differences = differences::of_logs(&self.source.text, &problem.text);
            let saved = self.source.log.as_deref().map(shorten);
            return Err(CheckpointError::AnotherLog { saved, differences });
        }
        Ok(())
    }

    /// Reads a file.
    ///
    /// # Errors
    /// As [`Self::read`], and if there is no file that can be read.
    pub fn open(path: &Path) -> Result<Self, CheckpointError> {
        let bytes = std::fs::read(path).map_err(|e| CheckpointError::Unreadable { reason: e.to_string() })?;
        Self::read(&bytes)
    }
}

/// The body of a whole file.
fn body(bytes: &[u8]) -> Result<&[u8], CheckpointError> {
    if bytes.is_empty() {
        return Err(CheckpointError::Empty);
    }
    let begun = bytes.len().min(MAGIC.len());
    if bytes[..begun] != MAGIC[..begun] {
        return Err(CheckpointError::NotACheckpoint);
    }
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(CheckpointError::Truncated { received: bytes.len() as u64, expected: HEADER as u64 });
    };
    let (fixed, sum) = header.split_at(FIXED);
    let number = |range: std::ops::Range<usize>| fixed[range].iter().rev().fold(0, |n, byte| n << 8 | u64::from(*byte));
    let (version, length) = (number(MAGIC.len()..MAGIC.len() + 4), number(MAGIC.len() + 4..FIXED));
    if version != u64::from(Checkpoint::VERSION) {
        return Err(CheckpointError::Version { found: version, expected: Checkpoint::VERSION });
    }
    if (body.len() as u64) < length {
        let expected = length.saturating_add(HEADER as u64);
        return Err(CheckpointError::Truncated { received: bytes.len() as u64, expected });
    }
    if body.len() as u64 != length || checksum(fixed, body) != sum {
        return Err(CheckpointError::Damaged);
    }
    Ok(body)
}

fn checksum(fixed: &[u8], body: &[u8]) -> [u8; 32] {
    Sha256::new().chain_update(fixed).chain_update(body).finalize().into()
}
