//! Models x objectives x log shapes.

use kfgpu::data::{Log, simulate};
use kfgpu::evaluate::Population;
use kfgpu::model::{Parameters, Problem};
use kfgpu::optimize::random::{Purpose, Stream};
use std::path::Path;

/// A problem with its log and candidates.
pub struct Case {
    pub name: String,
    pub problem: Problem,
    pub log: Log,
    pub population: Population,
    /// Whether single precision is promised for it (P0/R within the covariance form's reach).
    pub single: bool,
}

/// 257 candidates (not a multiple of any block) spread over the search ranges.
fn population(parameters: &Parameters) -> Population {
    let mut population = Population::new(parameters.dimension());
    for i in 0..257 {
        let mut stream = Stream::new(1, Purpose::Workload, 0, i);
        let candidate: Vec<f64> = parameters
            .searched()
            .map(|(_, s)| {
                let u = stream.uniform();
                let [low, high] = s.init;
                match s.scale {
                    kfgpu::model::Scale::Linear => low + u * (high - low),
                    kfgpu::model::Scale::Log => (low.ln() + u * (high.ln() - low.ln())).exp(),
                }
            })
            .collect();
        population.push(&candidate);
    }
    population
}

fn example(name: &str) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(format!("{name}.toml"));
    let problem = Problem::open(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
    let log = match &problem.data.file {
        Some(_) => Log::open(&problem.data, path.parent().unwrap()).unwrap(),
        None => simulate(&problem, None).unwrap(),
    };
    let population = population(&problem.parameters);
    Case { name: name.to_owned(), problem, log, population, single: true }
}

pub fn cases() -> Vec<Case> {
    ["nile", "rocket", "refuelling", "robot", "uav_gps_cv", "uav_gps_ca", "tum_fr2_desk"]
        .map(example)
        .into_iter()
        .collect()
}
