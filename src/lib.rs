//! kfgpu tunes Kalman filters: each candidate of a population is a whole filter run over a whole measurement log.
//!
//! The folders below are the pipeline, in order:
//!
//! ```text
//! data (log) -> model (problem) -> tape + filter + objective (traced program)
//!            -> evaluate (population of costs) <- optimize (moves the population)
//!            -> study (the one loop) -> report;   reference = the independent f64 oracle
//! ```

pub mod bench;
pub mod data;
pub mod evaluate;
pub mod filter;
pub mod model;
pub mod objective;
pub mod optimize;
pub mod reference;
pub mod report;
pub mod study;
pub mod tape;

#[cfg(feature = "cli")]
pub mod cli;
