//! Simulated annealing of single individuals, for one objective or several.

use rand_distr::{Distribution, StandardNormal};

use super::{Individual, LocalSearch};
use crate::optimize::Space;
use crate::optimize::operators::Range;
use crate::optimize::pareto::dominates;
use crate::population::{Evaluation, Population};
use crate::random::{Purpose, Stream};

/// Which proposals are taken. df_j is what cost j of the proposal is above that of the current state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acceptance {
    /// As printed in the MOMA study: if df_1 < 0, and either every other df_j < 0 too or rand < exp(-rise/T) with rise
    /// the sum of the positive df_j. The first cost must fall, whatever T is.
    FirstFalls,
    /// If rand < exp(-rise/T), where rise is the sum of the positive df_j, **each divided by the mean |df_j| that this
    /// search has seen so far**. T is a pure number: at T = 1 one typical rise is accepted with probability 1/e.
    Scaled,
}

/// What differs between the variants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Which proposals are taken.
    pub acceptance: Acceptance,
    /// Most proposals for an individual.
    pub proposals: usize,
    /// Standard deviation of a step, as a share of each coordinate's width.
    pub step: f64,
    /// T of the first proposal.
    pub temperature: f64,
    /// What T is multiplied by after each proposal.
    pub ratio: f64,
    /// The search ends once T is not above this.
    pub coldest: f64,
}

/// As printed: T = 1e6, 9e5, ... 4.8e5 over eight proposals, so far above any df that it never decides anything: what is
/// accepted is whatever lowers the first objective.
///
/// Algorithm 4 of H. Huo et al., GECCO 2014, doi 10.1145/2576768.2598242; the size of a step is not given there.
pub const PRINTED: Rules =
    Rules { acceptance: Acceptance::FirstFalls, proposals: 8, step: 0.05, temperature: 1e6, ratio: 0.9, coldest: 10.0 };

/// A temperature that acts: eight proposals from T = 1 to 0.05 in units of the differences seen, so that early ones may
/// make a cost worse and the last ones hardly can.
///
/// The criterion is that of N. Metropolis et al., J. Chem. Phys. 21 (1953), doi 10.1063/1.1699114, on the sum of the
/// scaled rises.
pub const ACTING: Rules = Rules {
    acceptance: Acceptance::Scaled,
    temperature: 1.0,
    // 0.05^(1/7): seven coolings lie between eight proposals.
    ratio: 0.651_836_344_868_839_1,
    coldest: 0.0,
    ..PRINTED
};

/// Steps x' = clip(x + step width n), n ~ N(0, 1) for each coordinate, for all individuals in step.
///
/// A proposal nearer to satisfying the constraints is always accepted, one further away never. An individual becomes the
/// last accepted state that neither the individual itself nor the state kept before it dominates.
#[derive(Debug, Clone)]
pub struct Annealing {
    space: Space,
    ranges: Vec<Range>,
    seed: u64,
    rules: Rules,
    generation: usize,
    proposed: usize,
    temperature: f64,
    walks: Vec<Walk>,
    differences: Vec<Mean>,
}

/// One individual's search.
#[derive(Debug, Clone)]
struct Walk {
    start: Individual,
    current: Individual,
    kept: Individual,
    /// rand of the proposal that is being scored.
    rand: f64,
}

/// Mean |df| of one objective.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Annealing {
    /// Of individuals in `space`.
    #[must_use]
    pub fn new(space: &Space, seed: u64, rules: Rules) -> Self {
        Self {
            space: space.clone(),
            ranges: Range::of(space),
            seed,
            rules,
            generation: 0,
            proposed: 0,
            temperature: rules.temperature,
            walks: Vec::new(),
            differences: Vec::new(),
        }
    }

    /// Learns how large differences are, from proposals and states that both satisfy the constraints.
    fn observe(&mut self, costs: &Evaluation) {
        for (i, walk) in self.walks.iter().enumerate() {
            if walk.current.violation > 0.0 || costs.violation(i) > 0.0 {
                continue;
            }
            let pairs = costs.costs(i).iter().zip(&walk.current.costs);
            for (mean, (new, old)) in self.differences.iter_mut().zip(pairs) {
                mean.sum += (new - old).abs();
                mean.count += 1.0;
            }
        }
    }

    /// Whether a walk takes its proposal.
    fn accepts(&self, walk: &Walk, proposal: &Individual) -> bool {
        if proposal.violation.total_cmp(&walk.current.violation).is_ne() {
            return proposal.violation < walk.current.violation;
        }
        let df = || proposal.costs.iter().zip(&walk.current.costs).map(|(new, old)| new - old);
        match self.rules.acceptance {
            Acceptance::FirstFalls => {
                let rise: f64 = df().skip(1).map(|df| df.max(0.0)).sum();
                df().next().is_some_and(|first| first < 0.0) && walk.rand < (-rise / self.temperature).exp()
            }
            Acceptance::Scaled => {
                let scaled = df().zip(&self.differences).filter(|(df, _)| *df > 0.0);
                let rise: f64 = scaled.map(|(df, mean)| df * mean.count / mean.sum).sum();
                walk.rand < (-rise / self.temperature).exp()
            }
        }
    }
}

impl LocalSearch for Annealing {
    fn evaluations(&self) -> usize {
        let warm = |temperature: &f64| *temperature > self.rules.coldest;
        let temperatures = std::iter::successors(Some(self.rules.temperature), |t| Some(t * self.rules.ratio));
        temperatures.take(self.rules.proposals).take_while(warm).count()
    }

    fn begin(&mut self, individuals: Vec<Individual>, generation: usize) {
        let objectives = individuals.first().map_or(0, |individual| individual.costs.len());
        let walk = |start: Individual| Walk { current: start.clone(), kept: start.clone(), start, rand: 0.0 };
        self.walks = individuals.into_iter().map(walk).collect();
        self.differences = vec![Mean::default(); objectives];
        (self.generation, self.proposed, self.temperature) = (generation, 0, self.rules.temperature);
    }

    fn ask(&mut self) -> Option<Population> {
        if self.walks.is_empty() || self.proposed == self.evaluations() {
            return None;
        }
        let mut proposals = Population::new(self.space.dimension());
        let places = self.walks.len();
        for (place, walk) in self.walks.iter_mut().enumerate() {
            let index = (self.proposed * places + place) as u64;
            let mut stream = Stream::new(self.seed, Purpose::LocalSearch, self.generation as u64, index);
            let mut x = walk.current.x.clone();
            for (x, range) in x.iter_mut().zip(&self.ranges) {
                let normal: f64 = StandardNormal.sample(&mut stream);
                *x += self.rules.step * range.width * normal;
            }
            self.space.clip(&mut x);
            walk.rand = stream.uniform();
            proposals.push(&x);
        }
        Some(proposals)
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        self.observe(costs);
        for i in 0..self.walks.len() {
            let (x, costs, violation) = (population.row(i).to_vec(), costs.costs(i).to_vec(), costs.violation(i));
            let proposal = Individual { x, costs, violation };
            if self.accepts(&self.walks[i], &proposal) {
                self.walks[i].take(proposal);
            }
        }
        self.proposed += 1;
        self.temperature *= self.rules.ratio;
    }

    fn finish(&mut self) -> Vec<Individual> {
        std::mem::take(&mut self.walks).into_iter().map(|walk| walk.kept).collect()
    }
}

impl Walk {
    fn take(&mut self, proposal: Individual) {
        if !self.start.better(&proposal) && !self.kept.better(&proposal) {
            self.kept.clone_from(&proposal);
        }
        self.current = proposal;
    }
}

impl Individual {
    /// Constrained domination, as [`crate::optimize::pareto::Scores::better`].
    fn better(&self, other: &Self) -> bool {
        if self.violation > 0.0 || other.violation > 0.0 {
            self.violation < other.violation
        } else {
            dominates(&self.costs, &other.costs)
        }
    }
}
