//! Filter-steps per second: three standard workloads, and the measurements behind `kfgpu bench`.

mod candidates;
mod compare;
mod crossover;
mod engine;
mod error;
mod process;
mod report;
mod run;
mod table;
mod times;
mod workload;

pub use candidates::candidates;
pub use compare::{Comparison, Skipped, Suite, compare};
pub use crossover::{Crossover, Rung};
pub use engine::{Adapter, Target, adapters};
pub use error::BenchError;
pub use process::cpu_time;
pub use report::Report;
pub use run::{Options, Subject, run};
pub use workload::Workload;
