//! The length of a step: several are tried at once, beside the slope at the full one.

use super::quadratic::dot;
use super::{GOOD, Lbfgsb, Phase, Slope, usable};
use crate::optimize::Standing;

/// Share of the decrease along the slope that a step must reach (Armijo).
const SUFFICIENT: f64 = 1e-4;
/// Lengths tried beside the full step, in its batch.
const LENGTHS: [f64; 3] = [4.0, 0.25, 0.0625];

impl Lbfgsb {
    pub(super) fn take_step(&mut self) {
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
    pub(super) fn accept(&mut self, x: Vec<f64>, cost: f64, slope: Slope) {
        let s = x.iter().zip(&self.at.x).map(|(a, b)| a - b).collect();
        let y = slope.gradient.iter().zip(&self.at.slope.gradient).map(|(a, b)| a - b).collect();
        self.memory.add(s, y);
        self.gained = self.at.cost - cost;
        self.arrive(x, cost, slope);
    }

    /// Costs of the full step, of its slope and of the other lengths.
    pub(super) fn judge_step(&mut self, near: usize, costs: &[f64]) {
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

    pub(super) fn judge_shorter(&mut self, share: f64, costs: &[f64]) {
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
