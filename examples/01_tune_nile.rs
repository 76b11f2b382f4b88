//! 1. The Nile's annual flow is a wandering level seen through noise. How much of each?
//! 2. The library's pieces in the order of the pipeline: problem, log, evaluator, study, judgement.
//! 3. The answer of this form is known: 15099.687 and 1468.501, negative log-likelihood 641.5855783461
//!    (Durbin and Koopman 2012, chapter 2).
//!
//! `cargo run --release --example 01_tune_nile`

#![expect(clippy::print_stdout, reason = "a story is read on the terminal")]

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions};
use kfgpu::model::Problem;
use kfgpu::reference;
use kfgpu::report::Consistency;
use kfgpu::study::{self, Judge, Study};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let problem = Problem::open(&folder.join("nile.toml"))?;
    let log = Log::open(&problem.data, &folder)?;
    for warning in problem.check_log(&log)? {
        println!("warning: {warning}");
    }

    // The search runs on the tape; the independent f64 reference has the last word on what it found.
    let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default())?;
    let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let never = AtomicBool::new(false);
    let outcome = study::run(&Study::of(&problem), &mut evaluator, judge, &mut [], &never)?;
    let winner = outcome.winner.ok_or("every candidate failed")?;

    for ((name, start), tuned) in
        problem.parameters.names().iter().zip(&outcome.baseline.candidate).zip(&winner.candidate)
    {
        println!("{name}: {start} -> {tuned:.3}");
    }
    let before = outcome.baseline.objectives.ok_or("the baseline fails")?;
    println!("nll: {:.7} -> {:.7} in {} evaluations", before[0], winner.objectives[0], outcome.evaluations);
    let certificate = &winner.certificate;
    println!(
        "search against reference: {:.1e}, order held: {}",
        certificate.largest_relative_gap, certificate.order_held
    );

    let run = reference::run(&problem, &log, &winner.candidate)?;
    let verdict = Consistency::of(&problem, &log, &winner.candidate, &run);
    println!("mean NIS {:.3}, 95 % band {:.3} to {:.3}", verdict.nis_mean, verdict.nis_low, verdict.nis_high);
    println!("{}", verdict.verdict);
    Ok(())
}
