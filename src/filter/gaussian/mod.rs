//! Filters that carry one gaussian: a moment rule, one measurement update, and what adapts Q or R on the way.
#![expect(non_snake_case, reason = "Kalman notation: F, H, P, Q, R")]

pub(super) mod adapt;
mod innovation;
pub(super) mod moments;
mod point;
mod robust;
mod update;

use super::carried::narrow;
use super::covariance::{Covariance, Symmetric};
use super::error::TraceError;
use super::evidence::{self, Evidence, Factor, Likelihood};
use super::family::{Family, Predicted};
use super::form::{Carrying, Form};
use super::nodes::ModelNodes;
use super::row::Row;
use super::tracer::Tracer;
use super::units::{self, scaled};
use crate::model::{First, Model, Robust};
use crate::tape::{Graph, Id, Leaf};
use adapt::{Adaptation, Noise, Seen, in_range};
use innovation::Innovation;
use moments::{Map, MomentRule, Moments};
use robust::{Outcome, Plain};
use update::{Measurement, Update, Updated};

/// A gaussian filter: mean, covariance in the form it is carried in, and the memory of what adapts.
pub(super) struct Gaussian<M, A> {
    carrying: Carrying,
    rule: M,
    adaptation: A,
    /// How updates withstand outliers, where they do.
    robust: Option<Robust>,
}

/// What is carried, unpacked.
struct State {
    x: Vec<Id>,
    P: Covariance,
    memory: Vec<Id>,
}

impl<M: MomentRule, A: Adaptation> Gaussian<M, A> {
    pub(super) const fn new(carrying: Carrying, rule: M, adaptation: A) -> Self {
        Self { carrying, rule, adaptation, robust: None }
    }

    /// The same with robust updates.
    pub(super) fn with(self, robust: Option<&Robust>) -> Self {
        Self { robust: robust.cloned(), ..self }
    }

    fn unpack(&self, g: &mut Graph, n: usize, entries: &[Id]) -> State {
        let (x, rest) = entries.split_at(n);
        let (P, memory) = rest.split_at(n * (n + 1) / 2);
        let P = Covariance::from_entries(g, self.carrying.form, n, P);
        State { x: x.to_vec(), P, memory: memory.to_vec() }
    }

    /// Q and R of a row: the model's, or what they have been adapted to.
    fn noise(&self, t: &mut Tracer<'_>, model: &ModelNodes, memory: &[Id]) -> Noise {
        let mut noise = Noise::of(t, model);
        self.adaptation.adopt(&mut t.g, self.carrying.form, memory, &mut noise);
        noise
    }

    /// The time update: x <- E f(x), P <- F P F' + excess + Q.
    fn step(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        State { x, P, .. }: &State,
        Q: Covariance,
    ) -> Result<Stepped, TraceError> {
        let moments = self.rule.through(t, row, Map::Transition, x, P)?;
        let next = moments.mean(&mut t.g);
        let Moments { jacobian, excess, columns, positive, .. } = moments;
        let P = match (columns, excess) {
            (None, None) => P.propagate(&mut t.g, &jacobian, &Q),
            (None, Some(excess)) => {
                let Q = Covariance::Full(Q.matrix(&mut t.g).plus(&mut t.g, &excess));
                P.propagate(&mut t.g, &jacobian, &Q)
            }
            (Some(columns), Some(excess)) if self.carrying.form == Form::Full => {
                let Q = Covariance::Full(Q.matrix(&mut t.g).plus(&mut t.g, &excess));
                P.gathered(&mut t.g, &columns.linear, &Q)
            }
            (Some(columns), _) => P.gathered(&mut t.g, &[columns.linear, columns.excess].concat(), &Q),
        };
        Ok(Stepped { x: next, P, positive })
    }

    /// The measurement of a row as it is seen from `at`, against the prior; and what that fails without.
    fn measurement(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        (State { P, .. }, at): (&State, &[Id]),
        R: &Symmetric,
    ) -> Result<(Measurement, Vec<Id>), TraceError> {
        let moments = self.rule.through(t, row, Map::Measurement, at, P)?;
        let Innovation { z, nu } = Innovation::new(t, row, &moments);
        let Moments { jacobian: H, excess, positive, .. } = moments;
        let R = match excess {
            None => R.clone(),
            Some(excess) => R.plus(&mut t.g, &excess),
        };
        let (present, anchored) = (row.present.clone(), self.carrying.anchored);
        Ok((Measurement { H, R, nu, z, present, anchored }, positive))
    }

    /// The update of a prior, linearised as often as the rule says: the evidence is that of the first time, where the prior is.
    fn updated(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        state: &State,
        R: &Symmetric,
    ) -> Result<(Measurement, Vec<Id>, Updated), TraceError> {
        let (measurement, positive) = self.measurement(t, row, (state, &state.x), R)?;
        let threshold = robust::by_component(self.robust.as_ref(), t, row);
        let mut by_nis = threshold.map(|k| move |g: &mut Graph, _: usize, nis: Id| robust::huber_weight(g, k, nis));
        let weigh = by_nis.as_mut().map(|weigh| weigh as &mut dyn FnMut(&mut Graph, usize, Id) -> Id);
        let mut updated = measurement.update_by(&mut t.g, &state.x, &state.P, weigh);
        for _ in 1..self.rule.iterations(row) {
            let (_, at, _) = &updated;
            let (mut again, _) = self.measurement(t, row, (state, at), R)?;
            // z - h(x_i) - H_i (x - x_i): what the prior x would be off if h were its tangent at x_i.
            for (nu, H) in again.nu.iter_mut().zip(&again.H) {
                let seen = t.g.dot(H.iter().copied().zip(updated.0.correction.iter().copied()));
                *nu = t.g.add(*nu, seen);
            }
            // What a component counts is known from the first time.
            let weights = updated.0.weights.clone();
            let mut known = (!weights.is_empty()).then_some(|_: &mut Graph, i: usize, _: Id| weights[i]);
            let weigh = known.as_mut().map(|weigh| weigh as &mut dyn FnMut(&mut Graph, usize, Id) -> Id);
            let (update, x, P) = again.update_by(&mut t.g, &state.x, &state.P, weigh);
            updated = (Update { correction: update.correction, gains: update.gains, ..updated.0 }, x, P);
        }
        Ok((measurement, positive, updated))
    }

    /// nu' S^-1 nu by the joint S, also where components have been weighed one by one.
    fn nis(&self, t: &mut Tracer<'_>, measurement: &Measurement, state: &State, update: &Update) -> Id {
        let zero = t.g.constant(0.0);
        let joint = (!update.weights.is_empty()).then(|| measurement.update_by(&mut t.g, &state.x, &state.P, None).0);
        let shares = &joint.as_ref().unwrap_or(update).nis;
        shares.iter().fold(zero, |sum, share| t.g.add(sum, *share))
    }
}

/// The update as it is: the likelihood is gaussian.
fn plainly((update, x, P): &Updated, nis: Id, memory: Vec<Id>) -> Outcome {
    let factor = |(component, pivot): (usize, &Id)| Factor { value: *pivot, component };
    let factors = update.pivots.iter().enumerate().map(factor).collect();
    let likelihood = Likelihood { exponent: nis, factors, powers: vec![] };
    Outcome { x: x.clone(), P: P.clone(), memory, likelihood, rejected: None, positive: vec![] }
}

/// Mean and covariance after a time update, and what that fails without.
struct Stepped {
    x: Vec<Id>,
    P: Covariance,
    positive: Vec<Id>,
}

impl<M: MomentRule, A: Adaptation> Family for Gaussian<M, A> {
    fn names(&self, model: &Model) -> Vec<String> {
        let x = model.states.iter().map(|state| format!("x.{state}"));
        let P = Covariance::names(self.carrying.form, &model.states);
        let memory = self.adaptation.names(self.carrying.form, model);
        x.chain(P).chain(memory).chain(robust::names(self.robust.as_ref())).collect()
    }

    fn opaque(&self, model: &Model) -> usize {
        self.adaptation.opaque(model) + robust::names(self.robust.as_ref()).len()
    }

    fn start(&self, t: &mut Tracer<'_>) -> Result<Vec<Id>, TraceError> {
        let (n, form) = (t.problem.model.states.len(), self.carrying.form);
        let first = first_interval(t);
        let model = ModelNodes::at(t, None, first)?;
        let x = match &model.x0 {
            Some(x0) => x0.clone(),
            None => (0..n).map(|i| t.g.leaf(Leaf::Start(narrow(i)))).collect(),
        };
        let mut x = scaled(&mut t.g, &x, &t.units.states);
        let P = units::covariance(&mut t.g, &model.P0, &t.units.states);
        let mut P = Covariance::new(&mut t.g, form, P);
        if let First::Predict { dt } = t.problem.model.first {
            let dt = dt.or_else(|| t.rows.log.regular_dt()).ok_or(TraceError::NoFirstInterval)?;
            let dt = t.g.constant(dt);
            let row = Row { model: ModelNodes::at(t, None, dt)?, nominal: None, z: vec![], present: vec![] };
            let Q = Noise::of(t, &row.model).Q;
            let stepped = self.step(t, &row, &State { x, P, memory: vec![] }, Q)?;
            (x, P) = (stepped.x, stepped.P);
        }
        if t.nominal.is_some() {
            for (i, x) in x.iter_mut().enumerate() {
                let nominal = t.g.leaf(Leaf::Start(narrow(n + i)));
                let nominal = t.g.scale(nominal, -t.units.states[i]);
                *x = t.g.sub(*x, nominal);
            }
        }
        let noise = Noise::of(t, &model);
        let memory = self.adaptation.start(&mut t.g, form, noise);
        let rejected = robust::start(&mut t.g, self.robust.as_ref());
        Ok([x, P.entries(), memory, rejected].concat())
    }

    fn update(&self, t: &mut Tracer<'_>, row: &Row, prior: &[Id]) -> Result<(Evidence, Vec<Id>), TraceError> {
        let n = t.problem.model.states.len();
        let state = self.unpack(&mut t.g, n, prior);
        let noise = self.noise(t, &row.model, &state.memory);
        let (measurement, positive, updated) = self.updated(t, row, &state, &noise.R)?;
        let (nis, update) = (self.nis(t, &measurement, &state, &updated.0), &updated.0);
        let seen = Seen { measurement: &measurement, update, prior: &state.P };
        let Outcome { x, P, memory, likelihood, rejected, positive: more } = match &self.robust {
            None => {
                let memory = self.adaptation.adapt(t, self.carrying.form, row, state.memory, &seen);
                plainly(&updated, nis, memory)
            }
            Some(robust) => {
                let (posterior, form) = ((updated.1.clone(), updated.2.clone()), self.carrying.form);
                let plain = Plain { prior: (&state.x, &state.P), update, posterior, form };
                robust::update(robust, t, row, plain, state.memory)
            }
        };
        let positive = [positive, in_range(t, &row.model.settings), more].concat();
        let posterior = [x.clone(), P.entries(), memory].concat();
        let alone = (0..n).map(|i| measurement.alone(&t.g, i)).collect();
        let evidence = Evidence {
            innovation: measurement.nu,
            spread: updated.0.S_diagonal,
            likelihood,
            nis: Some(nis),
            rejected,
            state: x,
            covariance: P,
            alone,
            positive,
            seen: evidence::Seen { H: measurement.H, R: measurement.R },
        };
        Ok((evidence, posterior))
    }

    fn predict(&self, t: &mut Tracer<'_>, row: &Row, posterior: &[Id]) -> Result<Predicted, TraceError> {
        let n = t.problem.model.states.len();
        let state = self.unpack(&mut t.g, n, posterior);
        let noise = self.noise(t, &row.model, &state.memory);
        let Stepped { x, P, positive } = self.step(t, row, &state, noise.Q)?;
        Ok(Predicted { prior: [x, P.entries(), state.memory].concat(), positive })
    }

    fn advance(&self, t: &mut Tracer<'_>, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError> {
        point::advance(t, &self.rule, row, x)
    }

    fn residual(&self, t: &mut Tracer<'_>, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError> {
        point::residual(t, &self.rule, row, x)
    }
}

/// The interval after the first used row, which the first Q is for: one number where all trajectories agree.
fn first_interval(t: &mut Tracer<'_>) -> Id {
    let mut intervals = t.rows.first_intervals().into_iter();
    let first = intervals.next().unwrap_or(1.0);
    if intervals.all(|dt| dt.to_bits() == first.to_bits()) {
        return t.g.constant(first);
    }
    let n = t.problem.model.states.len();
    let place = if t.nominal.is_some() { 2 * n } else { n };
    t.g.leaf(Leaf::Start(narrow(place)))
}

#[cfg(test)]
mod tests;
