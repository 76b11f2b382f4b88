//! A whole study of the rocket in one process: read the problem, draw its log, trace, 20 candidates x 25 generations of
//! PSO, re-score by the f64 reference, polish. The process around it is timed by `benches/RESULTS.md`'s command.
//!
//! `cargo bench --bench study`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Precision};
use kfgpu::model::Problem;
use kfgpu::reference;
use kfgpu::study::{self, Judge, Outcome, Study};
use std::num::NonZero;
use std::sync::atomic::AtomicBool;

const POPULATION: usize = 20;
const GENERATIONS: usize = 25;

/// What `kfgpu tune examples/rocket.toml --population 20 --generations 25` does between its arguments and its report.
fn tune(threads: Option<NonZero<usize>>) -> Outcome {
    let text = include_str!("../examples/rocket.toml");
    let mut problem = Problem::parse(text, "rocket.toml").expect("the example parses");
    problem.tune.population = POPULATION;
    problem.tune.generations = GENERATIONS;
    let log = kfgpu::simulate::simulate(&problem, None).expect("the example says how to draw its log");
    let options = CpuOptions { precision: Precision::F64, threads };
    let mut evaluator = CpuEvaluator::new(&problem, &log, options).expect("the example traces");
    let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    study::run(&Study::of(&problem), &mut evaluator, judge, &mut [], &AtomicBool::new(false)).expect("the study runs")
}

fn rocket(criterion: &mut Criterion) {
    let winner = tune(NonZero::new(1)).winner.expect("the rocket has usable candidates");
    // The log was drawn with r = 3: a study that is fast because it found nothing must not be timed.
    assert!((2.0..4.5).contains(&winner.candidate[0]), "r = {}, drawn with 3", winner.candidate[0]);
    let mut group = criterion.benchmark_group("rocket study 20 x 25");
    group.throughput(Throughput::Elements((POPULATION * GENERATIONS * 201) as u64));
    group.bench_function("1 thread", |bencher| bencher.iter(|| tune(NonZero::new(1))));
    group.bench_function("all cores", |bencher| bencher.iter(|| tune(None)));
    group.finish();
}

criterion_group!(benches, rocket);
criterion_main!(benches);
