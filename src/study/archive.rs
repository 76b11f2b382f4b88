//! The best distinct candidates that a search has seen.

use serde::{Deserialize, Serialize};

use crate::evaluate::{Evaluation, Population};

/// A candidate and its costs, one per objective.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scored {
    /// Values of the searched parameters, in their own units.
    pub candidate: Vec<f64>,
    /// Costs, in the order of the problem's objectives.
    pub costs: Vec<f64>,
}

/// Up to `capacity` distinct candidates, best first objective first; of equal costs the one seen first.
#[derive(Debug, Clone)]
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
                self.offer(candidate, costs.costs(i));
            }
        }
    }

    fn offer(&mut self, candidate: &[f64], costs: &[f64]) {
        let full = self.members.len() >= self.capacity;
        let too_late = |worst: &Scored| costs[0] >= worst.costs[0];
        if full && self.members.last().is_none_or(too_late) {
            return;
        }
        if self.members.iter().any(|m| m.candidate == candidate) {
            return;
        }
        let at = self.members.partition_point(|m| m.costs[0] <= costs[0]);
        self.members.insert(at, Scored { candidate: candidate.to_vec(), costs: costs.to_vec() });
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
}
