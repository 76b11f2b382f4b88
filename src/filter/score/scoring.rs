//! What objectives see of a filter while it is traced, and of its sums when it has run.

use crate::filter::columns::{Columns, Key, Place, Rows};
use crate::filter::covariance::Covariance;
use crate::filter::kalman::Update;
use crate::filter::nominal::Nominal;
use crate::filter::program::Role;
use crate::filter::units::Units;
use crate::model::Problem;
use crate::tape::{Graph, Id, Unary};
use std::f64::consts::LN_2;

/// Offers one row of the traced filter to the objectives and collects their sums.
pub(crate) struct Scoring<'a> {
    pub(in crate::filter) g: &'a mut Graph,
    pub(in crate::filter) columns: &'a mut Columns,
    pub(in crate::filter) rows: &'a Rows<'a>,
    pub(in crate::filter) problem: &'a Problem,
    pub(in crate::filter) nominal: Option<&'a Nominal>,
    pub(in crate::filter) units: &'a Units,
    pub(in crate::filter) update: &'a Update,
    pub(in crate::filter) x: &'a [Id],
    pub(in crate::filter) p: &'a Covariance,
    pub(in crate::filter) sums: &'a mut Vec<(Role, Id)>,
    /// What a candidate fails without.
    pub(in crate::filter) positive: &'a mut Vec<Id>,
    /// Which scorer is being traced, and how many of its columns there are so far: the same in every round of refinement.
    pub(in crate::filter) asked: (usize, usize),
}

/// A node in units of 2^`exponent` of the problem's own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scaled {
    id: Id,
    exponent: i32,
}

/// What becomes of the total in a slot of the program: `factor * total + offset`, exactly 1 and 0 where the filter computes
/// in the problem's own units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum {
    slot: usize,
    factor: f64,
    offset: f64,
}

/// The sums of one objective, and over how much they run.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Traced {
    /// In the objective's own order.
    pub(crate) sums: Vec<Sum>,
    /// The objective's count (components, rows), one a trajectory.
    pub(crate) counts: Vec<f64>,
}

impl<'a> Scoring<'a> {
    /// Number of measurements, m.
    pub(crate) fn measurements(&self) -> usize {
        self.update.nu.len()
    }

    /// Squared joint innovation of measurement `i`.
    pub(crate) fn squared_innovation(&mut self, i: usize) -> Scaled {
        let id = self.g.mul(self.update.nu[i], self.update.nu[i]);
        self.variance(i, id)
    }

    /// Diagonal entry `i` of the joint S.
    pub(crate) fn innovation_variance(&self, i: usize) -> Scaled {
        self.variance(i, self.update.S_diagonal[i])
    }

    /// Decorrelated innovation variance `i`; det S is their product.
    pub(crate) fn pivot(&self, i: usize) -> Scaled {
        self.variance(i, self.update.pivots[i])
    }

    /// In the squared unit of measurement `i`.
    fn variance(&self, i: usize, id: Id) -> Scaled {
        Scaled { id, exponent: 2 * self.units.measurements[i] }
    }

    /// The NIS of the row: the sum of its shares, 0 where missing.
    pub(crate) fn nis(&mut self) -> Scaled {
        let zero = self.g.constant(0.0);
        let id = self.update.nis.iter().fold(zero, |sum, part| self.g.add(sum, *part));
        Scaled { id, exponent: 0 }
    }

    /// Number of states, n.
    pub(crate) fn states(&self) -> usize {
        self.x.len()
    }

    /// The rows that are scored.
    pub(crate) const fn rows(&self) -> &'a Rows<'a> {
        self.rows
    }

    fn next_key(&mut self) -> (usize, usize) {
        self.asked.1 += 1;
        self.asked
    }

    /// A number per row, as a node.
    pub(crate) fn weight(&mut self, weight: impl Fn(Place<'_>) -> f64) -> Id {
        let (scorer, part) = self.next_key();
        let rows = self.rows;
        self.columns.node(self.g, Key::Weight(scorer, part), || rows.places().map(weight).collect())
    }

    /// Sums of a number per row, one a trajectory.
    pub(crate) fn counts(&mut self, count: impl Fn(Place<'_>) -> f64) -> Vec<f64> {
        let key = self.next_key();
        let rows = self.rows;
        self.columns.counts(key, || {
            let mut counts = vec![0.0; rows.log.trajectories.len()];
            rows.places().for_each(|place| counts[place.index] += count(place));
            counts
        })
    }

    /// Column of the truth table that belongs to state `i`.
    pub(crate) fn truth_column(&self, i: usize) -> Option<usize> {
        self.rows.log.truth.iter().position(|name| *name == self.problem.model.states[i])
    }

    /// Posterior error x - truth of state `i`, meaningless where the truth is unknown.
    pub(crate) fn error(&mut self, i: usize) -> Id {
        let (column, rows) = (self.truth_column(i), self.rows);
        let known =
            |place: Place<'_>| column.map_or(0.0, |c| Some(place.truth(c)).filter(|t| !t.is_nan()).unwrap_or(0.0));
        let mut truth = self.columns.node(self.g, Key::Truth(i), || rows.places().map(known).collect());
        if let Some(nominal) = self.nominal {
            let nominal = self.columns.node(self.g, Key::Nominal(i), || nominal.at(i));
            truth = self.g.sub(truth, nominal);
        }
        truth = self.g.scale(truth, -self.units.states[i]);
        self.g.sub(self.x[i], truth)
    }

    /// Sum of the squared errors of some states, in the largest of their units.
    pub(crate) fn squared_error(&mut self, states: &[usize]) -> Scaled {
        let unit = states.iter().map(|i| self.units.states[*i]).max().unwrap_or(0);
        let error = |i: &usize| {
            let error = self.error(*i);
            self.g.scale(error, self.units.states[*i] - unit)
        };
        let errors: Vec<Id> = states.iter().map(error).collect();
        Scaled { id: self.g.dot(errors.iter().map(|e| (*e, *e))), exponent: 2 * unit }
    }

    /// Square root of a squared error.
    pub(crate) fn sqrt(&mut self, a: Scaled) -> Scaled {
        Scaled { id: self.g.unary(Unary::Sqrt, a.id), exponent: a.exponent / 2 }
    }

    /// Normalised squared posterior error e' P^-1 e of all states where `gate` is positive, else 0. There P must be positive
    /// definite.
    pub(crate) fn normalised_error(&mut self, gate: Id) -> Scaled {
        let errors: Vec<Id> = (0..self.states()).map(|i| self.error(i)).collect();
        let (square, pivots) = self.p.normalised_square(self.g, &errors);
        let (zero, one) = (self.g.constant(0.0), self.g.constant(1.0));
        for pivot in pivots {
            let positive = self.g.select(gate, pivot, one);
            self.positive.push(positive);
        }
        Scaled { id: self.g.select(gate, square, zero), exponent: 0 }
    }

    /// Adds `weight * value` up over the rows of a trajectory.
    pub(crate) fn sum(&mut self, value: Scaled, weight: Id) -> Sum {
        let id = self.g.mul(value.id, weight);
        self.total_of(Scaled { id, ..value })
    }

    /// Adds `value` up over the rows of a trajectory.
    pub(crate) fn total_of(&mut self, value: Scaled) -> Sum {
        let slot = self.slot(Role::Sum, value.id);
        Sum { slot, factor: 2.0_f64.powi(value.exponent), offset: 0.0 }
    }

    /// Multiplies `value` up over the rows where `gate`, 0 or 1, is positive; the slot holds the logarithm of the product,
    /// which stays 0 once a factor was not positive.
    pub(crate) fn log_product(&mut self, value: Scaled, gate: Id) -> Sum {
        let one = self.g.constant(1.0);
        let positive = self.g.unary(Unary::Positive, value.id);
        let factor = self.g.select(gate, positive, one);
        let factors = self.columns.sum(self.g, gate, self.rows.len());
        let slot = self.slot(Role::Product, factor);
        Sum { slot, factor: 1.0, offset: factors * f64::from(value.exponent) * LN_2 }
    }

    fn slot(&mut self, role: Role, value: Id) -> usize {
        self.sums.iter().position(|s| *s == (role, value)).unwrap_or_else(|| {
            self.sums.push((role, value));
            self.sums.len() - 1
        })
    }
}

/// The totals of a run that one objective reads: of one trajectory, or pooled over all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pools<'a> {
    /// One a slot of the program.
    pub(in crate::filter) totals: &'a [f64],
    /// What [`Objective::of_trajectory`](crate::objective::Objective::of_trajectory) gave, summed over the trajectories.
    pub(in crate::filter) folded: f64,
    pub(in crate::filter) traced: &'a Traced,
}

impl Pools<'_> {
    /// The objective's sum `j`, in the problem's own units.
    pub(crate) fn total(&self, j: usize) -> f64 {
        let Sum { slot, factor, offset } = self.traced.sums[j];
        factor * self.totals[slot] + offset
    }

    /// Number of sums.
    pub(crate) fn len(&self) -> usize {
        self.traced.sums.len()
    }

    /// What was worked out for each trajectory, summed over them.
    pub(crate) const fn folded(&self) -> f64 {
        self.folded
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
