//! Particle swarm optimisation, two published parameter sets.

use serde::{Deserialize, Serialize};

use super::saved::{self, Reader};
use super::swarm::{self, Best};
use super::{Optimizer, RestoreError, Settings, Space};
use crate::population::{Evaluation, Population};
use crate::random::{Purpose, Stream};

/// The constants of a swarm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Name in the registry.
    pub name: &'static str,
    /// Weight of the old velocity at the first and at the last iteration, linear between.
    pub inertia: [f64; 2],
    /// c1, pull towards the particle's own best.
    pub own: f64,
    /// c2, pull towards the swarm's best.
    pub swarm: f64,
}

/// `pso`: constriction 0.7298 with c1 = c2 = 2.05 x 0.7298.
///
/// M. Clerc, J. Kennedy, IEEE Trans. Evol. Comput. 6 (2002), doi 10.1109/4235.985692; the values as rounded by
/// R. C. Eberhart, Y. Shi, CEC 2000, doi 10.1109/CEC.2000.870279.
pub const CONSTRICTION: Rules = Rules { name: "pso", inertia: [0.7298; 2], own: 1.49618, swarm: 1.49618 };

/// `pso-inertia`: the weight falls linearly from 0.9 to 0.4 over the run, c1 = c2 = 2.
///
/// Y. Shi, R. C. Eberhart, CEC 1999, doi 10.1109/CEC.1999.785511.
pub const INERTIA: Rules = Rules { name: "pso-inertia", inertia: [0.9, 0.4], own: 2.0, swarm: 2.0 };

/// A swarm with synchronous update and no velocity limit.
///
/// One iteration, for every particle and coordinate, with r1 and then r2 drawn uniformly from [0, 1):
///
/// ```text
/// V <- w V + c1 r1 (P_best - X) + c2 r2 (G_best - X)
/// X <- X + V, clipped to the box where there is one (V is kept)
/// ```
///
/// After all have moved and been scored, P_best and G_best are replaced where strictly better. V = 0 at the start; the
/// initial population counts as iteration 0.
#[derive(Debug, Clone)]
pub struct Pso {
    space: Space,
    settings: Settings,
    rules: Rules,
    iteration: usize,
    x: Population,
    v: Population,
    own_best: Population,
    own_cost: Vec<f64>,
    best: Best,
}

/// What a swarm has learnt; populations row after row.
#[derive(Serialize, Deserialize)]
struct Saved {
    iteration: usize,
    x: Vec<f64>,
    v: Vec<f64>,
    own_best: Vec<f64>,
    own_cost: Vec<f64>,
    best: Best,
}

impl Pso {
    /// At iteration 0.
    #[must_use]
    pub fn new(space: &Space, settings: &Settings, rules: Rules) -> Self {
        let x = swarm::first(space, settings.population, settings.seed);
        Self {
            space: space.clone(),
            settings: *settings,
            rules,
            iteration: 0,
            v: Population::from_rows(space.dimension(), vec![0.0; x.len() * space.dimension()]),
            own_best: x.clone(),
            own_cost: vec![f64::INFINITY; x.len()],
            best: Best::none(space.dimension()),
            x,
        }
    }

    /// w of the current iteration, 1 to `generations`.
    fn inertia(&self) -> f64 {
        let [first, last] = self.rules.inertia;
        let share = (self.iteration - 1) as f64 / self.settings.generations.saturating_sub(1).max(1) as f64;
        first + (last - first) * share
    }

    fn advance(&mut self) {
        let Rules { own: c1, swarm: c2, .. } = self.rules;
        let w = self.inertia();
        let (space, seed, iteration) = (&self.space, self.settings.seed, self.iteration as u64);
        let (own, best) = (&self.own_best, &self.best.position);
        swarm::for_each(&mut self.x, &mut self.v, |i, x, v| {
            let mut stream = Stream::new(seed, Purpose::Move, iteration, i as u64);
            let own_best = own.row(i);
            for d in 0..x.len() {
                let (r1, r2) = (stream.uniform(), stream.uniform());
                v[d] = w * v[d] + c1 * r1 * (own_best[d] - x[d]) + c2 * r2 * (best[d] - x[d]);
                x[d] += v[d];
            }
            space.clip(x);
        });
    }
}

impl Optimizer for Pso {
    fn name(&self) -> &'static str {
        self.rules.name
    }

    fn ask(&mut self) -> Option<Population> {
        if self.iteration > self.settings.generations {
            return None;
        }
        if self.iteration > 0 {
            self.advance();
        }
        Some(self.x.clone())
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        for (i, position) in population.rows().enumerate() {
            let cost = costs.costs(i)[0];
            if cost < self.own_cost[i] {
                self.own_cost[i] = cost;
                self.own_best.row_mut(i).copy_from_slice(position);
            }
        }
        self.best.update(population, costs);
        self.iteration += 1;
    }
    fn save(&self) -> Option<Vec<u8>> {
        saved::write(&Saved {
            iteration: self.iteration,
            x: self.x.values().to_vec(),
            v: self.v.values().to_vec(),
            own_best: self.own_best.values().to_vec(),
            own_cost: self.own_cost.clone(),
            best: self.best.clone(),
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), RestoreError> {
        let reader = Reader { algorithm: self.name(), dimension: self.space.dimension() };
        let saved: Saved = reader.read(saved)?;
        let rows = self.settings.population;
        let iteration = reader.told(saved.iteration, self.settings.generations)?;
        reader.ensure(saved.own_cost.len() == rows, "it has not one cost a particle")?;
        reader.positions(saved.best.position.clone(), 1)?;
        let [x, v, own_best] = [saved.x, saved.v, saved.own_best].map(|values| reader.positions(values, rows));
        (self.x, self.v, self.own_best) = (x?, v?, own_best?);
        (self.iteration, self.own_cost, self.best) = (iteration, saved.own_cost, saved.best);
        Ok(())
    }
}
