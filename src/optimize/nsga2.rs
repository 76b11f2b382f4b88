//! NSGA-II: a genetic algorithm for several objectives.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hasher};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::operators::{Crossover, Mutation, Range};
use super::pareto::{Ranking, Scores};
use super::saved::{self, Reader};
use super::{Optimizer, RestoreError, Settings, Space, swarm};
use crate::population::{Evaluation, Population};
use crate::random::{Purpose, Stream};

/// Pairs that are worth a task of their own.
const PAIRS_A_TASK: usize = 256;

/// How often a child that is there already is mutated at most. One mutation changes nothing in up to 2 of 3 cases.
const ATTEMPTS: usize = 20;

/// How the parents of a generation are chosen; both by binary tournaments of lower rank, then larger crowding distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Selection {
    /// The population in two random orders, neighbours against each other, so that everyone takes part twice; a coin
    /// decides a full tie.
    Shuffled,
    /// Two candidates drawn independently with replacement; the second wins a full tie.
    Independent,
}

/// What the survivors are chosen from, beside the offspring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Merge {
    /// The whole population: no elite is lost.
    Population,
    /// The parents that selection chose, which may leave an elite out and hold another twice.
    Parents,
}

/// What differs between the variants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Name in the registry.
    pub name: &'static str,
    /// How parents are chosen.
    pub selection: Selection,
    /// p_c, the probability that a pair is crossed.
    pub crossover_probability: f64,
    /// eta_c of simulated binary crossover.
    pub crossover_index: f64,
    /// p_m, the probability that a coordinate mutates; `None` = 1/d.
    pub mutation_probability: Option<f64>,
    /// eta_m of polynomial mutation.
    pub mutation_index: f64,
    /// Whether crossover and mutation know the bounds, as in Deb's program, or are clipped to them.
    pub bounded: bool,
    /// What competes with the offspring.
    pub merge: Merge,
    /// Whether a child that equals a member of the population, or an earlier child, in every coordinate is mutated until
    /// it does not. Copies take places in the population that carry nothing, and crowd each other out.
    pub distinct: bool,
}

/// `nsga2`: p_c = 0.9, p_m = 1/d, eta_c = eta_m = 20, and no copies among the offspring.
///
/// K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, IEEE Trans. Evol. Comput. 6 (2002), doi 10.1109/4235.996017.
pub const PUBLISHED: Rules = Rules {
    name: "nsga2",
    selection: Selection::Shuffled,
    crossover_probability: 0.9,
    crossover_index: 20.0,
    mutation_probability: None,
    mutation_index: 20.0,
    bounded: true,
    merge: Merge::Population,
    distinct: true,
};

/// `nsga2-study`: the operators of the MOMA study, which has unbounded crossover of every coordinate, simple mutation,
/// and tournaments with replacement.
///
/// H. Huo, Z. Cai, M. Liu, M. Gong, GECCO 2014, doi 10.1145/2576768.2598242, as far as it says.
pub const STUDY: Rules =
    Rules { name: "nsga2-study", selection: Selection::Independent, bounded: false, distinct: false, ..PUBLISHED };

/// A population that keeps its best by (front, crowding distance).
///
/// One generation: N tournaments choose the parents; in the order chosen they are paired (an odd one with the first),
/// crossed with probability p_c and mutated; the offspring are all first children, then all second children; population
/// and offspring are merged in this order, sorted by (rank, crowding distance, index), and the first N survive **with the
/// rank and crowding distance they have in the merged set**. Infeasible and failed candidates rank behind
/// ([`super::pareto::fronts`]). The initial population counts as generation 0.
///
/// Where children are to be [`Rules::distinct`], they are compared and mutated in this order, before they are scored.
///
/// One random stream serves each pair and each tournament, so the result depends on the seed alone.
#[derive(Debug, Clone)]
pub struct Nsga2 {
    settings: Settings,
    rules: Rules,
    ranges: Vec<Range>,
    generation: usize,
    x: Population,
    scores: Scores,
    ranking: Ranking,
    parents: Vec<usize>,
}

/// What a population has learnt; positions row after row.
#[derive(Serialize, Deserialize)]
struct Saved {
    generation: usize,
    x: Vec<f64>,
    scores: Scores,
    ranking: Ranking,
}

impl Nsga2 {
    /// At generation 0.
    #[must_use]
    pub fn new(space: &Space, settings: &Settings, rules: Rules) -> Self {
        Self {
            settings: *settings,
            rules,
            ranges: Range::of(space),
            generation: 0,
            x: swarm::first(space, settings.population, settings.seed),
            scores: Scores::new(settings.objectives),
            ranking: Ranking::default(),
            parents: Vec::new(),
        }
    }

    /// The population after the last [`Optimizer::tell`]: from generation 1 on sorted by rank, then crowding distance.
    #[must_use]
    pub const fn population(&self) -> &Population {
        &self.x
    }

    /// Costs and violations of [`Self::population`].
    #[must_use]
    pub const fn scores(&self) -> &Scores {
        &self.scores
    }

    /// Ranks and crowding distances of [`Self::population`], as survival saw them.
    #[must_use]
    pub const fn ranking(&self) -> &Ranking {
        &self.ranking
    }

    const fn stream(&self, purpose: Purpose, index: usize) -> Stream {
        Stream::new(self.settings.seed, purpose, self.generation as u64, index as u64)
    }

    /// Winners of `count` tournaments.
    fn select(&self, count: usize) -> Vec<usize> {
        let n = self.x.len();
        match self.rules.selection {
            Selection::Independent => (0..count)
                .map(|k| {
                    let mut stream = self.stream(Purpose::Selection, k);
                    let (first, second) = (stream.below(n), stream.below(n));
                    if self.ranking.compare(first, second).is_lt() { first } else { second }
                })
                .collect(),
            Selection::Shuffled => {
                let mut stream = self.stream(Purpose::Selection, 0);
                let orders = [shuffled(n, &mut stream), shuffled(n, &mut stream)].concat();
                let fight = |pair: &[usize]| {
                    let coin = if stream.uniform() < 0.5 { pair[0] } else { pair[1] };
                    let order = self.ranking.compare(pair[0], pair[1]);
                    if order.is_lt() {
                        pair[0]
                    } else if order.is_gt() {
                        pair[1]
                    } else {
                        coin
                    }
                };
                orders.chunks_exact(2).take(count).map(fight).collect()
            }
        }
    }

    /// Children of the parents: all first children, then all second ones.
    fn offspring(&self) -> Population {
        let (n, d) = (self.x.len(), self.x.dimension());
        let pairs = n.div_ceil(2);
        let mut children = vec![0.0; 2 * pairs * d];
        let (first, second) = children.split_at_mut(pairs * d);
        let both = first.par_chunks_mut(d).zip(second.par_chunks_mut(d)).with_min_len(PAIRS_A_TASK);
        both.enumerate().for_each(|(pair, (a, b))| {
            a.copy_from_slice(self.x.row(self.parents[2 * pair]));
            b.copy_from_slice(self.x.row(self.parents[(2 * pair + 1) % n]));
            self.vary(a, b, &mut self.stream(Purpose::Variation, pair));
        });
        children.truncate(n * d);
        let mut children = Population::from_rows(d, children);
        if self.rules.distinct {
            self.make_distinct(&mut children);
        }
        children
    }

    /// Mutates children that are there already, in order, until they are not; each draws from a stream of its own.
    fn make_distinct(&self, children: &mut Population) {
        let mutation = self.mutation();
        let mut seen = HashSet::with_capacity(self.x.len() + children.len());
        seen.extend(fingerprints(&self.x));
        for (i, mark) in fingerprints(children).into_iter().enumerate() {
            if seen.insert(mark) {
                continue;
            }
            let child = children.row_mut(i);
            let mut stream = self.stream(Purpose::Distinction, i);
            for _ in 0..ATTEMPTS {
                mutation.apply(child, &self.ranges, &mut stream);
                if seen.insert(fingerprint(child)) {
                    break;
                }
            }
        }
    }

    fn mutation(&self) -> Mutation {
        let Rules { mutation_probability, mutation_index: index, bounded, .. } = self.rules;
        let probability = mutation_probability.unwrap_or_else(|| 1.0 / self.ranges.len() as f64);
        Mutation { probability, index, bounded }
    }

    fn vary(&self, a: &mut [f64], b: &mut [f64], stream: &mut Stream) {
        let Rules { crossover_index, bounded, .. } = self.rules;
        if stream.uniform() < self.rules.crossover_probability {
            Crossover { index: crossover_index, bounded }.apply(a, b, &self.ranges, stream);
        }
        let mutation = self.mutation();
        mutation.apply(a, &self.ranges, stream);
        mutation.apply(b, &self.ranges, stream);
    }

    /// Merges the population, or its chosen parents, with the offspring and keeps the best.
    fn survive(&mut self, offspring: &Population, costs: &Evaluation) {
        let old: Vec<usize> = match self.rules.merge {
            Merge::Population => (0..self.x.len()).collect(),
            Merge::Parents => std::mem::take(&mut self.parents),
        };
        let mut merged = Scores::new(self.settings.objectives);
        old.iter().for_each(|i| merged.push_from(&self.scores, *i));
        (0..costs.len()).for_each(|i| merged.push(costs.costs(i), costs.violation(i)));
        let (kept, ranking) = Ranking::best(&merged, self.x.len());
        let (mut x, mut scores) = (Population::new(self.x.dimension()), Scores::new(self.settings.objectives));
        for i in &kept {
            x.push(if *i < old.len() { self.x.row(old[*i]) } else { offspring.row(*i - old.len()) });
            scores.push_from(&merged, *i);
        }
        (self.x, self.scores, self.ranking) = (x, scores, ranking);
    }
}

fn fingerprints(x: &Population) -> Vec<u64> {
    x.values().par_chunks(x.dimension()).with_min_len(2 * PAIRS_A_TASK).map(fingerprint).collect()
}

/// 64 bits that stand for a position; that two positions share them, once in 1e9 generations of 100,000, costs one of
/// them a mutation.
fn fingerprint(x: &[f64]) -> u64 {
    let mut hasher = DefaultHasher::new();
    // -0 is 0.
    x.iter().for_each(|x| hasher.write_u64((x + 0.0).to_bits()));
    hasher.finish()
}

/// 0..n in random order (Fisher and Yates).
fn shuffled(n: usize, stream: &mut Stream) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    for last in (1..n).rev() {
        order.swap(last, stream.below(last + 1));
    }
    order
}

impl Optimizer for Nsga2 {
    fn name(&self) -> &'static str {
        self.rules.name
    }

    fn ask(&mut self) -> Option<Population> {
        if self.generation > self.settings.generations {
            return None;
        }
        if self.generation == 0 {
            return Some(self.x.clone());
        }
        self.parents = self.select(self.x.len());
        Some(self.offspring())
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        if self.generation == 0 {
            self.x = population.clone();
            self.scores = Scores::from(costs);
            self.ranking = Ranking::of(&self.scores);
        } else {
            self.survive(population, costs);
        }
        self.generation += 1;
    }

    fn save(&self) -> Option<Vec<u8>> {
        saved::write(&Saved {
            generation: self.generation,
            x: self.x.values().to_vec(),
            scores: self.scores.clone(),
            ranking: self.ranking.clone(),
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), RestoreError> {
        let reader = Reader { algorithm: self.name(), dimension: self.x.dimension() };
        let Saved { generation, x, scores, ranking } = reader.read(saved)?;
        let rows = self.settings.population;
        let generation = reader.told(generation, self.settings.generations)?;
        let scored = scores.is_whole() && scores.len() == rows && scores.objectives() == self.settings.objectives;
        reader.ensure(scored, "it has not one cost a candidate and objective")?;
        let ranked = ranking.rank.len() == rows && ranking.crowding.len() == rows;
        reader.ensure(ranked, "it has not one rank a candidate")?;
        self.x = reader.positions(x, rows)?;
        (self.generation, self.scores, self.ranking) = (generation, scores, ranking);
        Ok(())
    }
}
