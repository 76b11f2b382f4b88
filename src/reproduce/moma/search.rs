//! One run of NSGA-II or MOMA on a data set.

use crate::evaluate::Evaluator;
use crate::model::Problem;
use crate::optimize::memetic::{self, annealing};
use crate::optimize::nsga2::{self, Nsga2};
use crate::optimize::{Optimizer, Settings};
use crate::study::Coordinates;

/// Evaluations of a run.
pub(super) const BUDGET: u64 = 500;

/// Candidates of a generation.
pub(super) const POPULATION: usize = 20;

/// Generations that neither method reaches: the budget ends both.
const MANY: usize = 1000;

/// Which optimiser.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    /// NSGA-II.
    Genetic,
    /// NSGA-II with annealing.
    Memetic,
}

/// What a run ends with.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// R of the first individual of the sorted last population: the study's answer.
    pub(super) r: f64,
    /// (f1, f2) of the last population, in its order.
    pub(super) population: Vec<[f64; 2]>,
    /// Evaluations spent.
    pub(super) evaluations: u64,
    /// Generations after the initial one.
    pub(super) generations: usize,
}

/// Runs `method` with the operators of `genetic` until the budget ends it.
pub(super) fn run(
    problem: &Problem,
    evaluator: &mut dyn Evaluator,
    method: Method,
    genetic: nsga2::Rules,
    seed: u64,
) -> Found {
    let coordinates = Coordinates::new(&problem.parameters, false);
    let space = coordinates.space();
    let settings =
        Settings { population: POPULATION, generations: MANY, seed, objectives: 2, evaluations: Some(BUDGET) };
    match method {
        Method::Genetic => {
            let mut optimizer = Nsga2::new(&space, &settings, genetic);
            let spent = drive(&coordinates, evaluator, &mut optimizer);
            found(&coordinates, &optimizer, spent)
        }
        Method::Memetic => {
            let mut optimizer = memetic::moma(&space, &settings, memetic::MOMA, genetic, annealing::PRINTED);
            let spent = drive(&coordinates, evaluator, &mut optimizer);
            found(&coordinates, optimizer.inner(), spent)
        }
    }
}

/// Asks, scores and tells while the next population fits in the budget. Gives evaluations and generations.
fn drive(coordinates: &Coordinates, evaluator: &mut dyn Evaluator, optimizer: &mut dyn Optimizer) -> (u64, usize) {
    let (mut evaluations, mut finished) = (0, 0_usize);
    while let Some(positions) = optimizer.ask() {
        let after = evaluations + positions.len() as u64;
        if after > BUDGET {
            break;
        }
        let costs = evaluator.evaluate(&coordinates.candidates(&positions));
        optimizer.tell(&positions, &costs);
        evaluations = after;
        finished += usize::from(optimizer.generation_finished());
    }
    (evaluations, finished.saturating_sub(1))
}

fn found(coordinates: &Coordinates, optimizer: &Nsga2, spent: (u64, usize)) -> Found {
    let (evaluations, generations) = spent;
    let candidates = coordinates.candidates(optimizer.population());
    let scores = optimizer.scores();
    let population = (0..scores.len()).map(|i| [scores.costs(i)[0], scores.costs(i)[1]]).collect();
    Found { r: candidates.row(0)[0], population, evaluations, generations }
}
