//! What objectives see of a filter while it is traced, and of its sums when it has run.

use super::columns::{Columns, Place, Rows};
use super::covariance::Covariance;
use super::kalman::Update;
use super::nominal::Nominal;
use super::program::Role;
use crate::model::Problem;
use crate::tape::{Graph, Id, Unary};

/// Offers one row of the traced filter to the objectives and collects their sums.
pub(crate) struct Scoring<'a> {
    pub(super) g: &'a mut Graph,
    pub(super) columns: &'a mut Columns,
    pub(super) rows: &'a Rows<'a>,
    pub(super) problem: &'a Problem,
    pub(super) nominal: Option<&'a Nominal>,
    pub(super) update: &'a Update,
    pub(super) x: &'a [Id],
    pub(super) p: &'a Covariance,
    pub(super) sums: &'a mut Vec<(Role, Id)>,
    /// What a candidate fails without.
    pub(super) positive: &'a mut Vec<Id>,
}

/// The sums of one objective: which slots of the program, and over how much they run.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Traced {
    /// Slots, in the objective's own order.
    pub(crate) slots: Vec<usize>,
    /// The objective's count (components, rows), one a trajectory.
    pub(crate) counts: Vec<f64>,
}

/// For each trajectory the row from which its window of last measured rows begins.
pub(crate) struct Window(Vec<usize>);

impl Window {
    /// Whether a row stands in the window (rows without a measurement may stand between those that count).
    pub(crate) fn contains(&self, place: Place<'_>) -> bool {
        place.k >= self.0[place.index]
    }
}

impl Scoring<'_> {
    /// Number of measurements, m.
    pub(crate) fn measurements(&self) -> usize {
        self.update.nu.len()
    }

    /// Squared joint innovation of measurement `i`.
    pub(crate) fn squared_innovation(&mut self, i: usize) -> Id {
        self.g.mul(self.update.nu[i], self.update.nu[i])
    }

    /// Diagonal entry `i` of the joint S.
    pub(crate) fn innovation_variance(&self, i: usize) -> Id {
        self.update.S_diagonal[i]
    }

    /// Decorrelated innovation variance `i`; det S is their product.
    pub(crate) fn pivot(&self, i: usize) -> Id {
        self.update.pivots[i]
    }

    /// Share `i` of the NIS, 0 where missing.
    pub(crate) fn nis(&self, i: usize) -> Id {
        self.update.nis[i]
    }

    /// Number of states, n.
    pub(crate) fn states(&self) -> usize {
        self.x.len()
    }

    /// A number per row, as a node.
    pub(crate) fn weight(&mut self, weight: impl Fn(Place<'_>) -> f64) -> Id {
        self.columns.node(self.g, self.rows.places().map(weight).collect())
    }

    /// Sums of a number per row, one a trajectory.
    pub(crate) fn counts(&self, count: impl Fn(Place<'_>) -> f64) -> Vec<f64> {
        let mut counts = vec![0.0; self.rows.log.trajectories.len()];
        self.rows.places().for_each(|place| counts[place.index] += count(place));
        counts
    }

    /// The last `window` rows of each trajectory that update the filter, those before `skip` left out.
    pub(crate) fn last_measured(&self, skip: usize, window: usize) -> Window {
        let mut measured = vec![Vec::new(); self.rows.log.trajectories.len()];
        for place in self.rows.places().filter(|place| place.k >= skip && place.components() > 0) {
            measured[place.index].push(place.k);
        }
        let begin =
            |rows: &Vec<usize>| rows.get(rows.len().saturating_sub(window.max(1))).copied().unwrap_or(usize::MAX);
        Window(measured.iter().map(begin).collect())
    }

    /// Sum of nodes.
    pub(crate) fn total(&mut self, parts: &[Id]) -> Id {
        let zero = self.g.constant(0.0);
        parts.iter().fold(zero, |sum, part| self.g.add(sum, *part))
    }

    /// Column of the truth table that belongs to state `i`.
    pub(crate) fn truth_column(&self, i: usize) -> Option<usize> {
        self.rows.log.truth.iter().position(|name| *name == self.problem.model.states[i])
    }

    /// Posterior error x - truth of state `i`, meaningless where the truth is unknown.
    pub(crate) fn error(&mut self, i: usize) -> Id {
        let column = self.truth_column(i);
        let truth =
            self.weight(|place| column.map_or(0.0, |c| Some(place.truth(c)).filter(|t| !t.is_nan()).unwrap_or(0.0)));
        match self.nominal {
            None => self.g.sub(self.x[i], truth),
            Some(nominal) => {
                let nominal = self.columns.node(self.g, nominal.at(i));
                let truth = self.g.sub(truth, nominal);
                self.g.sub(self.x[i], truth)
            }
        }
    }

    /// Sum of the squared errors of some states.
    pub(crate) fn squared_error(&mut self, states: &[usize]) -> Id {
        let errors: Vec<Id> = states.iter().map(|i| self.error(*i)).collect();
        self.g.dot(errors.iter().map(|e| (*e, *e)))
    }

    /// Square root of a node.
    pub(crate) fn sqrt(&mut self, a: Id) -> Id {
        self.g.unary(Unary::Sqrt, a)
    }

    /// Normalised squared posterior error e' P^-1 e of all states where `gate` is positive, else 0. There P must be positive
    /// definite.
    pub(crate) fn normalised_error(&mut self, gate: Id) -> Id {
        let errors: Vec<Id> = (0..self.states()).map(|i| self.error(i)).collect();
        let (square, pivots) = self.p.normalised_square(self.g, &errors);
        let (zero, one) = (self.g.constant(0.0), self.g.constant(1.0));
        for pivot in pivots {
            let positive = self.g.select(gate, pivot, one);
            self.positive.push(positive);
        }
        self.g.select(gate, square, zero)
    }

    /// Adds `weight * value` up over the rows of a trajectory; the slot of the sum.
    pub(crate) fn sum(&mut self, value: Id, weight: Id) -> usize {
        let value = self.g.mul(value, weight);
        self.total_of(value)
    }

    /// Adds `value` up over the rows of a trajectory; the slot of the sum.
    pub(crate) fn total_of(&mut self, value: Id) -> usize {
        self.slot(Role::Sum, value)
    }

    /// Multiplies `value` up over the rows where `gate` is positive; the slot holds the logarithm of the product, which
    /// stays 0 once a factor was not positive.
    pub(crate) fn log_product(&mut self, value: Id, gate: Id) -> usize {
        let one = self.g.constant(1.0);
        let value = self.g.unary(Unary::Positive, value);
        let factor = self.g.select(gate, value, one);
        self.slot(Role::Product, factor)
    }

    fn slot(&mut self, role: Role, value: Id) -> usize {
        self.sums.iter().position(|s| *s == (role, value)).unwrap_or_else(|| {
            self.sums.push((role, value));
            self.sums.len() - 1
        })
    }
}

/// The sums of one objective after a run.
pub(crate) struct Pools<'a> {
    /// Trajectories x slots of the program.
    pub(super) sums: &'a [f64],
    /// Slots of the program.
    pub(super) width: usize,
    pub(super) traced: &'a Traced,
}

impl Pools<'_> {
    /// The objective's sum `j` in trajectory `t`.
    pub(crate) fn of(&self, t: usize, j: usize) -> f64 {
        self.sums[t * self.width + self.traced.slots[j]]
    }

    /// The objective's sum `j`, pooled.
    pub(crate) fn total(&self, j: usize) -> f64 {
        (0..self.traced.counts.len()).map(|t| self.of(t, j)).sum()
    }

    /// Number of sums.
    pub(crate) fn len(&self) -> usize {
        self.traced.slots.len()
    }

    /// The objective's count in each trajectory.
    pub(crate) fn counts(&self) -> &[f64] {
        &self.traced.counts
    }

    /// The count, pooled.
    pub(crate) fn count(&self) -> f64 {
        self.traced.counts.iter().sum()
    }
}
