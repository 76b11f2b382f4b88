//! Pareto order: dominance with constraints, fronts by non-dominated sorting, crowding distance.
//!
//! K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, IEEE Trans. Evol. Comput. 6 (2002), doi 10.1109/4235.996017. All objectives
//! are minimised.

mod crowding;
mod fronts;
mod staircase;
#[cfg(test)]
pub(super) mod tests;
mod tree;

pub use crowding::crowding;
pub use fronts::fronts;

use rayon::prelude::*;

use crate::population::Evaluation;
use std::cmp::Ordering;

/// Costs and constraint violations of some candidates: what Pareto order looks at.
///
/// ```
/// use kfgpu::optimize::pareto::{Scores, crowding, fronts};
/// let mut scores = Scores::new(2);
/// for costs in [[1.0, 4.0], [2.0, 2.0], [4.0, 1.0], [3.0, 3.0]] {
///     scores.push(&costs, 0.0);
/// }
/// let ranks = fronts(&scores);
/// assert_eq!(ranks, [0, 0, 0, 1]);
/// assert_eq!(crowding(&scores, &ranks)[1], 2.0);
/// ```
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Scores {
    objectives: usize,
    costs: Vec<f64>,
    violation: Vec<f64>,
}

impl Scores {
    /// Of no candidate yet.
    #[must_use]
    pub const fn new(objectives: usize) -> Self {
        Self { objectives, costs: Vec::new(), violation: Vec::new() }
    }

    /// Appends a candidate. A cost or violation that is NaN counts as +inf, and -0 as 0, so that `<` is a total order.
    ///
    /// # Panics
    /// If there is not one cost an objective.
    pub fn push(&mut self, costs: &[f64], violation: f64) {
        assert_eq!(costs.len(), self.objectives, "one cost an objective");
        let ordered = |value: &f64| if value.is_nan() { f64::INFINITY } else { value + 0.0 };
        self.costs.extend(costs.iter().map(ordered));
        self.violation.push(ordered(&violation));
    }

    /// Appends candidate `i` of `other`.
    pub fn push_from(&mut self, other: &Self, i: usize) {
        self.costs.extend_from_slice(other.costs(i));
        self.violation.push(other.violation[i]);
    }

    /// Replaces candidate `i`, as [`Self::push`] would append it.
    pub fn replace(&mut self, i: usize, costs: &[f64], violation: f64) {
        let mut one = Self::new(self.objectives);
        one.push(costs, violation);
        let m = self.objectives;
        self.costs[i * m..(i + 1) * m].copy_from_slice(&one.costs);
        self.violation[i] = one.violation[0];
    }

    /// Whether there is one cost an objective and candidate: a state read from a file may not have.
    pub(super) const fn is_whole(&self) -> bool {
        matches!(self.violation.len().checked_mul(self.objectives), Some(costs) if costs == self.costs.len())
    }

    /// Number of objectives.
    #[must_use]
    pub const fn objectives(&self) -> usize {
        self.objectives
    }

    /// Number of candidates.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.violation.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.violation.is_empty()
    }

    /// Costs of candidate `i`, one an objective.
    #[must_use]
    pub fn costs(&self, i: usize) -> &[f64] {
        &self.costs[i * self.objectives..(i + 1) * self.objectives]
    }

    /// How far candidate `i` is from satisfying the constraints: 0 = feasible, infinite = failed.
    #[must_use]
    pub fn violation(&self, i: usize) -> f64 {
        self.violation[i]
    }

    /// Whether candidate `i` satisfies the constraints.
    #[must_use]
    pub fn feasible(&self, i: usize) -> bool {
        self.violation[i] <= 0.0
    }

    /// Whether candidate `i` is better than `j` by constrained domination: a feasible one before an infeasible one, of two
    /// infeasible ones that with the smaller violation, of two feasible ones the one that [`dominates`].
    #[must_use]
    pub fn better(&self, i: usize, j: usize) -> bool {
        match (self.feasible(i), self.feasible(j)) {
            (true, true) => dominates(self.costs(i), self.costs(j)),
            (false, false) => self.violation[i] < self.violation[j],
            (feasible, _) => feasible,
        }
    }
}

impl From<&Evaluation> for Scores {
    fn from(evaluation: &Evaluation) -> Self {
        let mut scores = Self::new(evaluation.objectives());
        (0..evaluation.len()).for_each(|i| scores.push(evaluation.costs(i), evaluation.violation(i)));
        scores
    }
}

/// Whether costs `a` are nowhere worse than `b` and somewhere better.
#[must_use]
pub fn dominates(a: &[f64], b: &[f64]) -> bool {
    let mut better = false;
    for (a, b) in a.iter().zip(b) {
        if a > b {
            return false;
        }
        better |= a < b;
    }
    better
}

/// Rank and crowding distance of every candidate, and the order they make.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Ranking {
    /// Front of each candidate; 0 = not dominated.
    pub rank: Vec<usize>,
    /// Crowding distance within its front.
    pub crowding: Vec<f64>,
}

impl Ranking {
    /// Of these candidates among each other.
    #[must_use]
    pub fn of(scores: &Scores) -> Self {
        let rank = fronts(scores);
        let crowding = crowding(scores, &rank);
        Self { rank, crowding }
    }

    /// The best `keep` candidates, by [`Self::compare`] and then by index, with the ranks and crowding distances that they
    /// have among **all**.
    #[must_use]
    pub fn best(scores: &Scores, keep: usize) -> (Vec<usize>, Self) {
        let rank = fronts(scores);
        let mut sizes = vec![0; rank.iter().max().map_or(0, |last| last + 1)];
        rank.iter().for_each(|rank| sizes[*rank] += 1);
        let filled = |so_far: &mut usize, size: &usize| {
            *so_far += size;
            Some(*so_far)
        };
        let last = sizes.iter().scan(0, filled).take_while(|so_far| *so_far < keep).count();
        let members: Vec<usize> = (0..rank.len()).filter(|i| rank[*i] <= last).collect();
        let crowding = crowding::crowding_among(scores, &rank, members.clone());
        let mut keyed: Vec<(usize, f64, usize)> = members.into_iter().map(|i| (rank[i], crowding[i], i)).collect();
        keyed.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
        keyed.truncate(keep);
        let (rank, crowding) = keyed.iter().map(|(rank, crowding, _)| (*rank, *crowding)).unzip();
        (keyed.into_iter().map(|(_, _, i)| i).collect(), Self { rank, crowding })
    }

    /// The crowded-comparison order: lower rank, then larger crowding distance; `Less` = `i` is better.
    #[must_use]
    pub fn compare(&self, i: usize, j: usize) -> Ordering {
        self.rank[i].cmp(&self.rank[j]).then_with(|| self.crowding[j].total_cmp(&self.crowding[i]))
    }

    /// All candidates by [`Self::compare`], equal ones by index.
    #[must_use]
    pub fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.rank.len()).collect();
        order.sort_unstable_by(|i, j| self.compare(*i, *j).then(i.cmp(j)));
        order
    }
}
