//! Logs: rows of (trajectory, time, measurements, inputs, truth).

mod log;
mod simulate;

pub use log::{Log, Table, Trajectory};
pub use simulate::{SimulateError, simulate};
