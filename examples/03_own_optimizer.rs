//! 1. An optimiser is `ask` and `tell`; it sees positions and costs, never a filter or a device.
//! 2. Here: the cross-entropy method. Draw from a normal distribution, move it to the best quarter, repeat.
//! 3. It runs in the same study as the built-in ones and is compared with them over ten seeds.
//!    R. Y. Rubinstein, Methodol. Comput. Appl. Probab. 1 (1999), doi 10.1023/A:1010091220143.
//!
//! `cargo run --release --example 03_own_optimizer`

#![expect(clippy::print_stdout, reason = "a story is read on the terminal")]

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Population};
use kfgpu::model::{Problem, TuneSpec};
use kfgpu::optimize::{self, Optimizer, Settings, Space};
use kfgpu::random::{Purpose, Stream};
use kfgpu::reference;
use kfgpu::study::{self, Coordinates, Judge, Study};
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A normal distribution with independent coordinates, moved to its own best quarter.
struct CrossEntropy {
    space: Space,
    settings: Settings,
    generation: usize,
    mean: Vec<f64>,
    deviation: Vec<f64>,
}

impl Optimizer for CrossEntropy {
    fn name(&self) -> &'static str {
        "cross-entropy"
    }

    fn ask(&mut self) -> Option<Population> {
        let Settings { population, generations, seed, .. } = self.settings;
        let mut candidates = Population::new(self.space.dimension());
        for i in 0..population as u64 {
            // A stream per (generation, candidate): the result depends on the seed alone.
            let mut stream = Stream::new(seed, Purpose::Move, self.generation as u64, i);
            let mut draw =
                |(mean, deviation)| mean + deviation * Distribution::<f64>::sample(&StandardNormal, &mut stream);
            let mut position: Vec<f64> = self.mean.iter().zip(&self.deviation).map(&mut draw).collect();
            self.space.clip(&mut position);
            candidates.push(&position);
        }
        (self.generation <= generations).then_some(candidates)
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        let mut order: Vec<usize> = (0..population.len()).collect();
        order.sort_by(|a, b| costs.costs(*a)[0].total_cmp(&costs.costs(*b)[0]));
        let elite = &order[..(population.len() / 4).max(2)];
        for d in 0..self.space.dimension() {
            let mean_of = |value: &dyn Fn(f64) -> f64| {
                elite.iter().map(|i| value(population.row(*i)[d])).sum::<f64>() / elite.len() as f64
            };
            let mean = mean_of(&|x| x);
            self.deviation[d] = mean_of(&|x| (x - mean).powi(2)).sqrt();
            self.mean[d] = mean;
        }
        self.generation += 1;
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let problem = Problem::open(&folder.join("nile.toml"))?;
    let log = Log::open(&problem.data, &folder)?;
    let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default())?;
    let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
    println!("nll above the optimum 641.5855783461 (known to 1e-10) after 512 evaluations: the range of ten seeds");
    for algorithm in ["cross-entropy", "pso", "pio+", "random"] {
        let mut excess = Vec::new();
        for seed in 0..10 {
            let settings = Settings { population: 32, generations: 15, seed, objectives: 1, evaluations: None };
            let tune = TuneSpec { polish: false, ..problem.tune.clone() };
            let study = Study { parameters: &problem.parameters, tune: &tune };
            let space = Coordinates::new(&problem.parameters, true).space();
            let mut optimizer: Box<dyn Optimizer> = match algorithm {
                "cross-entropy" => {
                    let mean = space.init.iter().map(|[low, high]| f64::midpoint(*low, *high)).collect();
                    let deviation = space.init.iter().map(|[low, high]| (high - low) / 3.0).collect();
                    Box::new(CrossEntropy { space, settings, generation: 0, mean, deviation })
                }
                name => optimize::build(name, &space, &settings)?,
            };
            let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
            let outcome =
                study::run_with(&study, optimizer.as_mut(), &mut evaluator, judge, &mut [], &AtomicBool::new(false))?;
            excess.push(outcome.winner.ok_or("every candidate failed")?.objectives[0] - 641.585_578_346_1);
        }
        excess.sort_by(f64::total_cmp);
        println!("{algorithm:>14}: {:.1e} to {:.1e}", excess[0], excess[9]);
    }
    Ok(())
}
