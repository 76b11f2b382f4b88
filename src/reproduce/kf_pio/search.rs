//! One search on one data set.

use std::sync::atomic::AtomicBool;

use super::super::ReproduceError;
use crate::data::Log;
use crate::evaluate::Evaluator;
use crate::model::Problem;
use crate::optimize::{Optimizer, Settings, pio, pso};
use crate::reference;
use crate::study::{self, Coordinates, Judge, Study};

/// An optimiser with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Method {
    /// Pigeons.
    Pio(pio::Rules),
    /// Particles.
    Pso(pso::Rules),
}

/// What a search found.
#[derive(Debug, Clone)]
pub(super) struct Run {
    /// M11, M12, M21, M22.
    pub(super) factor: Vec<f64>,
    /// J there, by the reference filter: in-sample, against the truth that it was tuned on.
    pub(super) j: f64,
    /// Best J of the search up to each iteration, 0 = the initial population.
    pub(super) best: Vec<f64>,
    /// Candidates scored.
    pub(super) evaluations: u64,
    /// Candidates that failed.
    pub(super) failed: u64,
    /// Time of the search on one thread, in seconds.
    pub(super) seconds: f64,
    /// Largest relative gap between search and reference over the finalists.
    pub(super) gap: f64,
}

impl Run {
    /// First iteration whose best J is within 1e-3 of the final one.
    #[must_use]
    pub(super) fn converged_at(&self) -> f64 {
        let last = self.best.last().copied().unwrap_or(f64::NAN);
        self.best.iter().position(|j| *j <= 1.001 * last).map_or(f64::NAN, |h| h as f64)
    }
}

/// A data set as searches see it.
pub(super) struct Ground<'a> {
    /// Index of the data set, for messages.
    pub(super) data_set: u64,
    pub(super) log: &'a Log,
    pub(super) evaluator: &'a mut dyn Evaluator,
}

/// Runs `method` in the box of `problem`. Which problem it is decides the box alone, so one evaluator serves all.
pub(super) fn run(
    ground: &mut Ground<'_>,
    problem: &Problem,
    method: Method,
    seed: u64,
) -> Result<Run, ReproduceError> {
    let space = Coordinates::new(&problem.parameters, problem.tune.include_start).space();
    let (population, generations) = (problem.tune.population, problem.tune.generations);
    let settings = Settings { population, generations, seed, objectives: 1, evaluations: None };
    space.check()?;
    let mut optimizer: Box<dyn Optimizer> = match method {
        Method::Pio(rules) => Box::new(pio::Pio::new(&space, &settings, rules)),
        Method::Pso(rules) => Box::new(pso::Pso::new(&space, &settings, rules)),
    };
    let log = ground.log;
    let oracle = |candidate: &[f64]| reference::costs(problem, log, candidate).ok();
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let never = AtomicBool::new(false);
    let outcome = study::run_with(&Study::of(problem), optimizer.as_mut(), ground.evaluator, judge, &mut [], &never)?;
    let nothing = || ReproduceError::Nothing { what: outcome.algorithm.to_owned(), data_set: ground.data_set };
    let winner = outcome.winner.as_ref().ok_or_else(nothing)?;
    Ok(Run {
        factor: winner.candidate.clone(),
        j: winner.objectives[0],
        best: outcome.history.iter().map(|row| row.best.unwrap_or(f64::INFINITY)).collect(),
        evaluations: outcome.evaluations,
        failed: outcome.failed,
        seconds: outcome.history.last().map_or(0.0, |row| row.seconds),
        gap: winner.certificate.largest_relative_gap,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converged_at_the_first_iteration_within_a_thousandth() {
        let run = |best: &[f64]| Run {
            factor: Vec::new(),
            j: 0.0,
            best: best.to_vec(),
            evaluations: 0,
            failed: 0,
            seconds: 0.0,
            gap: 0.0,
        };
        assert!(run(&[9.0, 5.0, 1.0011, 1.0009, 1.0]).converged_at().total_cmp(&3.0).is_eq());
        assert!(run(&[1.0, 1.0]).converged_at().total_cmp(&0.0).is_eq());
    }
}
