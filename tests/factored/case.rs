//! Problems as text, with the logs and candidates that the tests run.

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Population, Precision};
use kfgpu::filter::{Form, Program};
use kfgpu::model::{Problem, Scale};
use kfgpu::random::{Purpose, Stream};
use kfgpu::simulate::simulate;
use std::path::Path;

pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) problem: Problem,
    pub(crate) log: Log,
    pub(crate) population: Population,
}

impl Case {
    /// From a problem file's text, over the log that it simulates.
    #[track_caller]
    pub(crate) fn simulated(name: &str, text: &str) -> Self {
        let problem = Problem::parse(text, name).unwrap_or_else(|error| panic!("{error}"));
        let log = simulate(&problem, None).unwrap_or_else(|error| panic!("{name}: {error}"));
        Self::new(name, problem, log)
    }

    pub(crate) fn example(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(format!("{name}.toml"));
        let problem = Problem::open(&path).unwrap_or_else(|error| panic!("{error}"));
        let log = match &problem.data.file {
            Some(_) => Log::open(&problem.data, path.parent().unwrap()).unwrap(),
            None => simulate(&problem, None).unwrap(),
        };
        Self::new(name, problem, log)
    }

    fn new(name: &str, problem: Problem, log: Log) -> Self {
        let population = population(&problem, 33);
        Self { name: name.to_owned(), problem, log, population }
    }

    /// The same with intervals between 0.7 and 1.3 of what they were (rows keep their measurements).
    pub(crate) fn irregular(mut self) -> Self {
        self.name += ", irregular dt";
        for trajectory in &mut self.log.trajectories {
            let step = trajectory.dt(0).unwrap_or(1.0);
            let shift = |k: usize| 0.15 * step * (1.7 * k as f64).sin();
            trajectory.time.iter_mut().enumerate().for_each(|(k, t)| *t += shift(k));
        }
        self
    }

    pub(crate) fn evaluator(&self, precision: Precision, form: Option<Form>) -> CpuEvaluator {
        let options = CpuOptions { precision, threads: std::num::NonZero::new(1) };
        CpuEvaluator::with_form(&self.problem, &self.log, &self.problem.tune.objectives, options, form)
            .unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    pub(crate) fn evaluate(&self, precision: Precision, form: Form) -> Evaluation {
        self.evaluator(precision, Some(form)).evaluate(&self.population)
    }

    pub(crate) fn program(&self, precision: Precision, form: Option<Form>) -> Program {
        self.evaluator(precision, form).program().clone()
    }
}

/// Candidates spread over the search ranges; the first is the baseline.
fn population(problem: &Problem, n: u64) -> Population {
    let mut population = Population::new(problem.parameters.dimension());
    population.push(&problem.parameters.baseline());
    for i in 1..n {
        let mut stream = Stream::new(1, Purpose::Workload, 0, i);
        let mut draw = |search: &kfgpu::model::Search| {
            let (u, [low, high]) = (stream.uniform(), search.init);
            match search.scale {
                Scale::Linear => low + u * (high - low),
                Scale::Log => (low.ln() + u * (high.ln() - low.ln())).exp(),
            }
        };
        let candidate: Vec<f64> = problem.parameters.searched().map(|(_, search)| draw(search)).collect();
        population.push(&candidate);
    }
    population
}
