//! The front: everything feasible that a search has seen and nothing it has seen dominates.

mod certify;
mod pick;
mod prefer;
mod prune;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::Scored;
use crate::evaluate::{Evaluation, Population};
use crate::optimize::indicators::hypervolume;

pub(super) use certify::{Certified, certify};
pub use pick::Landmarks;
pub use prefer::{Among, MeanNis};

/// Members that the front of a study keeps; of more, those with the most room around them. Each is scored once more by
/// the f64 reference.
pub const FRONT_CAPACITY: usize = 128;

/// A certified member of the front.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontMember {
    /// Values of the searched parameters, in their own units.
    pub candidate: Vec<f64>,
    /// Costs as the search scored them, in the order of the problem's objectives.
    pub costs_search: Vec<f64>,
    /// Objectives by the f64 oracle.
    pub objectives: Vec<f64>,
    /// What the constraints bound, by the oracle, in their order; all of them are met.
    pub constraints: Vec<f64>,
    /// Its mean NIS, once [`super::Outcome::prefer_consistent`] has asked for it.
    pub nis: Option<MeanNis>,
}

/// The running front of a search, whatever the optimiser: no member is as good as another in every objective.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Front {
    capacity: usize,
    candidates: Vec<Vec<f64>>,
    /// Costs column by column, one an objective: a candidate is compared with all members at once.
    costs: Vec<Vec<f64>>,
    /// Fixed when the first members arrive.
    reference: Vec<f64>,
}

impl Front {
    pub(super) fn new(objectives: usize, capacity: usize) -> Self {
        Self { capacity, candidates: Vec::new(), costs: vec![Vec::new(); objectives], reference: Vec::new() }
    }

    /// Whether a saved front can be one of a search over so many parameters and objectives.
    pub(super) fn fits(front: Option<&Self>, dimension: usize, objectives: usize) -> bool {
        let Some(Self { capacity, candidates, costs, reference }) = front else { return objectives < 2 };
        let finite = |values: &Vec<f64>| values.iter().all(|value| value.is_finite());
        let columns = costs.iter().all(|column| column.len() == candidates.len() && finite(column));
        let length = if candidates.is_empty() { 0 } else { objectives };
        let capped = *capacity == FRONT_CAPACITY && candidates.len() <= FRONT_CAPACITY;
        let rows = candidates.iter().all(|candidate| candidate.len() == dimension);
        capped && rows && columns && costs.len() == objectives && reference.len() == length && finite(reference)
    }

    pub(super) const fn len(&self) -> usize {
        self.candidates.len()
    }

    /// The point that hypervolumes are measured from; empty until there is a member. It lies beyond the worst of the
    /// first generation's members in every objective, by a tenth of their range (or, where they all agree, of the value).
    pub(super) fn reference(&self) -> &[f64] {
        &self.reference
    }

    /// The volume that the members dominate, up to the reference point.
    pub(super) fn hypervolume(&self) -> f64 {
        let points = self.points();
        let points: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
        hypervolume(&points, &self.reference)
    }

    /// Costs of each member.
    pub(super) fn points(&self) -> Vec<Vec<f64>> {
        (0..self.len()).map(|i| self.costs.iter().map(|column| column[i]).collect()).collect()
    }

    /// The members, best first objective first.
    pub(super) fn members(&self) -> Vec<Scored> {
        let member =
            |(candidate, costs): (&Vec<f64>, _)| Scored { candidate: candidate.clone(), costs, violation: 0.0 };
        let mut members: Vec<Scored> = self.candidates.iter().zip(self.points()).map(member).collect();
        members.sort_by(|a, b| a.costs[0].total_cmp(&b.costs[0]));
        members
    }

    /// Takes in what is usable, feasible and not dominated. Of equal costs the first seen stays.
    pub(super) fn add(&mut self, candidates: &Population, costs: &Evaluation) {
        for (i, candidate) in candidates.rows().enumerate() {
            if costs.violation(i) <= 0.0 && !self.covers(costs.costs(i)) {
                self.insert(candidate, costs.costs(i));
            }
        }
        self.shrink_to(self.capacity);
        if self.reference.is_empty() && self.len() > 0 {
            self.reference = self.costs.iter().map(|column| beyond(column)).collect();
        }
    }

    /// Whether some member is at least as good in every objective.
    fn covers(&self, costs: &[f64]) -> bool {
        let mut worse = vec![false; self.len()];
        for (column, cost) in self.costs.iter().zip(costs) {
            worse.iter_mut().zip(column).for_each(|(worse, member)| *worse |= member > cost);
        }
        worse.contains(&false)
    }

    fn insert(&mut self, candidate: &[f64], costs: &[f64]) {
        let mut better = vec![false; self.len()];
        for (column, cost) in self.costs.iter().zip(costs) {
            better.iter_mut().zip(column).for_each(|(better, member)| *better |= member < cost);
        }
        if better.contains(&false) {
            self.retain(&better);
        }
        self.candidates.push(candidate.to_vec());
        self.costs.iter_mut().zip(costs).for_each(|(column, cost)| column.push(*cost));
        // Pruning one at a time as members come would cost a sort each.
        if self.len() >= 2 * self.capacity {
            self.shrink_to(self.capacity);
        }
    }

    fn shrink_to(&mut self, capacity: usize) {
        if self.len() > capacity {
            self.retain(&prune::spread_out(&self.costs, capacity));
        }
    }

    fn retain(&mut self, keep: &[bool]) {
        let mut flags = keep.iter();
        self.candidates.retain(|_| *flags.next().unwrap_or(&true));
        for column in &mut self.costs {
            let mut flags = keep.iter();
            column.retain(|_| *flags.next().unwrap_or(&true));
        }
    }
}

/// A tenth of the range beyond the largest value.
fn beyond(column: &[f64]) -> f64 {
    let [low, high] = column.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(*x), h.max(*x)]);
    let range = high - low;
    let unit = if high.abs() > 0.0 { high.abs() } else { 1.0 };
    high + 0.1 * if range > 0.0 { range } else { unit }
}
