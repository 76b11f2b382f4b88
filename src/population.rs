//! Candidates and what they cost: all that optimisers and evaluators have in common.

use std::borrow::Cow;

/// Candidates, one row each: the values of the searched parameters in their own units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Population {
    dimension: usize,
    values: Vec<f64>,
}

impl Population {
    /// An empty population of `dimension` searched parameters.
    #[must_use]
    pub const fn new(dimension: usize) -> Self {
        Self { dimension, values: Vec::new() }
    }

    /// From row-major values.
    ///
    /// # Panics
    /// If the values do not fill whole rows.
    #[must_use]
    pub fn from_rows(dimension: usize, values: Vec<f64>) -> Self {
        assert!(dimension > 0 && values.len().is_multiple_of(dimension), "values fill whole rows of {dimension}");
        Self { dimension, values }
    }

    /// Appends a candidate.
    ///
    /// # Panics
    /// If it is not `dimension` long.
    pub fn push(&mut self, candidate: &[f64]) {
        assert_eq!(candidate.len(), self.dimension, "a candidate has one value per searched parameter");
        self.values.extend_from_slice(candidate);
    }

    /// Number of searched parameters.
    #[must_use]
    pub const fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of candidates.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len().checked_div(self.dimension).unwrap_or(0)
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Candidate `i`.
    #[must_use]
    pub fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.dimension..(i + 1) * self.dimension]
    }

    /// Candidate `i`, to change.
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.values[i * self.dimension..(i + 1) * self.dimension]
    }

    /// The values of all candidates, row after row.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The same, to change.
    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// All candidates in order.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.dimension.max(1))
    }
}

/// What went wrong with a candidate; no bit set = a usable cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct Status(u32);

impl Status {
    /// Usable.
    pub const OK: Self = Self(0);
    /// Q, R or P0 is no covariance, or an innovation covariance was not positive definite or not finite.
    pub const NOT_POSITIVE: Self = Self(1);
    /// A cost was not finite, although the covariances were.
    pub const NOT_FINITE: Self = Self(2);
    /// There was no candidate to score: `evaluate` read something else in its place.
    pub const UNREADABLE: Self = Self(8);

    /// Whether no bit is set.
    #[must_use]
    pub const fn is_ok(self) -> bool {
        self.0 == 0
    }

    /// Both sets of bits.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The bits, for files and kernels.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }
}

/// Costs of a population.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evaluation {
    objectives: usize,
    costs: Vec<f64>,
    status: Vec<Status>,
    /// One a candidate, or none at all without constraints.
    violation: Vec<f64>,
}

impl Evaluation {
    /// The cost of a failed candidate: the worst finite number, so that comparisons never meet NaN.
    pub const FAILED: f64 = f64::MAX;

    /// The least that [`Self::penalised`] makes an infeasible candidate cost; no cost of a usable one is near it.
    pub const INFEASIBLE: f64 = 1e200;

    /// From row-major costs (candidates x objectives) and one status a candidate. Costs of failed candidates, and
    /// any cost that is not finite, become [`Self::FAILED`], and the latter set [`Status::NOT_FINITE`] where no bit is set.
    ///
    /// # Panics
    /// If the lengths disagree.
    #[must_use]
    pub fn new(objectives: usize, mut costs: Vec<f64>, mut status: Vec<Status>) -> Self {
        assert_eq!(costs.len(), objectives * status.len(), "one cost per candidate and objective");
        for (row, status) in costs.chunks_exact_mut(objectives.max(1)).zip(&mut status) {
            if status.is_ok() && row.iter().any(|c| !c.is_finite()) {
                *status = Status::NOT_FINITE;
            }
            if !status.is_ok() {
                row.fill(Self::FAILED);
            }
        }
        Self { objectives, costs, status, violation: Vec::new() }
    }

    /// With how far each candidate is from satisfying the problem's constraints: 0 = feasible.
    ///
    /// # Panics
    /// If there is not one number a candidate.
    #[must_use]
    pub fn with_violation(mut self, violation: Vec<f64>) -> Self {
        assert_eq!(violation.len(), self.status.len(), "one violation per candidate");
        self.violation = violation;
        self
    }

    /// How far candidate `i` is from satisfying the constraints: 0 = feasible, infinite if it failed. Never NaN.
    #[must_use]
    pub fn violation(&self, i: usize) -> f64 {
        if !self.status[i].is_ok() {
            return f64::INFINITY;
        }
        self.violation.get(i).map_or(0.0, |v| if v.is_nan() { f64::INFINITY } else { *v })
    }

    /// For methods that minimise one number and know nothing of constraints: an infeasible candidate costs 1e200 to
    /// 2e200, the more the more it violates, so that a feasible one is always better and of two infeasible ones the
    /// one that violates less; unchanged without constraints or with several objectives.
    ///
    /// The order is that of K. Deb, Comput. Methods Appl. Mech. Eng. 186 (2000), doi 10.1016/S0045-7825(99)00389-8, with
    /// a constant in place of the worst feasible cost, so that costs of different generations compare.
    #[must_use]
    pub fn penalised(&self) -> Cow<'_, Self> {
        if self.objectives != 1 || self.violation.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut penalised = self.clone();
        for i in (0..self.len()).filter(|i| self.status[*i].is_ok()) {
            let violation = self.violation(i);
            if violation > 0.0 {
                penalised.costs[i] = Self::INFEASIBLE * (2.0 - 1.0 / (1.0 + violation));
            }
        }
        Cow::Owned(penalised)
    }

    /// Number of objectives.
    #[must_use]
    pub const fn objectives(&self) -> usize {
        self.objectives
    }

    /// Number of candidates.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.status.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.status.is_empty()
    }

    /// Costs of candidate `i`, one per objective; all [`Self::FAILED`] if it failed. Never NaN.
    #[must_use]
    pub fn costs(&self, i: usize) -> &[f64] {
        &self.costs[i * self.objectives..(i + 1) * self.objectives]
    }

    /// Status of candidate `i`.
    #[must_use]
    pub fn status(&self, i: usize) -> Status {
        self.status[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn penalised_costs_have_the_order_of_violation_then_cost() {
        let costs = vec![-1e9, 5.0, 3.0, 1e12, 0.0, 7.0];
        let mut status = vec![Status::OK; 6];
        status[5] = Status::NOT_POSITIVE;
        let evaluation = Evaluation::new(1, costs, status);
        assert!(matches!(evaluation.penalised(), Cow::Borrowed(_)), "without constraints nothing changes");
        let evaluation = evaluation.with_violation(vec![1e-12, 0.0, 0.0, 0.5, f64::NAN, 0.0]);
        let penalised = evaluation.penalised();
        let mut order: Vec<usize> = (0..6).collect();
        order.sort_by(|a, b| penalised.costs(*a)[0].total_cmp(&penalised.costs(*b)[0]));
        assert_eq!(order, [2, 1, 0, 3, 4, 5], "{penalised:?}");
        assert_eq!((penalised.costs(1), penalised.violation(3)), (&[5.0][..], 0.5));
        let several = Evaluation::new(2, vec![1.0; 4], vec![Status::OK; 2]).with_violation(vec![1.0, 0.0]);
        assert!(matches!(several.penalised(), Cow::Borrowed(_)), "methods for fronts look at the violation");
    }
}
