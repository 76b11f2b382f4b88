//! Filter-steps per second (candidates x rows) of every contender on every workload, one thread.
//!
//! `cargo bench --bench filter_steps`; a part by name: `cargo bench --bench filter_steps -- "A/kfgpu"`.

mod baseline;
mod contenders;
mod handwritten;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use std::time::Duration;

fn filter_steps(criterion: &mut Criterion) {
    for game in contenders::matches() {
        let mut group = criterion.benchmark_group(game.workload.name());
        group.throughput(Throughput::Elements(game.steps));
        // One evaluation takes up to 0.3 s: few samples, each of few evaluations.
        group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(5));
        for mut contender in game.contenders {
            group.bench_function(contender.name, |bencher| bencher.iter(&mut contender.evaluate));
        }
        group.finish();
    }
}

criterion_group!(benches, filter_steps);
criterion_main!(benches);
