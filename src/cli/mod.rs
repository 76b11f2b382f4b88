//! The command line: one file a verb.

use std::process::ExitCode;

/// Runs the command with the process's arguments; the exit code is 0 done, 1 not acceptable, 2 wrong use or input.
#[must_use]
pub fn main() -> ExitCode {
    ExitCode::from(2)
}
