//! kfgpu tunes Kalman filters: each candidate of a population is a whole filter run over a whole measurement log.
//!
//! The folders below are the pipeline, in order:
//!
//! ```text
//! data (log) -> model (problem) -> tape + filter + objective (traced program)
//!            -> evaluate (population of costs) <- optimize (moves the population)
//!            -> study (the one loop) -> report;   reference = the independent f64 oracle
//! ```
//!
//! # Quick start
//!
//! A problem says what is known and what is searched; here its log is drawn from the model itself.
//!
//! ```
//! use kfgpu::simulate::simulate;
//! use kfgpu::evaluate::{CpuEvaluator, CpuOptions};
//! use kfgpu::model::Problem;
//! use kfgpu::reference;
//! use kfgpu::report::Consistency;
//! use kfgpu::study::{self, Judge, Study};
//! use std::sync::atomic::AtomicBool;
//!
//! let problem = Problem::parse(
//!     r#"
//!     [data]
//!     measurements = ["z"]
//!     [model]
//!     kind = "constant-velocity"
//!     axes = ["x"]
//!     q = "q"
//!     R = ["r"]
//!     x0 = [0, 0]
//!     P0 = [10, 10]
//!     [parameters]
//!     q = { min = 1e-3, max = 1e3, scale = "log", start = 10 }
//!     r = { min = 1e-3, max = 1e3, scale = "log", start = 10 }
//!     [tune]
//!     population = 32
//!     generations = 10
//!     [simulate]
//!     steps = 300
//!     parameters = { q = 0.1, r = 4 }
//!     "#,
//!     "track.toml",
//! )?;
//! let log = simulate(&problem, None)?;
//!
//! // The search runs on the tape, the independent reference decides.
//! let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default())?;
//! let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
//! let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
//! let outcome = study::run(&Study::of(&problem), &mut evaluator, judge, &mut [], &AtomicBool::new(false))?;
//!
//! let winner = outcome.winner.expect("some candidate is usable");
//! assert!(winner.certificate.largest_relative_gap < 1e-12);
//! let [q, r] = winner.candidate[..] else { unreachable!("two parameters are searched") };
//! assert!((0.03..0.3).contains(&q) && (2.0..8.0).contains(&r));
//!
//! let run = reference::run(&problem, &log, &winner.candidate)?;
//! let consistency = Consistency::of(&problem, &log, &winner.candidate, &run);
//! assert!((consistency.nis_low..consistency.nis_high).contains(&consistency.nis_mean));
//! println!("{consistency}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The pieces one by one
//!
//! A [`data::Log`] reads CSV from any reader. An empty cell is a missing measurement, and NaN in the tables.
//!
//! ```
//! use kfgpu::data::{Log, Summary};
//! use kfgpu::data::DataSpec;
//!
//! let spec = DataSpec { time: Some("t".into()), measurements: vec!["z".into()], ..DataSpec::default() };
//! let log = Log::read(&spec, "t,z\n0,1.5\n0.5,\n1,1.7\n".as_bytes(), "log.csv")?;
//! assert_eq!(log.regular_dt(), Some(0.5));
//! assert!(log.trajectories[0].z.row(1)[0].is_nan());
//! println!("{}", Summary::of(&log));
//! # Ok::<(), kfgpu::data::LogError>(())
//! ```
//!
//! An [`evaluate::Evaluator`] scores whole populations; a [`filter::Program`] is what it runs, and prints itself. The
//! cost is that of the reference, to rounding.
//!
//! ```
//! # use kfgpu::data::Log;
//! # use kfgpu::model::Problem;
//! # use kfgpu::reference;
//! use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
//!
//! # let problem = Problem::parse(
//! #     "[data]\nfile = \"-\"\nmeasurements = [\"z\"]\n[model]\nkind = \"local-level\"\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\n\
//! #      P0 = [3]\n[parameters]\nq = { min = 0.1, max = 1 }\nr = { min = 0.1, max = 1 }\n",
//! #     "level.toml",
//! # )?;
//! # let log = Log::read(&problem.data, "z\n4\n2\n3\n".as_bytes(), "log.csv")?;
//! let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default())?;
//! let population = Population::from_rows(2, vec![0.25, 1.0, 0.5, 0.5]);
//! let evaluation = evaluator.evaluate(&population);
//! for (i, candidate) in population.rows().enumerate() {
//!     let expected = reference::costs(&problem, &log, candidate)?[0];
//!     assert!(evaluation.status(i).is_ok());
//!     assert!((evaluation.costs(i)[0] - expected).abs() < 1e-12);
//! }
//! assert!(evaluator.program().to_string().contains("# step, once a row"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! An [`optimize::Optimizer`] is asked for positions and told their costs. It sees no filter.
//!
//! ```
//! use kfgpu::evaluate::{Evaluation, Status};
//! use kfgpu::optimize::{self, Settings, Space};
//!
//! let settings = Settings { population: 20, generations: 40, seed: 1, objectives: 1, evaluations: None };
//! let mut optimizer = optimize::build("pio+", &Space::boxed(&[[-1.0, 5.0]]), &settings)?;
//! let mut best = f64::INFINITY;
//! while let Some(positions) = optimizer.ask() {
//!     let costs: Vec<f64> = positions.rows().map(|x| (x[0] - 2.0).powi(2)).collect();
//!     best = costs.iter().copied().fold(best, f64::min);
//!     let status = vec![Status::OK; costs.len()];
//!     optimizer.tell(&positions, &Evaluation::new(1, costs, status));
//! }
//! assert!(best < 1e-6);
//! # Ok::<(), kfgpu::optimize::OptimizeError>(())
//! ```

pub mod bench;
pub mod chart;
pub mod data;
pub mod evaluate;
pub mod filter;
pub mod model;
mod number;
pub mod objective;
pub mod optimize;
pub mod population;
pub mod precision;
pub mod random;
pub mod reference;
pub mod report;
pub mod reproduce;
pub mod simulate;
pub mod study;
pub mod table;
pub mod tape;
mod words;

#[cfg(feature = "cli")]
pub mod cli;
