//! What objectives see of a filter while it is traced.

use super::sums::{Mean, Sum};
use crate::filter::carried::Role;
use crate::filter::columns::Key;
use crate::filter::evidence::{Evidence, Factor, Power};
use crate::filter::leads::Leads;
use crate::filter::memory::{Memo, Recall};
use crate::filter::rows::{Place, Rows};
use crate::filter::tracer::Tracer;
use crate::tape::{Graph, Id, Unary};
use std::f64::consts::LN_2;

/// Offers one row of the traced filter to the objectives and collects their sums.
pub(crate) struct Scoring<'a, 'b> {
    t: &'a mut Tracer<'b>,
    evidence: &'a Evidence,
    leads: &'a Leads,
    recall: Recall<'a>,
    sums: Vec<(Role, Id)>,
    /// What a candidate fails without.
    positive: Vec<Id>,
    /// Which scorer is being traced, and how many of its columns there are so far: the same in every round of refinement.
    asked: (usize, usize),
}

/// How much each row counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Weight {
    id: Id,
    /// Over all rows of the log.
    total: f64,
}

impl Weight {
    /// Whether any row of the log counts.
    pub(crate) fn counts_any(self) -> bool {
        self.total > 0.0
    }
}

/// A node in units of 2^`exponent` of the problem's own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scaled {
    id: Id,
    exponent: i32,
}

impl<'a, 'b> Scoring<'a, 'b> {
    pub(in crate::filter) fn new(
        t: &'a mut Tracer<'b>,
        evidence: &'a Evidence,
        leads: &'a Leads,
        recall: Recall<'a>,
    ) -> Self {
        let factors = evidence.likelihood.factors.iter().map(|factor| factor.value);
        let positive = factors.chain(evidence.positive.iter().copied()).collect();
        Self { t, evidence, leads, recall, sums: vec![], positive, asked: (0, 0) }
    }

    /// For scorer number `scorer`.
    pub(in crate::filter) const fn asked_by(&mut self, scorer: usize) -> &mut Self {
        self.asked = (scorer, 0);
        self
    }

    /// What is summed up, what a candidate fails without, and what is remembered.
    pub(in crate::filter) fn finish(self) -> (Vec<(Role, Id)>, Vec<Id>, Vec<Id>) {
        (self.sums, self.positive, self.recall.finish())
    }

    /// Number of measurements, m.
    pub(crate) const fn measurements(&self) -> usize {
        self.evidence.innovation.len()
    }

    /// Squared joint innovation of measurement `i`.
    pub(crate) fn squared_innovation(&mut self, i: usize) -> Scaled {
        let innovation = self.evidence.innovation[i];
        let id = self.t.g.mul(innovation, innovation);
        self.variance(i, id)
    }

    /// Squared error of what was predicted of measurement `i` from so many rows `ahead` of it; 1 is the innovation.
    pub(crate) fn squared_prediction_error(&mut self, ahead: usize, i: usize) -> Scaled {
        let nan = self.t.g.constant(f64::NAN);
        let error = match ahead {
            1 => self.evidence.innovation[i],
            _ => self.leads.error(ahead).map_or(nan, |error| error[i]),
        };
        let id = self.t.g.mul(error, error);
        self.variance(i, id)
    }

    /// Diagonal entry `i` of the joint S.
    pub(crate) fn innovation_variance(&self, i: usize) -> Scaled {
        self.variance(i, self.evidence.spread[i])
    }

    /// nu / sqrt(S) of measurement `i` in the rows that count, else 0.
    pub(crate) fn standardised_innovation(&mut self, i: usize, rows: Weight) -> Scaled {
        let g = &mut self.t.g;
        let [zero, one] = [0.0, 1.0].map(|value| g.constant(value));
        // Where it is missing, S may be anything.
        let spread = g.select(rows.id, self.evidence.spread[i], one);
        let deviation = g.unary(Unary::Sqrt, spread);
        let ratio = g.div(self.evidence.innovation[i], deviation);
        Scaled { id: g.select(rows.id, ratio, zero), exponent: 0 }
    }

    /// What is remembered of earlier rows.
    pub(crate) fn recall(&mut self, memo: Memo) -> Scaled {
        let nan = self.t.g.constant(f64::NAN);
        Scaled { id: self.recall.get(memo).unwrap_or(nan), exponent: 0 }
    }

    /// Remembers a number without a unit.
    pub(crate) fn remember(&mut self, memo: Memo, value: Scaled) {
        self.recall.set(memo, value.id);
    }

    /// In the squared unit of measurement `i`.
    fn variance(&self, i: usize, id: Id) -> Scaled {
        Scaled { id, exponent: 2 * self.t.units.measurements[i] }
    }

    /// The factors of the likelihood of the row, each with the component of the measurement that it stands for.
    pub(crate) fn factors(&self) -> Vec<(usize, Scaled)> {
        let factor = |factor: &Factor| (factor.component, self.variance(factor.component, factor.value));
        self.evidence.likelihood.factors.iter().map(factor).collect()
    }

    /// What counts with a power of its own in the likelihood of the row.
    pub(crate) fn powers(&self) -> Vec<(Scaled, Id)> {
        let power = |power: &Power| (Scaled { id: power.value, exponent: 0 }, power.power);
        self.evidence.likelihood.powers.iter().map(power).collect()
    }

    /// The exponent of the likelihood of the row, times -2; 0 where nothing is measured.
    pub(crate) const fn exponent(&self) -> Scaled {
        Scaled { id: self.evidence.likelihood.exponent, exponent: 0 }
    }

    /// The NIS of the row, 0 where nothing is measured.
    pub(crate) fn nis(&mut self) -> Scaled {
        let nan = self.t.g.constant(f64::NAN);
        Scaled { id: self.evidence.nis.unwrap_or(nan), exponent: 0 }
    }

    /// One less the weight of the row, 0 where nothing is measured.
    pub(crate) fn rejected(&mut self) -> Scaled {
        let zero = self.t.g.constant(0.0);
        Scaled { id: self.evidence.rejected.unwrap_or(zero), exponent: 0 }
    }

    /// Number of states, n.
    pub(crate) fn states(&self) -> usize {
        self.evidence.state.len()
    }

    /// The rows that are scored.
    pub(crate) const fn rows(&self) -> &'b Rows<'b> {
        self.t.rows
    }

    fn next_key(&mut self) -> (usize, usize) {
        self.asked.1 += 1;
        self.asked
    }

    /// How much each row counts.
    pub(crate) fn weight(&mut self, weight: impl Fn(Place<'_>) -> f64) -> Weight {
        let (scorer, part) = self.next_key();
        let key = Key::Weight(scorer, part);
        let id = self.t.column(key, weight);
        Weight { id, total: self.t.columns.total(key, self.t.rows.len()) }
    }

    /// Functions of a number that has no unit.
    pub(crate) fn map<const N: usize>(&mut self, a: Scaled, f: impl FnOnce(&mut Graph, Id) -> [Id; N]) -> [Scaled; N] {
        f(&mut self.t.g, a.id).map(|id| Scaled { id, ..a })
    }

    /// `a` in the rows that count, elsewhere `b`, both in one unit.
    pub(crate) fn choose(&mut self, weight: Weight, a: Scaled, b: Scaled) -> Scaled {
        Scaled { id: self.t.g.select(weight.id, a.id, b.id), ..a }
    }

    /// Sums of a number per row, one a trajectory.
    pub(crate) fn counts(&mut self, count: impl Fn(Place<'_>) -> f64) -> Vec<f64> {
        let key = self.next_key();
        let rows = self.t.rows;
        self.t.columns.counts(key, || {
            let mut counts = vec![0.0; rows.log.trajectories.len()];
            rows.places().for_each(|place| counts[place.index] += count(place));
            counts
        })
    }

    /// Column of the truth table that belongs to state `i`.
    pub(crate) fn truth_column(&self, i: usize) -> Option<usize> {
        self.t.rows.log.truth.iter().position(|name| *name == self.t.problem.model.states[i])
    }

    /// Posterior error x - truth of state `i`, meaningless where the truth is unknown.
    pub(crate) fn error(&mut self, i: usize) -> Id {
        let column = self.truth_column(i);
        let known =
            |place: Place<'_>| column.map_or(0.0, |c| Some(place.truth(c)).filter(|t| !t.is_nan()).unwrap_or(0.0));
        let t = &mut *self.t;
        let mut truth = t.column(Key::Truth(i), known);
        if let Some(nominal) = t.nominal {
            let nominal = t.columns.node(&mut t.g, Key::Nominal(i), || nominal.at(i));
            truth = t.g.sub(truth, nominal);
        }
        if t.problem.model.angles.state(i) {
            // What is the same for all candidates is wrapped in f64.
            truth = t.g.unary(Unary::Wrap, truth);
            let error = t.g.sub(self.evidence.state[i], truth);
            return t.g.unary(Unary::Wrap, error);
        }
        truth = t.g.scale(truth, -t.units.states[i]);
        t.g.sub(self.evidence.state[i], truth)
    }

    /// Sum of the squared errors of some states, in the largest of their units.
    pub(crate) fn squared_error(&mut self, states: &[usize]) -> Scaled {
        let unit = states.iter().map(|i| self.t.units.states[*i]).max().unwrap_or(0);
        let error = |i: &usize| {
            let error = self.error(*i);
            self.t.g.scale(error, self.t.units.states[*i] - unit)
        };
        let errors: Vec<Id> = states.iter().map(error).collect();
        Scaled { id: self.t.g.dot(errors.iter().map(|e| (*e, *e))), exponent: 2 * unit }
    }

    /// Square root of a squared error.
    pub(crate) fn sqrt(&mut self, a: Scaled) -> Scaled {
        Scaled { id: self.t.g.unary(Unary::Sqrt, a.id), exponent: a.exponent / 2 }
    }

    /// Normalised squared posterior error e' P^-1 e of all states where `gate` is positive, else 0. There P must be positive
    /// definite.
    pub(crate) fn normalised_error(&mut self, gate: Weight) -> Scaled {
        let errors: Vec<Id> = (0..self.states()).map(|i| self.error(i)).collect();
        let (square, pivots) = self.evidence.covariance.normalised_square(&mut self.t.g, &errors);
        let (zero, one) = (self.t.g.constant(0.0), self.t.g.constant(1.0));
        for pivot in pivots {
            let positive = self.t.g.select(gate.id, pivot, one);
            self.positive.push(positive);
        }
        Scaled { id: self.t.g.select(gate.id, square, zero), exponent: 0 }
    }

    /// Adds `weight * value` up over the rows of a trajectory.
    pub(crate) fn sum(&mut self, value: Scaled, weight: Weight) -> Sum {
        let id = self.t.g.mul(value.id, weight.id);
        self.total_of(Scaled { id, ..value })
    }

    /// Adds `value` up over the rows that count, in which alone it need be a number.
    pub(crate) fn sum_where(&mut self, value: Scaled, weight: Weight) -> Sum {
        let zero = self.t.g.constant(0.0);
        let id = self.t.g.select(weight.id, value.id, zero);
        self.total_of(Scaled { id, ..value })
    }

    /// Adds `value` up over the rows of a trajectory.
    pub(crate) fn total_of(&mut self, value: Scaled) -> Sum {
        let slot = self.slot(Role::Sum, value.id);
        Sum { slot, factor: 2.0_f64.powi(value.exponent), offset: 0.0, power: None }
    }

    /// Adds the product of two numbers without a unit up over the rows of a trajectory.
    pub(crate) fn total_product(&mut self, a: Scaled, b: Scaled) -> Sum {
        let id = self.t.g.mul(a.id, b.id);
        self.total_of(Scaled { id, exponent: 0 })
    }

    /// Multiplies `value` up over the rows where `gate`, 0 or 1, is positive; the slot holds the logarithm of the product,
    /// which stays 0 once a factor was not positive.
    pub(crate) fn log_product(&mut self, value: Scaled, gate: Weight) -> Sum {
        let one = self.t.g.constant(1.0);
        let positive = self.t.g.unary(Unary::Positive, value.id);
        let factor = self.t.g.select(gate.id, positive, one);
        let slot = self.slot(Role::Product, factor);
        Sum { slot, factor: 1.0, offset: gate.total * f64::from(value.exponent) * LN_2, power: None }
    }

    /// The same times `power`, which no row changes.
    pub(crate) fn log_power(&mut self, value: Scaled, power: Id, gate: Weight) -> Sum {
        let sum = self.log_product(value, gate);
        if let Some(power) = self.t.g.value(power) {
            return Sum { factor: power, offset: power * sum.offset, ..sum };
        }
        let slot = self.slot(Role::Sum, power);
        #[expect(clippy::cast_precision_loss, reason = "counts of rows stay far below 2^53")]
        let rows = self.t.rows.len() as f64;
        Sum { power: Some(Mean { slot, rows }), ..sum }
    }

    fn slot(&mut self, role: Role, value: Id) -> usize {
        self.sums.push((role, value));
        self.sums.len() - 1
    }
}
