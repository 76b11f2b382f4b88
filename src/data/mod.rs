//! Logs: rows of (trajectory, time, measurements, inputs, truth).

mod clock;
mod columns;
mod error;
mod lines;
mod log;
mod read;
mod rows;
mod simulate;
mod split;
mod summary;
#[cfg(test)]
mod tests;
mod write;

pub use error::{LogError, Place};
pub use log::{Log, Table, Trajectory};
pub use simulate::{SimulateError, simulate};
pub use split::{HeldOut, Split, SplitError, scoring_rows};
pub use summary::{ColumnSummary, Intervals, Summary};

pub(crate) use clock::Clock;
pub(crate) use rows::Rows;
