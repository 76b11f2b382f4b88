//! Logs: rows of (trajectory, time, measurements, inputs, truth).

mod log;

pub use log::{Log, Table, Trajectory};
