//! How many times faster than nalgebra: extended and unscented filters of range and bearing, n = 4, 1,000 rows, 4,096 candidates.
//!
//! `cargo bench --bench nonlinear`. On one thread, by the CPU time of the process, contenders in turn; a ratio is the median over
//! rounds of the ratio within a round.

#[path = "nonlinear/mod.rs"]
mod by_nalgebra;

use by_nalgebra::Baseline;
use kfgpu::bench::{candidates, cpu_time};
use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::filter::trace;
use kfgpu::model::Problem;
use std::hint::black_box;
use std::num::NonZero;
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

const CANDIDATES: usize = 4096;
const ROUNDS: usize = 9;
/// Candidates of the baseline in a round: it is the slowest, and its time is proportional to their number.
const SHARE: usize = 8;

type Evaluate = Box<dyn FnMut()>;

#[expect(clippy::print_stdout, reason = "the table is the result")]
fn main() {
    // `cargo test --benches` runs this with `--test`: a few candidates show that it works.
    let test = std::env::args().any(|a| a == "--test");
    let (n, rounds) = if test { (64, 1) } else { (CANDIDATES, ROUNDS) };
    println!("| filter | program | flops a step | Mstep per CPU-second | x nalgebra f64 |");
    println!("|---|---|---|---|---|");
    for kind in ["extended", "unscented"] {
        let (problem, log) = workload(kind);
        let population = candidates(&problem.parameters, n);
        check(kind, &problem, &log, &population);
        let steps = (n * log.trajectories[0].len()) as f64;
        let mut contenders = vec![baseline(kind, &log, &population)];
        for precision in [Precision::F64, Precision::F32] {
            contenders.push(kfgpu(&problem, &log, &population, precision));
        }
        contenders.iter_mut().for_each(|evaluate| evaluate());
        let seconds: Vec<Vec<f64>> = (0..rounds).map(|_| contenders.iter_mut().map(timed).collect()).collect();
        let flops = trace(&problem, &log, &problem.tune.objectives, None).expect("it traces").counts().flops;
        for (i, name) in ["nalgebra f64", "kfgpu f64", "kfgpu f32"].into_iter().enumerate() {
            let share = if i == 0 { SHARE as f64 } else { 1.0 };
            let rate = steps / share / median(seconds.iter().map(|round| round[i])) / 1e6;
            let ratio = median(seconds.iter().map(|round| SHARE as f64 * round[0] / (share * round[i])));
            let flops = if i == 1 { flops.to_string() } else { String::new() };
            println!("| {kind} | {name} | {flops} | {rate:.2} | {ratio:.2} |");
        }
    }
}

fn workload(kind: &str) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/workloads");
    let text = std::fs::read_to_string(folder.join("range_bearing.toml")).expect("the workload reads");
    let text = text.replace("kind = \"extended\"", &format!("kind = \"{kind}\""));
    let problem = Problem::parse(&text, "range_bearing.toml").expect("the workload parses");
    let log = Log::open(&problem.data, &folder).expect("its log reads");
    (problem, log)
}

/// The two programs compute the same.
fn check(kind: &str, problem: &Problem, log: &Log, population: &Population) {
    let baseline = Baseline { z: measurements(log) };
    let mut lanes = CpuEvaluator::new(problem, log, CpuOptions::default()).expect("it traces");
    let found = lanes.evaluate(population);
    for (i, candidate) in population.rows().take(16).enumerate() {
        let expected = nll(&baseline, kind, candidate);
        let found = found.costs(i)[0];
        assert!((found - expected).abs() < 1e-8 * expected.abs(), "{kind}: {found} against {expected}");
    }
}

fn nll(baseline: &Baseline, kind: &str, candidate: &[f64]) -> f64 {
    if kind == "extended" { baseline.extended(candidate) } else { baseline.unscented(candidate) }
}

fn measurements(log: &Log) -> Vec<nalgebra::Vector2<f64>> {
    let trajectory = &log.trajectories[0];
    (0..trajectory.len()).map(|k| nalgebra::Vector2::from_column_slice(trajectory.z.row(k))).collect()
}

fn baseline(kind: &'static str, log: &Log, population: &Population) -> Evaluate {
    let (baseline, population) = (Baseline { z: measurements(log) }, population.clone());
    Box::new(move || {
        for candidate in population.rows().step_by(SHARE) {
            black_box(nll(&baseline, kind, black_box(candidate)));
        }
    })
}

fn kfgpu(problem: &Problem, log: &Log, population: &Population, precision: Precision) -> Evaluate {
    let options = CpuOptions { precision, threads: NonZero::new(1) };
    let mut evaluator = CpuEvaluator::new(problem, log, options).expect("the workload traces");
    let population = population.clone();
    Box::new(move || drop(black_box(evaluator.evaluate(black_box(&population)))))
}

/// Seconds of CPU time, or of wall time where the system does not tell it.
fn timed(evaluate: &mut Evaluate) -> f64 {
    let start = now();
    evaluate();
    (now() - start).as_secs_f64()
}

fn now() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    cpu_time().unwrap_or_else(|| START.elapsed())
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
