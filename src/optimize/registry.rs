//! The list of optimisers: one row each.

use super::memetic::{self, annealing};
use super::{Optimizer, Space, nsga2, pio, pso, random_search};

/// What every optimiser is built from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Candidates a generation.
    pub population: usize,
    /// Generations after the initial one.
    pub generations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Number of objectives of the evaluator.
    pub objectives: usize,
    /// Evaluations allowed, for methods whose generations differ in size; the study itself stops any method in time.
    pub evaluations: Option<u64>,
}

/// One row of [`ALGORITHMS`].
#[derive(Debug)]
pub struct Algorithm {
    /// Name in problem files.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Its constants and where they come from.
    pub defaults: &'static str,
    /// Smallest population it works with.
    pub minimum_population: usize,
    /// Why it needs that many.
    pub minimum_reason: &'static str,
    /// How many objectives it can minimise at once.
    pub maximum_objectives: usize,
    build: fn(&Space, &Settings) -> Box<dyn Optimizer>,
}

/// Every optimiser that a problem file can name.
pub static ALGORITHMS: &[Algorithm] = &[
    Algorithm {
        name: "pso",
        about: "particle swarm with constriction",
        defaults: "w = 0.7298, c1 = c2 = 1.49618 (doi 10.1109/4235.985692)",
        minimum_population: 2,
        minimum_reason: "a particle learns from the best of the others",
        maximum_objectives: 1,
        build: |space, settings| Box::new(pso::Pso::new(space, settings, pso::CONSTRICTION)),
    },
    Algorithm {
        name: "pso-inertia",
        about: "particle swarm with falling inertia",
        defaults: "w from 0.9 to 0.4 over the run, c1 = c2 = 2 (doi 10.1109/CEC.1999.785511)",
        minimum_population: 2,
        minimum_reason: "a particle learns from the best of the others",
        maximum_objectives: 1,
        build: |space, settings| Box::new(pso::Pso::new(space, settings, pso::INERTIA)),
    },
    Algorithm {
        name: "pio",
        about: "pigeon-inspired optimisation as published, moving by the new velocity V(t)",
        defaults: "r = 0.2; 2/3 of the generations map and compass, 1/3 landmark (doi 10.1108/IJICC-02-2014-0005)",
        minimum_population: 2,
        minimum_reason: "its landmark phase halves the flock",
        maximum_objectives: 1,
        build: |space, settings| Box::new(pio::Pio::new(space, settings, pio::PUBLISHED)),
    },
    Algorithm {
        name: "pio-printed",
        about: "pigeon-inspired optimisation by the printed equations: V(t-1) and landmark weights equal to the cost",
        defaults: "r = 0.2; phases as pio",
        minimum_population: 2,
        minimum_reason: "its landmark phase halves the flock",
        maximum_objectives: 1,
        build: |space, settings| Box::new(pio::Pio::new(space, settings, pio::PRINTED)),
    },
    Algorithm {
        name: "pio+",
        about: "pigeon-inspired optimisation with slow damping, a draw per coordinate and the whole flock kept",
        defaults: "r = 0.01; phases as pio",
        minimum_population: 2,
        minimum_reason: "its landmark phase averages the better half of the flock",
        maximum_objectives: 1,
        build: |space, settings| Box::new(pio::Pio::new(space, settings, pio::PLUS)),
    },
    Algorithm {
        name: "nsga2",
        about: "NSGA-II: a Pareto front of up to four objectives; with one, a plain genetic algorithm",
        defaults: "p_c = 0.9, p_m = 1/d, eta_c = eta_m = 20, copies mutated again (doi 10.1109/4235.996017)",
        minimum_population: 2,
        minimum_reason: "children have two parents",
        maximum_objectives: 4,
        build: |space, settings| Box::new(nsga2::Nsga2::new(space, settings, nsga2::PUBLISHED)),
    },
    Algorithm {
        name: "nsga2-study",
        about: "NSGA-II with the operators of the MOMA study",
        defaults: "as nsga2, with copies; unbounded crossover of every coordinate, simple mutation, tournaments with replacement \
                   (doi 10.1145/2576768.2598242)",
        minimum_population: 2,
        minimum_reason: "children have two parents",
        maximum_objectives: 4,
        build: |space, settings| Box::new(nsga2::Nsga2::new(space, settings, nsga2::STUDY)),
    },
    Algorithm {
        name: "moma",
        about: "nsga2-study with a local search from its best, by simulated annealing as printed in the MOMA study",
        defaults: "the best tenth every fifth generation; 8 proposals from T = 1e6, ratio 0.9, steps of 5 % of the range \
                   (doi 10.1145/2576768.2598242)",
        minimum_population: 2,
        minimum_reason: "children have two parents",
        maximum_objectives: 4,
        build: |space, settings| {
            Box::new(memetic::moma(space, settings, memetic::MOMA, nsga2::STUDY, annealing::PRINTED))
        },
    },
    Algorithm {
        name: "moma-annealed",
        about: "moma with a temperature that acts, in units of the cost differences seen",
        defaults: "as moma; T from 1 to 0.05",
        minimum_population: 2,
        minimum_reason: "children have two parents",
        maximum_objectives: 4,
        build: |space, settings| {
            Box::new(memetic::moma(space, settings, memetic::MOMA_ANNEALED, nsga2::STUDY, annealing::ACTING))
        },
    },
    Algorithm {
        name: "random",
        about: "uniform random search, the baseline that any other method must beat",
        defaults: "uniform over the box, or over init where a parameter is unbounded",
        minimum_population: 1,
        minimum_reason: "a generation is at least one candidate",
        maximum_objectives: usize::MAX,
        build: |space, settings| Box::new(random_search::RandomSearch::new(space, settings)),
    },
];

/// Why an optimiser could not be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OptimizeError {
    /// No such name.
    #[error("unknown algorithm {name:?}{}: expected one of {}", nearest.map(|n| format!(" (did you mean {n:?}?)")).unwrap_or_default(), names())]
    UnknownAlgorithm {
        /// The name received.
        name: String,
        /// The known name nearest to it, where one is near.
        nearest: Option<&'static str>,
    },
    /// The population is below the method's minimum.
    #[error("algorithm {algorithm:?} needs a population of at least {minimum}, received {population}: {reason}")]
    PopulationTooSmall {
        /// The method.
        algorithm: &'static str,
        /// Population received.
        population: usize,
        /// Smallest that works.
        minimum: usize,
        /// Why.
        reason: &'static str,
    },
    /// The method cannot minimise that many objectives.
    #[error(
        "algorithm {algorithm:?} minimises {}, received {objectives}: keep {maximum} in [tune] objectives{}",
        if *maximum == 1 { "one objective".to_owned() } else { format!("at most {maximum} objectives") },
        for_several(*objectives)
    )]
    TooManyObjectives {
        /// The method.
        algorithm: &'static str,
        /// Objectives received.
        objectives: usize,
        /// Objectives it can minimise.
        maximum: usize,
    },
    /// The search space is not a box.
    #[error("search coordinate {coordinate}: {problem}")]
    Space {
        /// Which coordinate.
        coordinate: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
}

/// The method to name to whoever asks for a front of this many objectives.
fn for_several(objectives: usize) -> String {
    let front = ALGORITHMS.iter().find(|row| row.maximum_objectives > 1 && row.maximum_objectives >= objectives);
    front.filter(|row| row.name != "random").map_or_else(String::new, |row| {
        format!(
            ", or set [tune] algorithm = {0:?} (--algorithm {0}), which finds a Pareto front of up to {1}",
            row.name, row.maximum_objectives
        )
    })
}

fn names() -> String {
    ALGORITHMS.iter().map(|a| a.name).collect::<Vec<_>>().join(", ")
}

/// The row of a name.
///
/// # Errors
/// [`OptimizeError::UnknownAlgorithm`] with the nearest known name.
pub fn algorithm(name: &str) -> Result<&'static Algorithm, OptimizeError> {
    let nearest = || {
        let distance = |a: &&Algorithm| strsim::damerau_levenshtein(a.name, name);
        ALGORITHMS.iter().min_by_key(distance).filter(|a| distance(a) <= 3).map(|a| a.name)
    };
    ALGORITHMS
        .iter()
        .find(|a| a.name == name)
        .ok_or_else(|| OptimizeError::UnknownAlgorithm { name: name.to_owned(), nearest: nearest() })
}

/// Builds the optimiser called `name`.
///
/// # Errors
/// If the name is unknown, the population too small, the objectives too many or the space is not a box.
pub fn build(name: &str, space: &Space, settings: &Settings) -> Result<Box<dyn Optimizer>, OptimizeError> {
    let row = algorithm(name)?;
    if settings.population < row.minimum_population {
        return Err(OptimizeError::PopulationTooSmall {
            algorithm: row.name,
            population: settings.population,
            minimum: row.minimum_population,
            reason: row.minimum_reason,
        });
    }
    if settings.objectives > row.maximum_objectives {
        return Err(OptimizeError::TooManyObjectives {
            algorithm: row.name,
            objectives: settings.objectives,
            maximum: row.maximum_objectives,
        });
    }
    space.check()?;
    Ok((row.build)(space, settings))
}
