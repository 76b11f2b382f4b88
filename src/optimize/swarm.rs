//! What all swarms share: the first population and the best position.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Space;
use crate::population::{Evaluation, Population};
use crate::random::{Purpose, Stream};

/// `size` positions drawn uniformly from `space.init` and clipped to the box, one stream each.
pub(super) fn draw(space: &Space, size: usize, seed: u64, generation: u64) -> Population {
    let mut population = Population::new(space.dimension());
    let mut position = vec![0.0; space.dimension()];
    for i in 0..size as u64 {
        let mut stream = Stream::new(seed, Purpose::Population, generation, i);
        for (x, [low, high]) in position.iter_mut().zip(&space.init) {
            *x = low + stream.uniform() * (high - low);
        }
        space.clip(&mut position);
        population.push(&position);
    }
    population
}

/// Generation 0: drawn, then the first members replaced by the seeds (clipped to the box).
pub(super) fn first(space: &Space, size: usize, seed: u64) -> Population {
    let mut population = draw(space, size, seed, 0);
    for (i, seed) in space.seeds.iter().take(size).enumerate() {
        population.row_mut(i).copy_from_slice(seed);
        space.clip(population.row_mut(i));
    }
    population
}

/// Moves every member of a swarm, on all cores where it is large. A member draws from a stream of its own, so that this
/// changes no bit. Of `b` there may be more rows than of `a`.
pub(super) fn for_each(a: &mut Population, b: &mut Population, step: impl Fn(usize, &mut [f64], &mut [f64]) + Sync) {
    /// Coordinates that a core moves in a fraction of a millisecond.
    const TASK: usize = 1 << 14;
    let d = a.dimension().max(1);
    if a.values().len() < 2 * TASK {
        let rows = a.values_mut().chunks_mut(d).zip(b.values_mut().chunks_mut(d)).enumerate();
        return rows.for_each(|(i, (a, b))| step(i, a, b));
    }
    let rows = a.values_mut().par_chunks_mut(d).zip(b.values_mut().par_chunks_mut(d)).enumerate();
    rows.with_min_len(TASK / d).for_each(|(i, (a, b))| step(i, a, b));
}

/// The best position ever evaluated, X_g or G_best.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Best {
    pub(super) position: Vec<f64>,
    pub(super) cost: f64,
}

impl Best {
    pub(super) fn none(dimension: usize) -> Self {
        Self { position: vec![0.0; dimension], cost: f64::INFINITY }
    }

    /// Replaced by the best of the population if that is strictly better (the first one on ties).
    pub(super) fn update(&mut self, population: &Population, costs: &Evaluation) {
        for (i, position) in population.rows().enumerate() {
            let cost = costs.costs(i)[0];
            if cost < self.cost {
                self.cost = cost;
                self.position.copy_from_slice(position);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each member by its own stream: a large swarm on four threads moves as its members do one by one.
    #[test]
    fn cores_change_no_bit() {
        let space = Space::boxed(&[[-1.0, 1.0]; 3]);
        let (x, v) = (draw(&space, 30_000, 7, 0), draw(&space, 30_000, 7, 1));
        let step = |i: usize, x: &mut [f64], v: &mut [f64]| {
            let mut stream = Stream::new(3, Purpose::Move, 2, i as u64);
            for (x, v) in x.iter_mut().zip(v) {
                *v = 0.7 * *v + stream.uniform() * *x;
                *x += *v;
            }
        };
        let mut whole = (x.clone(), v.clone());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        pool.install(|| for_each(&mut whole.0, &mut whole.1, step));
        for i in [0, 1, 4_999, 15_000, 29_999] {
            let (mut x, mut v) = (x.row(i).to_vec(), v.row(i).to_vec());
            step(i, &mut x, &mut v);
            assert_eq!((whole.0.row(i), whole.1.row(i)), (&x[..], &v[..]), "member {i}");
        }
        // A flock that has lost members keeps their velocities at the end.
        let (mut few, mut all) = (draw(&space, 2, 7, 0), v.clone());
        for_each(&mut few, &mut all, step);
        assert_eq!(all.row(2), v.row(2), "no member, no step");
    }
}
