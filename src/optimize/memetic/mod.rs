//! Memetic search: a population that hands its best to a local search every few generations.

pub mod annealing;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::pareto::{Ranking, Scores};
use super::saved::{self, Reader};
use super::{Optimizer, RestoreError, Settings, Space, nsga2};
use crate::population::{Evaluation, Population, Status};
use annealing::Annealing;

/// A candidate with what it scored.
#[derive(Debug, Clone, PartialEq)]
pub struct Individual {
    /// Its position, in search coordinates.
    pub x: Vec<f64>,
    /// Its costs, one an objective.
    pub costs: Vec<f64>,
    /// How far it is from satisfying the constraints; infinite if it failed.
    pub violation: f64,
}

/// Improves a few individuals, all in step: every population it asks for holds proposals for each of them.
///
/// It keeps nothing from one search to the next, and its draws depend on the generation and the individual's place alone.
pub trait LocalSearch {
    /// Evaluations that one search spends on one individual.
    fn evaluations(&self) -> usize;

    /// Begins a search from these, in this generation.
    fn begin(&mut self, individuals: Vec<Individual>, generation: usize);

    /// The next proposals, or `None` at the end of the search.
    fn ask(&mut self) -> Option<Population>;

    /// Costs of exactly the population that [`Self::ask`] gave last.
    fn tell(&mut self, population: &Population, costs: &Evaluation);

    /// What the search made of the individuals, in their order.
    fn finish(&mut self) -> Vec<Individual>;
}

/// When local search is due, and for whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rules {
    /// Name in the registry.
    pub name: &'static str,
    /// The best of every this many are improved; at least one.
    pub one_in: usize,
    /// In generations 0, `every`, 2 `every`, ...
    pub every: usize,
    /// Whether a generation with local search reaches the population method sorted by rank, then crowding distance, as
    /// in the MOMA study; a method that knows its candidates by their place, a swarm, needs them left there.
    pub sorted: bool,
}

/// `moma`: the best tenth, in every fifth generation.
///
/// H. Huo, Z. Cai, M. Liu, M. Gong, "The parameter optimization of Kalman filter based on multi-objective memetic
/// algorithm", GECCO 2014, doi 10.1145/2576768.2598242.
pub const MOMA: Rules = Rules { name: "moma", one_in: 10, every: 5, sorted: true };

/// `moma-annealed`: the same with [`annealing::ACTING`].
pub const MOMA_ANNEALED: Rules = Rules { name: "moma-annealed", ..MOMA };

/// A population method whose generations may have a second part.
///
/// The first part is the population that `inner` asks for. Where local search is due, the best of that population by
/// (rank, crowding distance, index) **among each other** are improved, in as many further parts as the search takes
/// ([`Optimizer::generation_finished`] is `false` before the last); then `inner` is told of the population with the
/// improved in the places of the original ones (Lamarck). Every proposal is an evaluation. A search starts only if all of
/// it fits in [`Settings::evaluations`].
///
/// ```
/// use kfgpu::optimize::memetic::annealing::{ACTING, Annealing};
/// use kfgpu::optimize::memetic::{Memetic, Rules};
/// use kfgpu::optimize::pso::{CONSTRICTION, Pso};
/// use kfgpu::optimize::{Optimizer, Settings, Space};
/// let space = Space::boxed(&[[0.0, 1.0]; 3]);
/// let settings = Settings { population: 20, generations: 10, seed: 1, objectives: 1, evaluations: None };
/// let rules = Rules { name: "memetic-pso", one_in: 10, every: 5, sorted: false };
/// let swarm = Pso::new(&space, &settings, CONSTRICTION);
/// let mut search = Memetic::new(swarm, Annealing::new(&space, settings.seed, ACTING), &settings, rules);
/// assert_eq!(search.ask().map(|population| population.len()), Some(20));
/// ```
#[derive(Debug, Clone)]
pub struct Memetic<O, L> {
    inner: O,
    local: L,
    rules: Rules,
    settings: Settings,
    generation: usize,
    sent: u64,
    search: Option<Search>,
}

/// A local search under way.
#[derive(Debug, Clone)]
struct Search {
    /// The generation it started from.
    population: Population,
    scores: Scores,
    status: Vec<Status>,
    /// The generation by (rank, crowding distance, index).
    order: Vec<usize>,
    /// Number of leading candidates of `order` that are searched.
    chosen: usize,
    /// Proposals to be scored next.
    proposals: Population,
}

/// MOMA: [`nsga2::STUDY`] with a local search by annealing, as `rules` and `annealing` say.
#[must_use]
pub fn moma(
    space: &Space,
    settings: &Settings,
    rules: Rules,
    genetic: nsga2::Rules,
    annealing: annealing::Rules,
) -> Memetic<nsga2::Nsga2, Annealing> {
    let inner = nsga2::Nsga2::new(space, settings, genetic);
    Memetic::new(inner, Annealing::new(space, settings.seed, annealing), settings, rules)
}

impl<O: Optimizer, L: LocalSearch> Memetic<O, L> {
    /// At generation 0 of `inner`, which was built from the same `settings`.
    pub const fn new(inner: O, local: L, settings: &Settings, rules: Rules) -> Self {
        Self { inner, local, rules, settings: *settings, generation: 0, sent: 0, search: None }
    }

    /// The population method.
    pub const fn inner(&self) -> &O {
        &self.inner
    }

    /// Candidates of this generation that are to be improved: none where no search is due, or none fits in the
    /// evaluations allowed.
    fn chosen(&self, population: usize) -> usize {
        let chosen = (population / self.rules.one_in.max(1)).max(1).min(population);
        let due = self.generation.is_multiple_of(self.rules.every.max(1));
        let all = (chosen as u64).saturating_mul(self.local.evaluations() as u64);
        let fits = self.settings.evaluations.is_none_or(|allowed| self.sent.saturating_add(all) <= allowed);
        if due && fits { chosen } else { 0 }
    }

    /// Starts a search from the best of a generation, if one is due.
    fn begin(&mut self, population: &Population, costs: &Evaluation) -> bool {
        let chosen = self.chosen(population.len());
        if chosen == 0 {
            return false;
        }
        let scores = Scores::from(costs);
        let order = Ranking::of(&scores).order();
        let individual = |i: &usize| Individual {
            x: population.row(*i).to_vec(),
            costs: scores.costs(*i).to_vec(),
            violation: scores.violation(*i),
        };
        self.local.begin(order[..chosen].iter().map(individual).collect(), self.generation);
        let Some(proposals) = self.local.ask() else { return false };
        let status = (0..costs.len()).map(|i| costs.status(i)).collect();
        self.search = Some(Search { population: population.clone(), scores, status, order, chosen, proposals });
        true
    }

    /// Passes a generation on to the population method.
    fn pass(&mut self, population: &Population, costs: &Evaluation) {
        self.inner.tell(population, costs);
        self.generation += 1;
    }
}

impl Search {
    /// The generation with the improved individuals in their places, in its own order or sorted as it was before.
    fn improved(mut self, individuals: &[Individual], sorted: bool) -> (Population, Evaluation) {
        for (i, individual) in self.order[..self.chosen].iter().zip(individuals) {
            self.population.row_mut(*i).copy_from_slice(&individual.x);
            self.scores.replace(*i, &individual.costs, individual.violation);
            if individual.violation.is_finite() {
                self.status[*i] = Status::OK;
            }
        }
        let order = if sorted { self.order } else { (0..self.population.len()).collect() };
        let mut population = Population::new(self.population.dimension());
        let (mut costs, mut status, mut violation) = (Vec::new(), Vec::new(), Vec::new());
        for i in order {
            population.push(self.population.row(i));
            costs.extend_from_slice(self.scores.costs(i));
            status.push(self.status[i]);
            violation.push(self.scores.violation(i));
        }
        (population, Evaluation::new(self.scores.objectives(), costs, status).with_violation(violation))
    }
}

impl<O: Optimizer, L: LocalSearch> Optimizer for Memetic<O, L> {
    fn name(&self) -> &'static str {
        self.rules.name
    }

    fn ask(&mut self) -> Option<Population> {
        match &self.search {
            Some(search) => Some(search.proposals.clone()),
            None => self.inner.ask(),
        }
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        self.sent += population.len() as u64;
        let Some(mut search) = self.search.take() else {
            if !self.begin(population, costs) {
                self.pass(population, costs);
            }
            return;
        };
        self.local.tell(population, costs);
        if let Some(proposals) = self.local.ask() {
            search.proposals = proposals;
            self.search = Some(search);
        } else {
            let (population, costs) = search.improved(&self.local.finish(), self.rules.sorted);
            self.pass(&population, &costs);
        }
    }

    fn generation_finished(&self) -> bool {
        self.search.is_none()
    }

    /// Between generations only; within one there is nothing to resume from.
    fn save(&self) -> Option<Vec<u8>> {
        let inner = if self.search.is_none() { self.inner.save() } else { None };
        saved::write(&Saved { generation: self.generation, sent: self.sent, inner: inner? })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), RestoreError> {
        let reader = Reader { algorithm: self.name(), dimension: 0 };
        let Saved { generation, sent, inner } = reader.read(saved)?;
        let generation = reader.told(generation, self.settings.generations)?;
        self.inner.restore(&inner).map_err(|error| RestoreError { algorithm: self.rules.name, ..error })?;
        (self.generation, self.sent, self.search) = (generation, sent, None);
        Ok(())
    }
}

/// What the wrapper itself remembers between generations.
#[derive(Serialize, Deserialize)]
struct Saved {
    generation: usize,
    sent: u64,
    inner: Vec<u8>,
}
