//! L-BFGS-B: the local search for costs that are smooth.
//!
//! R. H. Byrd, P. Lu, J. Nocedal, C. Zhu, SIAM J. Sci. Comput. 16 (1995), doi 10.1137/0916069: a limited-memory BFGS model,
//! its generalised Cauchy point and the minimum over the coordinates that are free there. Unlike there, coordinates are
//! scaled by the curvature along each of them, which differences give for nothing; the step is cut by a search among
//! several lengths that travel in one batch with the slope at the full one; and what has converged is verified by its whole
//! Hessian and probed farther off.

mod gradient;
mod newton;
mod probe;
mod quadratic;
#[cfg(test)]
mod tests;

pub use gradient::{Differences, Gradient, Slope};

use super::{LocalSearch, OptimizeError, Optimizer, Space, Standing};
use crate::evaluate::{Evaluation, Population};
use gradient::ROUNDING;
use quadratic::{Memory, dot};

/// Predicted gain \[nats\] at which it stops: four orders below the 0.01 nats that anybody would notice, for what the model
/// may not know yet.
const GOAL: f64 = 1e-6;
/// Predicted gain \[nats\] up to which it is called converged where rounding or a wall ends it.
const GOOD: f64 = 1e-4;
/// Share of the decrease along the slope that a step must reach (Armijo).
const SUFFICIENT: f64 = 1e-4;
/// Lengths tried beside the full step, in its batch.
const LENGTHS: [f64; 3] = [4.0, 0.25, 0.0625];
/// Times that a probe may move what has converged.
const MOVES: usize = 12;

/// How a search runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Never sends more candidates than this.
    pub evaluations: usize,
    /// What one nat is in the cost's own unit: 1 for a negative log-likelihood.
    pub nat: f64,
    /// A length in each search coordinate that counts as large, such as ln 10: no step is longer.
    pub units: Vec<f64>,
}

/// Where it stands.
#[derive(Debug, Clone, Default)]
struct Point {
    x: Vec<f64>,
    cost: f64,
    slope: Slope,
    /// Of the points that the slope was taken from.
    offsets: Vec<[f64; 2]>,
}

/// What the batch is for.
#[derive(Debug, Clone)]
enum Phase {
    /// A point and its slope, to begin there.
    Begin,
    /// The full step and, up to this place in the batch, its slope; then other lengths.
    Step(usize),
    /// Ever shorter steps, the longest of which is this share of the full one.
    Shorter(f64),
    /// The slope at a point whose cost is known.
    Slope(Vec<f64>, f64),
    /// A step away along two of these coordinates at once.
    Corners(Vec<usize>),
    /// Points far off along each coordinate.
    Probe(Vec<usize>),
    /// Several such moves at once.
    Combine,
    End,
}

/// One search. Bounds hold for every point that it asks for; at a bound differences look inwards.
pub struct Lbfgsb {
    space: Space,
    options: Options,
    source: Box<dyn Gradient>,
    at: Point,
    memory: Memory,
    /// The step of the model from `at`, and the gain that it predicts.
    step: Vec<f64>,
    predicted: f64,
    phase: Phase,
    batch: Population,
    sent: usize,
    /// What the last step gained; infinite before the first one.
    gained: f64,
    moves: usize,
    standing: Standing,
}

/// Whether a cost is that of a candidate that runs and is feasible.
pub(super) fn usable(cost: f64) -> bool {
    cost < Evaluation::INFEASIBLE
}

impl Lbfgsb {
    /// From `start`, clipped to the box.
    ///
    /// # Errors
    /// If the space is not a box, or `start` and positive units are not as long as it has coordinates.
    pub fn new(
        space: &Space,
        start: &[f64],
        source: Box<dyn Gradient>,
        options: Options,
    ) -> Result<Self, OptimizeError> {
        space.check()?;
        let n = space.dimension();
        if start.len() != n || options.units.len() != n || !options.units.iter().all(|unit| *unit > 0.0) {
            return Err(OptimizeError::Space { coordinate: n, problem: "the start does not fit the space" });
        }
        let mut x = start.to_vec();
        space.clip(&mut x);
        let mut search = Self {
            space: space.clone(),
            options,
            source,
            at: Point { x: x.clone(), cost: f64::INFINITY, ..Point::default() },
            memory: Memory::default(),
            step: vec![0.0; n],
            predicted: f64::INFINITY,
            phase: Phase::End,
            batch: Population::new(n),
            sent: 0,
            gained: f64::INFINITY,
            moves: 0,
            standing: Standing::Unfinished,
        };
        search.begin(&x);
        Ok(search)
    }

    /// Candidates sent so far.
    #[must_use]
    pub const fn evaluations(&self) -> usize {
        self.sent
    }

    fn noise(&self) -> f64 {
        ROUNDING * self.at.cost.abs()
    }

    fn end(&mut self, standing: Standing) {
        self.standing = standing;
        self.phase = Phase::End;
        self.batch = Population::new(self.space.dimension());
    }

    fn wait_for(&mut self, phase: Phase, points: impl IntoIterator<Item = Vec<f64>>) {
        self.batch = Population::new(self.space.dimension());
        points.into_iter().for_each(|point| self.batch.push(&point));
        self.phase = phase;
    }

    /// Forgets what it learnt and begins at `x`.
    fn begin(&mut self, x: &[f64]) {
        self.memory.clear();
        self.gained = f64::INFINITY;
        let points = self.source.points(x);
        self.wait_for(Phase::Begin, std::iter::once(x.to_vec()).chain(points));
    }

    /// The point of the model's step at this share of it, in the box.
    fn along(&self, share: f64) -> Vec<f64> {
        let mut x: Vec<f64> = self.at.x.iter().zip(&self.step).map(|(x, step)| x + share * step).collect();
        self.space.clip(&mut x);
        x
    }

    fn arrive(&mut self, x: Vec<f64>, cost: f64, slope: Slope) {
        self.at = Point { x, cost, slope, offsets: self.source.offsets().to_vec() };
        self.plan();
    }

    /// A step from where it stands, by the model; or the end, where that promises nothing.
    fn plan(&mut self) {
        let Point { x, slope: Slope { gradient, curvature }, .. } = &self.at;
        let units = &self.options.units;
        // No coordinate's own curvature may carry it farther than a unit.
        let unit = |d: usize| self.options.nat / units[d].powi(2);
        let least = |d: usize| (gradient[d].abs() / units[d]).max(1e-10 * unit(d));
        let bent = |d: usize| curvature.get(d).map_or_else(|| unit(d), |curvature| curvature.abs().max(least(d)));
        let scale: Vec<f64> = (0..x.len()).map(|d| bent(d).sqrt()).collect();
        let scaled: Vec<f64> = gradient.iter().zip(&scale).map(|(g, scale)| g / scale).collect();
        let room = |d: usize| [(self.space.lower[d] - x[d]) * scale[d], (self.space.upper[d] - x[d]) * scale[d]];
        let room: Vec<[f64; 2]> = (0..x.len()).map(room).collect();
        let (step, gain) = self.memory.quadratic(&scale).minimise(&scaled, &room);
        self.predicted = gain.max(0.0);
        self.step = step.iter().zip(&scale).map(|(z, scale)| z / scale).collect();
        self.limit_step();
        let goal = self.goal();
        // A model that has not seen the valley yet predicts too little; so the last step must have gained little too. That
        // makes it one step at least.
        if self.predicted <= goal && (self.gained <= 10.0 * goal || self.predicted <= 1e-6 * goal) {
            self.verify();
        } else {
            self.take_step();
        }
    }

    /// The predicted gain at which it stops.
    fn goal(&self) -> f64 {
        (GOAL * self.options.nat).max(10.0 * self.noise())
    }

    fn limit_step(&mut self) {
        let shares = self.step.iter().zip(&self.options.units).map(|(s, unit)| s.abs() / unit);
        let longest = shares.fold(0.0, f64::max);
        if longest > 1.0 {
            self.step.iter_mut().for_each(|s| *s /= longest);
        }
    }

    fn take_step(&mut self) {
        let full = self.along(1.0);
        let slope = self.source.points(&full);
        // Near the optimum the full step is right, and the others would be scored for nothing.
        let far = self.predicted > 1e-2 * self.options.nat;
        let others: Vec<Vec<f64>> = LENGTHS.iter().filter(|_| far).map(|share| self.along(*share)).collect();
        let near = 1 + slope.len();
        self.wait_for(Phase::Step(near), std::iter::once(full).chain(slope).chain(others));
    }

    fn shorten(&mut self, share: f64) {
        if share < 1e-12 {
            return self.no_step();
        }
        let points: Vec<Vec<f64>> = (0..4).map(|k| self.along(share * 0.25_f64.powi(k))).collect();
        self.wait_for(Phase::Shorter(share), points);
    }

    /// No length lowers the cost: once more without the memory, and then that is the end.
    fn no_step(&mut self) {
        if !self.memory.is_empty() {
            self.memory.clear();
            self.plan();
        } else if self.predicted <= GOOD * self.options.nat {
            self.probe();
        } else {
            self.end(Standing::Stuck);
        }
    }

    /// Whether a cost at `x` is low enough beside what the slope promises.
    fn suffices(&self, x: &[f64], cost: f64) -> bool {
        let moved: Vec<f64> = x.iter().zip(&self.at.x).map(|(a, b)| a - b).collect();
        let promised = dot(&self.at.slope.gradient, &moved).min(0.0);
        usable(cost) && cost <= self.at.cost + SUFFICIENT * promised + self.noise()
    }

    /// Goes to `x`, and learns from the change of the gradient on the way.
    fn accept(&mut self, x: Vec<f64>, cost: f64, slope: Slope) {
        let s = x.iter().zip(&self.at.x).map(|(a, b)| a - b).collect();
        let y = slope.gradient.iter().zip(&self.at.slope.gradient).map(|(a, b)| a - b).collect();
        self.memory.add(s, y);
        self.gained = self.at.cost - cost;
        self.arrive(x, cost, slope);
    }

    /// Costs of the full step, of its slope and of the other lengths.
    fn judge_step(&mut self, near: usize, costs: &[f64]) {
        let (near, others) = costs.split_at(near);
        let full = self.batch.row(0).to_vec();
        let best = (0..others.len()).min_by(|a, b| others[*a].total_cmp(&others[*b]));
        let better = best.filter(|best| {
            let x = self.batch.row(near.len() + best);
            // A length whose slope is not here yet must be worth a batch.
            self.suffices(x, others[*best])
                && others[*best] < near[0] - 0.5 * (self.at.cost - near[0]).max(self.noise())
        });
        if let Some(best) = better {
            let x = self.batch.row(near.len() + best).to_vec();
            let points = self.source.points(&x);
            self.wait_for(Phase::Slope(x, others[best]), points);
        } else if self.suffices(&full, near[0]) {
            let slope = self.source.slope(&full, near[0], &near[1..]);
            self.accept(full, near[0], slope);
        } else {
            self.shorten(if others.is_empty() { 0.25 } else { 0.25 * LENGTHS[LENGTHS.len() - 1] });
        }
    }

    fn judge_shorter(&mut self, share: f64, costs: &[f64]) {
        let best = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
        let x = self.batch.row(best).to_vec();
        if self.suffices(&x, costs[best]) && x != self.at.x {
            let points = self.source.points(&x);
            self.wait_for(Phase::Slope(x, costs[best]), points);
        } else {
            self.shorten(share * 0.25_f64.powi(4));
        }
    }
}

impl Optimizer for Lbfgsb {
    fn name(&self) -> &'static str {
        "l-bfgs-b"
    }

    fn ask(&mut self) -> Option<Population> {
        let fits = self.sent + self.batch.len() <= self.options.evaluations;
        (fits && !self.batch.is_empty()).then(|| self.batch.clone())
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        self.sent += population.len();
        let costs: Vec<f64> = (0..costs.len()).map(|i| costs.costs(i)[0]).collect();
        match std::mem::replace(&mut self.phase, Phase::End) {
            Phase::Begin if usable(costs[0]) => {
                let x = population.row(0).to_vec();
                let slope = self.source.slope(&x, costs[0], &costs[1..]);
                self.arrive(x, costs[0], slope);
            }
            Phase::Begin | Phase::End => self.end(Standing::Stuck),
            Phase::Step(near) => self.judge_step(near, &costs),
            Phase::Shorter(share) => self.judge_shorter(share, &costs),
            Phase::Slope(x, cost) => {
                let slope = self.source.slope(&x, cost, &costs);
                self.accept(x, cost, slope);
            }
            Phase::Corners(free) => self.judge_corners(&free, &costs),
            Phase::Probe(coordinates) => self.judge_probe(&coordinates, &costs),
            Phase::Combine => self.judge_combined(&costs),
        }
    }
}

impl LocalSearch for Lbfgsb {
    fn best(&self) -> Option<(&[f64], f64)> {
        usable(self.at.cost).then_some((self.at.x.as_slice(), self.at.cost))
    }

    fn standing(&self) -> Standing {
        self.standing
    }

    fn gradient_norm(&self) -> Option<f64> {
        let norm = (2.0 * self.predicted / self.options.nat).sqrt();
        norm.is_finite().then_some(norm)
    }
}
