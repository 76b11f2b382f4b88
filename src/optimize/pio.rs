//! Pigeon-inspired optimisation: the published form, its printed equations, and a repaired form.
//!
//! H. Duan, P. Qiao, "Pigeon-inspired optimization: a new swarm intelligence optimizer for air robot path planning",
//! Int. J. Intell. Comput. Cybern. 7 (2014), doi 10.1108/IJICC-02-2014-0005.

use serde::{Deserialize, Serialize};

use super::saved::{self, Reader};
use super::swarm::{self, Best};
use super::{Optimizer, RestoreError, Settings, Space};
use crate::population::{Evaluation, Population};
use crate::random::{Purpose, Stream};

/// What differs between the variants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Name in the registry.
    pub name: &'static str,
    /// Map and compass factor r: V is damped by exp(-r t).
    pub r: f64,
    /// Whether a pigeon moves by the new velocity V(t) or, as eq. 9 prints it, by the old one V(t-1).
    pub new_velocity: bool,
    /// Whether each coordinate has its own draw; otherwise one draw a pigeon.
    pub draw_per_coordinate: bool,
    /// Whether the landmark phase moves and scores the whole flock; otherwise only the kept half survives.
    pub keep_flock: bool,
    /// Whether the landmark weight is 1/J; otherwise J itself, as printed.
    pub inverse_weight: bool,
}

/// `pio`: the published form, with the new velocity.
pub const PUBLISHED: Rules = Rules {
    name: "pio",
    r: 0.2,
    new_velocity: true,
    draw_per_coordinate: false,
    keep_flock: false,
    inverse_weight: true,
};

/// `pio-printed`: the equations as printed, V(t-1) and w = J.
pub const PRINTED: Rules = Rules { name: "pio-printed", new_velocity: false, inverse_weight: false, ..PUBLISHED };

/// `pio+`: r = 0.01, a draw per coordinate in both phases, and the whole flock kept.
pub const PLUS: Rules = Rules { name: "pio+", r: 0.01, draw_per_coordinate: true, keep_flock: true, ..PUBLISHED };

/// Keeps weights finite and their sum positive when a cost is 0.
const EPSILON: f64 = 1e-12;

/// A flock. Two thirds of the generations (rounded) are map and compass, t = 1, 2, ...:
///
/// ```text
/// V <- V exp(-r t) + rand (X_g - X),  X <- X + V
/// ```
///
/// with X_g the best position ever scored up to the previous generation. The rest are landmark: the number Np of leading
/// pigeons halves (at least 1), the flock is sorted by the cost of its current positions, X_c is the weighted mean of
/// the best Np, and X <- X + rand (X_c - X); all but `pio+` discard the others for good. Positions are clipped to the
/// box where there is one; V is kept. V = 0 at the start; the initial population counts as generation 0.
#[derive(Debug, Clone)]
pub struct Pio {
    space: Space,
    settings: Settings,
    rules: Rules,
    iteration: usize,
    leaders: usize,
    x: Population,
    v: Population,
    cost: Vec<f64>,
    best: Best,
}

/// What a flock has learnt; populations row after row. The number of leaders follows from the iteration.
#[derive(Serialize, Deserialize)]
struct Saved {
    iteration: usize,
    x: Vec<f64>,
    v: Vec<f64>,
    cost: Vec<f64>,
    best: Best,
}

impl Pio {
    /// At generation 0.
    #[must_use]
    pub fn new(space: &Space, settings: &Settings, rules: Rules) -> Self {
        let x = swarm::first(space, settings.population, settings.seed);
        Self {
            space: space.clone(),
            settings: *settings,
            rules,
            iteration: 0,
            leaders: x.len(),
            v: Population::from_rows(space.dimension(), vec![0.0; x.len() * space.dimension()]),
            cost: vec![f64::INFINITY; x.len()],
            best: Best::none(space.dimension()),
            x,
        }
    }

    /// Generations of map and compass: 2/3 of all, rounded (100 of 150).
    const fn map_generations(&self) -> usize {
        let all = self.settings.generations;
        all - (all + 1) / 3
    }

    /// Leaders after `told` generations: halved by each one of the landmark phase.
    fn leaders_after(&self, told: usize) -> usize {
        let halvings = told.saturating_sub(1 + self.map_generations()).min(usize::BITS as usize - 1);
        (self.settings.population >> halvings).max(1)
    }

    fn map_and_compass(&mut self) {
        let damping = (-self.rules.r * self.iteration as f64).exp();
        let (space, rules, best) = (&self.space, &self.rules, &self.best.position);
        let stream = streams(self.settings.seed, self.iteration);
        swarm::for_each(&mut self.x, &mut self.v, |i, x, v| {
            let mut draws = Draws::new(stream(i), rules.draw_per_coordinate);
            for d in 0..x.len() {
                let velocity = v[d] * damping + draws.next() * (best[d] - x[d]);
                x[d] += if rules.new_velocity { velocity } else { v[d] };
                v[d] = velocity;
            }
            space.clip(x);
        });
    }

    fn landmark(&mut self) {
        self.leaders = (self.leaders / 2).max(1);
        self.sort();
        let weights = landmark_weights(&self.cost[..self.leaders], self.rules.inverse_weight);
        let centre = weighted_mean(&self.x, &weights);
        let (space, rules) = (&self.space, &self.rules);
        let stream = streams(self.settings.seed, self.iteration);
        // Of the velocities, which rest from here on, there may be more than pigeons.
        swarm::for_each(&mut self.x, &mut self.v, |i, x, _| {
            let mut draws = Draws::new(stream(i), rules.draw_per_coordinate);
            for (x, centre) in x.iter_mut().zip(&centre) {
                *x += draws.next() * (centre - *x);
            }
            space.clip(x);
        });
    }

    /// Sorts the flock by cost (stable), and discards all but the leaders unless the flock is kept.
    fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.x.len()).collect();
        order.sort_by(|a, b| self.cost[*a].total_cmp(&self.cost[*b]));
        if !self.rules.keep_flock {
            order.truncate(self.leaders);
        }
        let mut sorted = Population::new(self.x.dimension());
        for i in &order {
            sorted.push(self.x.row(*i));
        }
        self.cost = order.iter().map(|i| self.cost[*i]).collect();
        self.x = sorted;
    }
}

/// The draws of each pigeon in an iteration.
const fn streams(seed: u64, iteration: usize) -> impl Fn(usize) -> Stream {
    move |pigeon| Stream::new(seed, Purpose::Move, iteration as u64, pigeon as u64)
}

/// One draw for all coordinates of a pigeon, or one each.
struct Draws {
    stream: Stream,
    shared: Option<f64>,
}

impl Draws {
    fn new(mut stream: Stream, per_coordinate: bool) -> Self {
        let shared = if per_coordinate { None } else { Some(stream.uniform()) };
        Self { stream, shared }
    }

    fn next(&mut self) -> f64 {
        self.shared.unwrap_or_else(|| self.stream.uniform())
    }
}

/// Weights of the leaders: 1/(J + eps), or J. Where min J <= 0 (a log-likelihood, say), J is first replaced by
/// J - Jmin + mean(J - Jmin). Failed candidates weigh nothing; if all failed, all weigh the same.
fn landmark_weights(costs: &[f64], inverse: bool) -> Vec<f64> {
    let usable: Vec<f64> = costs.iter().copied().filter(|c| *c < Evaluation::FAILED).collect();
    let Some(min) = usable.iter().copied().min_by(f64::total_cmp) else {
        return vec![1.0; costs.len()];
    };
    let shift = if min > 0.0 { 0.0 } else { usable.iter().map(|c| c - min).sum::<f64>() / usable.len() as f64 - min };
    // Costs may be as small as the square of a small unit.
    let mean = usable.iter().map(|c| c + shift).sum::<f64>() / usable.len() as f64;
    let epsilon = if mean > 0.0 { EPSILON * mean.min(1.0) } else { EPSILON };
    let weight = |cost: f64| if inverse { 1.0 / (cost + shift + epsilon) } else { (cost + shift).max(epsilon) };
    costs.iter().map(|c| if *c < Evaluation::FAILED { weight(*c) } else { 0.0 }).collect()
}

/// Weighted mean of the first `weights.len()` positions.
fn weighted_mean(positions: &Population, weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let mut mean = vec![0.0; positions.dimension()];
    for (position, weight) in positions.rows().zip(weights) {
        for (m, x) in mean.iter_mut().zip(position) {
            *m += weight * x;
        }
    }
    mean.iter_mut().for_each(|m| *m /= total);
    mean
}

impl Optimizer for Pio {
    fn name(&self) -> &'static str {
        self.rules.name
    }

    fn ask(&mut self) -> Option<Population> {
        match self.iteration {
            0 => {}
            t if t <= self.map_generations() => self.map_and_compass(),
            t if t <= self.settings.generations => self.landmark(),
            _ => return None,
        }
        Some(self.x.clone())
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        for (i, cost) in self.cost.iter_mut().enumerate() {
            *cost = costs.costs(i)[0];
        }
        // A memetic wrapper may have moved some pigeons.
        self.x.clone_from(population);
        self.best.update(population, costs);
        self.iteration += 1;
    }

    fn save(&self) -> Option<Vec<u8>> {
        saved::write(&Saved {
            iteration: self.iteration,
            x: self.x.values().to_vec(),
            v: self.v.values().to_vec(),
            cost: self.cost.clone(),
            best: self.best.clone(),
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), RestoreError> {
        let reader = Reader { algorithm: self.name(), dimension: self.space.dimension() };
        let saved: Saved = reader.read(saved)?;
        let iteration = reader.told(saved.iteration, self.settings.generations)?;
        let leaders = self.leaders_after(iteration);
        let flock = if self.rules.keep_flock { self.settings.population } else { leaders };
        reader.ensure(saved.cost.len() == flock, "it has not one cost a pigeon")?;
        reader.positions(saved.best.position.clone(), 1)?;
        let x = reader.positions(saved.x, flock)?;
        self.v = reader.positions(saved.v, self.settings.population)?;
        (self.x, self.cost, self.best) = (x, saved.cost, saved.best);
        (self.iteration, self.leaders) = (iteration, leaders);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_weights(costs: &[f64], inverse: bool, expected: &[f64]) {
        for (weight, expected) in landmark_weights(costs, inverse).iter().zip(expected) {
            assert!((weight - expected).abs() <= 1e-11 * expected, "{costs:?}: {weight}, expected {expected}");
        }
    }

    #[test]
    fn weights_of_positive_negative_and_failed_costs() {
        assert_weights(&[0.5, 2.0], true, &[2.0, 0.5]);
        assert_weights(&[0.5, 2.0], false, &[0.5, 2.0]);
        // J - Jmin = 0, 1, 4 with mean 5/3.
        assert_weights(&[-1.0, 0.0, 3.0], true, &[3.0 / 5.0, 3.0 / 8.0, 3.0 / 17.0]);
        assert_weights(&[-1.0, 0.0, 3.0], false, &[5.0 / 3.0, 8.0 / 3.0, 17.0 / 3.0]);
        assert_weights(&[4.0, Evaluation::FAILED], true, &[0.25, 0.0]);
        assert_weights(&[Evaluation::FAILED; 2], true, &[1.0, 1.0]);
        assert_weights(&[0.0, 0.0], false, &[1e-12, 1e-12]);
        // Of errors in nanometres, squared: the same weights but for the unit.
        assert_weights(&[0.5e-18, 2e-18], true, &[2e18, 0.5e18]);
        assert_weights(&[0.5e-18, 2e-18], false, &[0.5e-18, 2e-18]);
    }

    #[test]
    fn two_thirds_of_the_generations_are_map_and_compass() {
        for (generations, map) in [(0, 0), (1, 1), (2, 1), (3, 2), (4, 3), (5, 3), (60, 40), (150, 100)] {
            let settings = Settings { population: 4, generations, seed: 0, objectives: 1, evaluations: None };
            let pio = Pio::new(&Space::boxed(&[[0.0, 1.0]]), &settings, PUBLISHED);
            assert_eq!(pio.map_generations(), map, "of {generations}");
        }
    }
}
