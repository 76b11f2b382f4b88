//! What must hold of every optimiser of the registry, whatever the space and the costs.

use kfgpu::evaluate::{Evaluation, Population, Status};
use kfgpu::optimize::{ALGORITHMS, Algorithm, Optimizer, Settings, Space, build};
use kfgpu::random::{Purpose, Stream};
use proptest::prelude::*;

/// A box, some of whose sides may be open, and how often a candidate fails in it.
#[derive(Debug, Clone)]
struct Case {
    /// (low, width, whether the sides are open).
    sides: Vec<(f64, f64, bool)>,
    population: usize,
    seed: u64,
    failing: f64,
}

fn cases() -> impl Strategy<Value = Case> {
    let side = (-1e3..1e3f64, prop_oneof![Just(0.0), 1e-9..1e-6f64, 0.1..1e4f64], prop::bool::weighted(0.2));
    (prop::collection::vec(side, 1..6), 1..24usize, any::<u64>(), prop_oneof![Just(0.0), 0.0..1.0f64, Just(1.0)])
        .prop_map(|(sides, population, seed, failing)| Case { sides, population, seed, failing })
}

impl Case {
    fn space(&self) -> Space {
        let bound = |end: fn(&(f64, f64, bool)) -> f64, open: f64| {
            self.sides.iter().map(|side| if side.2 { open } else { end(side) }).collect()
        };
        let init: Vec<[f64; 2]> = self.sides.iter().map(|(low, width, _)| [*low, low + width]).collect();
        let start = init.iter().map(|[low, high]| 0.25 * low + 0.75 * high).collect();
        Space {
            lower: bound(|s| s.0, f64::NEG_INFINITY),
            upper: bound(|s| s.0 + s.1, f64::INFINITY),
            init,
            seeds: vec![start],
        }
    }

    fn settings(&self, row: &Algorithm) -> Settings {
        Settings {
            population: self.population.max(row.minimum_population),
            generations: 12,
            seed: self.seed,
            objectives: row.maximum_objectives.min(2),
            evaluations: None,
        }
    }

    /// Costs of either sign and any size, the same for the same position; some candidates fail.
    fn evaluate(&self, population: &Population, objectives: usize) -> Evaluation {
        let (mut costs, mut status) = (Vec::new(), Vec::new());
        for position in population.rows() {
            let key = position.iter().fold(self.seed, |key, x| key.rotate_left(17) ^ x.to_bits());
            let mut stream = Stream::new(key, Purpose::Workload, 0, 0);
            status.push(if stream.uniform() < self.failing { Status::NOT_POSITIVE } else { Status::OK });
            costs.extend((0..objectives).map(|_| (stream.uniform() - 0.5) * 10f64.powf(8.0 * stream.uniform())));
        }
        Evaluation::new(objectives, costs, status)
    }

    /// Every population asked for.
    fn drive(&self, optimizer: &mut dyn Optimizer, objectives: usize) -> Vec<Population> {
        let mut populations = Vec::new();
        while let Some(population) = optimizer.ask() {
            optimizer.tell(&population, &self.evaluate(&population, objectives));
            populations.push(population);
        }
        populations
    }
}

fn bits(populations: &[Population]) -> Vec<u64> {
    populations.iter().flat_map(Population::values).map(|x| x.to_bits()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn bounds_are_never_left_and_positions_stay_finite(case in cases()) {
        let space = case.space();
        for row in ALGORITHMS {
            let settings = case.settings(row);
            let mut optimizer = build(row.name, &space, &settings).unwrap();
            let populations = case.drive(optimizer.as_mut(), settings.objectives);
            prop_assert!(!populations.is_empty(), "{} asks at least once", row.name);
            for position in populations.iter().flat_map(Population::rows) {
                let inside = |d: usize| (space.lower[d]..=space.upper[d]).contains(&position[d]) && position[d].is_finite();
                prop_assert!((0..position.len()).all(inside), "{}: {position:?} in {space:?}", row.name);
            }
        }
    }

    #[test]
    fn the_seed_decides(case in cases()) {
        for row in ALGORITHMS {
            let settings = case.settings(row);
            let run = || {
                let mut optimizer = build(row.name, &case.space(), &settings).unwrap();
                bits(&case.drive(optimizer.as_mut(), settings.objectives))
            };
            prop_assert_eq!(run(), run(), "{}", row.name);
        }
    }
}
