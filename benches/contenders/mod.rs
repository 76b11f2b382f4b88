//! Everything that is timed on a workload: kfgpu's tape, the baseline, and the filter written by hand.

use super::baseline::Baseline;
use super::handwritten::{self, Filter, Real};
use kfgpu::bench::{Workload, candidates};
use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::model::Problem;
use std::hint::black_box;
use std::num::NonZero;

/// One program scoring all candidates of a workload, on one thread.
pub(crate) struct Contender {
    /// What it is, with its precision.
    pub(crate) name: &'static str,
    /// One evaluation of every candidate.
    pub(crate) evaluate: Box<dyn FnMut()>,
}

/// A workload with its candidates, and who runs it.
pub(crate) struct Match {
    pub(crate) workload: Workload,
    /// Candidates x rows.
    pub(crate) steps: u64,
    pub(crate) contenders: Vec<Contender>,
}

/// Baseline first, then by hand, then kfgpu.
pub(crate) fn matches() -> Vec<Match> {
    [(Workload::A, 1024), (Workload::B, 1024), (Workload::C, 16)].map(|(workload, n)| of(workload, n)).into()
}

fn of(workload: Workload, n: usize) -> Match {
    let problem = workload.problem().expect("the embedded problem parses");
    let log = workload.log(&problem).expect("the embedded log reads");
    let population = candidates(&problem.parameters, n);
    let rows = rows(&log);
    let steps = (n * rows.len()) as u64;
    let contenders = vec![
        nalgebra(workload, &rows, &population),
        by_hand::<f64>("by hand f64", workload, &rows, &population),
        by_hand::<f32>("by hand f32", workload, &rows, &population),
        kfgpu("kfgpu f64", (&problem, &log), &population, Precision::F64),
        kfgpu("kfgpu f32", (&problem, &log), &population, Precision::F32),
    ];
    Match { workload, steps, contenders }
}

/// The measurements of the only trajectory.
fn rows(log: &Log) -> Vec<Vec<f64>> {
    let trajectory = &log.trajectories[0];
    (0..trajectory.len()).map(|k| trajectory.z.row(k).to_vec()).collect()
}

fn nalgebra(workload: Workload, rows: &[Vec<f64>], population: &Population) -> Contender {
    let (baseline, population) = (Baseline::new(workload, rows), population.clone());
    let evaluate = move || {
        for candidate in population.rows() {
            black_box(baseline.score(black_box(candidate)));
        }
    };
    Contender { name: "nalgebra f64", evaluate: Box::new(evaluate) }
}

fn by_hand<T: Real + 'static>(
    name: &'static str,
    workload: Workload,
    rows: &[Vec<f64>],
    population: &Population,
) -> Contender {
    let filter = match workload {
        Workload::A => Filter::Rocket,
        Workload::B => Filter::ConstantVelocity { dt: 4.0 },
        Workload::C => Filter::ConstantVelocity { dt: 0.1 },
    };
    let z: Vec<Vec<T>> = handwritten::columns(rows.iter().map(Vec::as_slice));
    let candidates: Vec<Vec<T>> = handwritten::columns(population.rows());
    // Few candidates fill only a narrow block.
    let evaluate: Box<dyn FnMut()> = if population.len() < 64 {
        Box::new(move || drop(black_box(handwritten::score::<T, 16>(filter, black_box(&z), black_box(&candidates)))))
    } else {
        Box::new(move || drop(black_box(handwritten::score::<T, 64>(filter, black_box(&z), black_box(&candidates)))))
    };
    Contender { name, evaluate }
}

fn kfgpu(
    name: &'static str,
    (problem, log): (&Problem, &Log),
    population: &Population,
    precision: Precision,
) -> Contender {
    let options = CpuOptions { precision, threads: NonZero::new(1) };
    let mut evaluator = CpuEvaluator::new(problem, log, options).expect("the workload traces");
    let population = population.clone();
    Contender { name, evaluate: Box::new(move || drop(black_box(evaluator.evaluate(black_box(&population))))) }
}
