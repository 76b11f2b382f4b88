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
mod step;
#[cfg(test)]
mod tests;

pub use gradient::{Differences, Gradient, Slope};

use super::{LocalSearch, OptimizeError, Optimizer, Space, Standing};
use crate::population::{Evaluation, Population};
use gradient::ROUNDING;
use quadratic::Memory;

/// Predicted gain \[nats\] at which it stops: four orders below the 0.01 nats that anybody would notice, for what the model
/// may not know yet.
const GOAL: f64 = 1e-6;
/// Predicted gain \[nats\] up to which it is called converged where rounding or a wall ends it.
const GOOD: f64 = 1e-4;
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
    /// Whether it took Newton's step where it was good enough already.
    refined: bool,
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
            refined: false,
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
        self.refined = false;
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
