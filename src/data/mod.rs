//! Logs: rows of (trajectory, time, measurements, inputs, truth).

mod clock;
mod columns;
mod decimal;
mod error;
mod format;
mod held_out;
mod instant;
mod lines;
mod log;
mod oddity;
mod read;
mod rows;
mod sensors;
mod spec;
mod summary;
#[cfg(test)]
mod tests;
mod times;
mod unit;
mod write;

pub use error::{LogError, Place};
pub use format::Format;
pub use held_out::HeldOut;
pub use log::{Log, Table, Trajectory};
pub use oddity::{Kind as OddityKind, Oddity};
pub use spec::{DataSpec, SensorSpec, SplitBy, ValidateSpec};
pub use summary::{ColumnSummary, Intervals, Summary};
pub use times::{Origin, Times};
pub use unit::TimeUnit;

pub(crate) use clock::Clock;
pub(crate) use instant::{looks_like_an_instant, no_instant};
pub(crate) use rows::Rows;
