//! The best distinct candidates that a search has seen.

use serde::{Deserialize, Serialize};

use crate::evaluate::{Evaluation, Population};

/// A candidate and its costs, one per objective.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Scored {
    /// Values of the searched parameters, in their own units.
    pub candidate: Vec<f64>,
    /// Costs, in the order of the problem's objectives.
    pub costs: Vec<f64>,
    /// How far it is from satisfying the constraints: 0 = feasible.
    pub violation: f64,
}

impl Scored {
    /// Feasible before infeasible, then by violation, then by the first objective.
    fn order(&self, violation: f64, cost: f64) -> std::cmp::Ordering {
        self.violation.total_cmp(&violation).then(self.costs[0].total_cmp(&cost))
    }
}

/// Up to `capacity` distinct candidates: feasible ones first, best first objective first, then those that violate least;
/// of equals the one seen first.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Archive {
    capacity: usize,
    members: Vec<Scored>,
}

impl Archive {
    /// An empty archive.
    #[must_use]
    pub const fn new(capacity: usize) -> Self {
        Self { capacity, members: Vec::new() }
    }

    /// With these members, best first.
    pub(super) const fn of(capacity: usize, members: Vec<Scored>) -> Self {
        Self { capacity, members }
    }

    /// The members, best first.
    #[must_use]
    pub fn members(&self) -> &[Scored] {
        &self.members
    }

    /// The best candidate so far, if any was usable.
    #[must_use]
    pub fn best(&self) -> Option<&Scored> {
        self.members.first()
    }

    /// Takes in what is usable and good enough of a population.
    pub fn add(&mut self, candidates: &Population, costs: &Evaluation) {
        for (i, candidate) in candidates.rows().enumerate() {
            if costs.status(i).is_ok() {
                self.offer(candidate, costs.costs(i), costs.violation(i));
            }
        }
    }

    fn offer(&mut self, candidate: &[f64], costs: &[f64], violation: f64) {
        let full = self.members.len() >= self.capacity;
        let too_late = |worst: &Scored| worst.order(violation, costs[0]).is_le();
        if full && self.members.last().is_none_or(too_late) {
            return;
        }
        if self.members.iter().any(|m| m.candidate == candidate) {
            return;
        }
        let at = self.members.partition_point(|m| m.order(violation, costs[0]).is_le());
        self.members.insert(at, Scored { candidate: candidate.to_vec(), costs: costs.to_vec(), violation });
        self.members.truncate(self.capacity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Status;

    #[test]
    fn keeps_the_best_distinct_usable_candidates_in_order() {
        let mut archive = Archive::new(3);
        let rows = [5.0, 2.0, 2.0, 4.0, 1.0, 3.0, 9.0];
        let costs = vec![50.0, 20.0, 20.0, 40.0, 10.0, 20.0, 0.0];
        let mut status = vec![Status::OK; 7];
        status[6] = Status::NOT_POSITIVE;
        archive.add(&Population::from_rows(1, rows.to_vec()), &Evaluation::new(1, costs, status));
        let kept: Vec<f64> = archive.members().iter().map(|m| m.candidate[0]).collect();
        assert_eq!(kept, [1.0, 2.0, 3.0], "2 before 3 at equal cost; 9 failed");
        assert_eq!(archive.best().map(|b| b.costs[0]), Some(10.0));
    }

    #[test]
    fn feasible_comes_before_infeasible_and_less_violation_before_more() {
        let mut archive = Archive::new(3);
        let evaluation = |costs: [f64; 3], violation: [f64; 3]| {
            Evaluation::new(1, costs.to_vec(), vec![Status::OK; 3]).with_violation(violation.to_vec())
        };
        archive.add(&Population::from_rows(1, vec![1.0, 2.0, 3.0]), &evaluation([1.0, 2.0, 9.0], [0.5, 0.1, f64::NAN]));
        archive.add(&Population::from_rows(1, vec![4.0, 5.0, 6.0]), &evaluation([40.0, 50.0, 0.0], [0.0, 0.0, 0.2]));
        let kept: Vec<f64> = archive.members().iter().map(|m| m.candidate[0]).collect();
        assert_eq!(kept, [4.0, 5.0, 2.0]);
    }
}
