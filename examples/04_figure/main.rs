//! 1. The picture of the README, from a real study: the Nile's tuned level, and how well the log pins its two variances.
//! 2. `level.rs` draws the flow, the filtered level and its 3-sigma band; `contours.rs` the cost around the optimum.
//! 3. The picture is the same on every run: one seed, one study.
//!
//! `cargo run --release --example 04_figure [OUT.svg]`; without a name it writes to the temporary folder.

#![expect(clippy::print_stdout, reason = "it says where the picture is")]

mod contours;
mod level;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use kfgpu::chart::Figure;
use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions};
use kfgpu::model::Problem;
use kfgpu::reference;
use kfgpu::study::{self, Judge, Study};

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args_os().nth(1).map_or_else(|| std::env::temp_dir().join("nile.svg"), PathBuf::from);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let problem = Problem::open(&folder.join("nile.toml"))?;
    let log = Log::open(&problem.data, &folder)?;
    let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default())?;
    let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let outcome = study::run(&Study::of(&problem), &mut evaluator, judge, &mut [], &AtomicBool::new(false))?;
    let winner = outcome.winner.as_ref().ok_or("every candidate failed")?;
    let run = reference::run(&problem, &log, &winner.candidate)?;

    let figure = Figure::new("The Nile at Aswan").columns(2).size(1040.0, 300.0);
    let figure = figure.panel(level::panel(&log, &run)).panel(contours::panel(&mut evaluator, &outcome, winner));
    std::fs::write(&out, figure.to_svg()?)?;
    println!("{}: nll {:.4} at {:.1?}", out.display(), winner.objectives[0], winner.candidate);
    Ok(())
}
