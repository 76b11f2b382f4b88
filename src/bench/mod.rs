//! Filter-steps per second: three standard workloads, and the measurement behind `kfgpu bench`.

mod candidates;
mod process;
mod report;
mod run;
mod workload;

pub use candidates::candidates;
pub use process::cpu_time;
pub use report::Report;
pub use run::{BenchError, Options, Subject, run};
pub use workload::Workload;
