//! What NSGA-II itself costs a generation: asking for the offspring and ranking the merged set, without evaluation. And
//! the sorting into fronts alone, of random costs.
//!
//! `cargo bench --bench nsga2`

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use kfgpu::evaluate::Evaluator;
use kfgpu::evaluate::mock::{Mock, MultiObjective};
use kfgpu::optimize::nsga2::{Nsga2, PUBLISHED};
use kfgpu::optimize::pareto::{Scores, fronts};
use kfgpu::optimize::{Optimizer, Settings, Space};
use kfgpu::random::{Purpose, Stream};
use std::time::{Duration, Instant};

/// Searched parameters; a filter has about as many.
const COORDINATES: usize = 4;

/// Asks and tells once, and returns the time of both.
fn generation(search: &mut Nsga2, mock: &mut Mock) -> Duration {
    let clock = Instant::now();
    let population = search.ask().expect("an endless search");
    let asked = clock.elapsed();
    let costs = mock.evaluate(&population);
    let clock = Instant::now();
    search.tell(&population, &costs);
    asked + clock.elapsed()
}

fn own_cost(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("nsga2 generation");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for (function, population) in [
        (MultiObjective::Zdt1, 20),
        (MultiObjective::Zdt1, 1_000),
        (MultiObjective::Zdt1, 100_000),
        (MultiObjective::Dtlz2(3), 1_000),
        (MultiObjective::Dtlz2(3), 100_000),
        (MultiObjective::Dtlz2(4), 1_000),
    ] {
        let objectives = function.objectives();
        let settings = Settings { population, generations: usize::MAX - 1, seed: 1, objectives, evaluations: None };
        let space = Space::boxed(&function.bounds()[..COORDINATES]);
        let mut search = Nsga2::new(&space, &settings, PUBLISHED);
        let mut mock = Mock::new(function);
        generation(&mut search, &mut mock);
        group.throughput(Throughput::Elements(population as u64));
        let id = BenchmarkId::new(format!("{objectives} objectives"), population);
        group.bench_function(id, |bencher| {
            bencher.iter_custom(|times| (0..times).map(|_| generation(&mut search, &mut mock)).sum());
        });
    }
    group.finish();
}

fn sorting(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fronts of uniform costs");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for (objectives, count) in [(2, 200_000), (3, 200_000), (4, 20_000)] {
        let mut stream = Stream::new(1, Purpose::Workload, 0, 0);
        let mut scores = Scores::new(objectives);
        for _ in 0..count {
            let costs: Vec<f64> = (0..objectives).map(|_| stream.uniform()).collect();
            scores.push(&costs, 0.0);
        }
        group.bench_function(BenchmarkId::new(format!("{objectives} objectives"), count), |bencher| {
            bencher.iter(|| fronts(&scores));
        });
    }
    group.finish();
}

criterion_group!(benches, own_cost, sorting);
criterion_main!(benches);
