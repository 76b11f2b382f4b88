//! Why a search cannot be resumed from a file.

/// Why bytes are not a checkpoint that can be resumed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// No byte.
    #[error("the file is empty: name a checkpoint, or start anew without --resume")]
    Empty,
    /// Another kind of file.
    #[error("it is not a checkpoint of kfgpu: name the checkpoint.kfgpu of a run, or its folder")]
    NotACheckpoint,
    /// Another format.
    #[error(
        "it has format {found} of checkpoints, this kfgpu reads format {expected}: resume it with the kfgpu that wrote it"
    )]
    Version {
        /// Version in the file.
        found: u64,
        /// [`super::Checkpoint::VERSION`].
        expected: u32,
    },
    /// Its end is missing.
    #[error("it is truncated, {received} of {expected} bytes are there: copy it again, or start anew without --resume")]
    Truncated {
        /// Bytes received.
        received: u64,
        /// Bytes that its header announces.
        expected: u64,
    },
    /// A bit is wrong.
    #[error("it is damaged, its checksum does not hold: copy it again, or start anew without --resume")]
    Damaged,
    /// Whole, but its content is not what this version writes.
    #[error(
        "its content is not that of a checkpoint, though its checksum holds: resume it with the kfgpu that wrote it"
    )]
    Content,
    /// Another kfgpu.
    #[error(
        "it was written by kfgpu {written_by} with numerics {numerics}, this is {this} with numerics {expected}, whose \
         costs may differ in bits: resume it with the kfgpu that wrote it"
    )]
    Build {
        /// Version of the writer.
        written_by: String,
        /// [`super::NUMERICS`] of the writer.
        numerics: u32,
        /// Version of the reader.
        this: &'static str,
        /// [`super::NUMERICS`] of the reader.
        expected: u32,
    },
    /// The problem is another one.
    #[error(
        "it is of another problem than this{}: resume with the problem and flags it was written with, or start anew \
         without --resume", if differences.is_empty() { String::new() } else { format!(" ({differences})") }
    )]
    AnotherProblem {
        /// Keys of the problem files that differ, as part of a sentence.
        differences: String,
    },
    /// The log is another one.
    #[error(
        "the log is not the one it was written with{}: resume with that log, or start anew without --resume",
        match (differences.as_str(), saved) {
            ("", None) => String::new(),
            ("", Some(name)) => format!(" ({name:?}, as it was then)"),
            (differences, _) => format!(" ({differences})"),
        }
    )]
    AnotherLog {
        /// Name of the checkpoint's log.
        saved: Option<String>,
        /// Keys that decide which rows are searched on and differ, as part of a sentence.
        differences: String,
    },
    /// It cannot be read.
    #[error("it cannot be read: {reason} (name the checkpoint.kfgpu of a run, or its folder)")]
    Unreadable {
        /// What the system says.
        reason: String,
    },
}
