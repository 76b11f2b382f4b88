//! Filters that carry one gaussian: a moment rule, one measurement update, and what adapts Q or R on the way.
#![expect(non_snake_case, reason = "Kalman notation: F, H, P, Q, R")]

pub(super) mod adapt;
pub(super) mod moments;
mod update;

use super::carried::narrow;
use super::covariance::{Covariance, Symmetric};
use super::error::TraceError;
use super::evidence::{Evidence, Factor};
use super::family::Family;
use super::form::Carrying;
use super::nodes::ModelNodes;
use super::row::Row;
use super::tracer::Tracer;
use super::units::{self, scaled};
use crate::model::{First, Model};
use crate::tape::{Graph, Id, Leaf};
use adapt::{Adaptation, Noise, Seen, in_range};
use moments::{Map, MomentRule, Moments};
use update::Measurement;

/// A gaussian filter: mean, covariance in the form it is carried in, and the memory of what adapts.
pub(super) struct Gaussian<M, A> {
    carrying: Carrying,
    rule: M,
    adaptation: A,
}

/// What is carried, unpacked.
struct State {
    x: Vec<Id>,
    P: Covariance,
    memory: Vec<Id>,
}

impl<M: MomentRule, A: Adaptation> Gaussian<M, A> {
    pub(super) const fn new(carrying: Carrying, rule: M, adaptation: A) -> Self {
        Self { carrying, rule, adaptation }
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
    fn step(&self, t: &mut Tracer<'_>, row: &Row, State { x, P, .. }: &State, Q: Covariance) -> Stepped {
        let Moments { fixed, moved, linear, jacobian, excess } = self.rule.through(t, row, Map::Transition, x, P)?;
        let mut next = Vec::with_capacity(x.len());
        for (linear, (fixed, moved)) in linear.iter().zip(fixed.iter().zip(&moved)) {
            let drift = t.g.add(*fixed, *moved);
            next.push(t.g.add(*linear, drift));
        }
        let Q = match excess {
            None => Q,
            Some(excess) => Covariance::Full(Q.matrix(&mut t.g).plus(&mut t.g, &excess)),
        };
        Ok((next, P.propagate(&mut t.g, &jacobian, &Q)))
    }

    /// The measurement of a row against a prior.
    fn measurement(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        State { x, P, .. }: &State,
        R: Symmetric,
    ) -> Result<Measurement, TraceError> {
        let Moments { fixed, moved, linear, jacobian: H, excess } =
            self.rule.through(t, row, Map::Measurement, x, P)?;
        let z = scaled(&mut t.g, &row.z, &t.units.measurements);
        let (mut free, mut nu) = (Vec::with_capacity(z.len()), Vec::with_capacity(z.len()));
        for (i, z) in z.into_iter().enumerate() {
            let z = t.g.sub(z, fixed[i]);
            let z = t.g.sub(z, moved[i]);
            free.push(z);
            nu.push(t.g.sub(z, linear[i]));
        }
        let R = match excess {
            None => R,
            Some(excess) => R.plus(&mut t.g, &excess),
        };
        Ok(Measurement { H, R, nu, z: free, present: row.present.clone(), anchored: self.carrying.anchored })
    }
}

/// Mean and covariance after a time update.
type Stepped = Result<(Vec<Id>, Covariance), TraceError>;

impl<M: MomentRule, A: Adaptation> Family for Gaussian<M, A> {
    fn names(&self, model: &Model) -> Vec<String> {
        let x = model.states.iter().map(|state| format!("x.{state}"));
        let P = Covariance::names(self.carrying.form, &model.states);
        x.chain(P).chain(self.adaptation.names(self.carrying.form, model)).collect()
    }

    fn opaque(&self, model: &Model) -> usize {
        self.adaptation.opaque(model)
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
            (x, P) = self.step(t, &row, &State { x, P, memory: vec![] }, Q)?;
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
        Ok([x, P.entries(), memory].concat())
    }

    fn update(&self, t: &mut Tracer<'_>, row: &Row, prior: &[Id]) -> Result<(Evidence, Vec<Id>), TraceError> {
        let n = t.problem.model.states.len();
        let state = self.unpack(&mut t.g, n, prior);
        let noise = self.noise(t, &row.model, &state.memory);
        let measurement = self.measurement(t, row, &state, noise.R)?;
        let (update, x, P) = measurement.update(&mut t.g, &state.x, &state.P);
        let seen = Seen { measurement: &measurement, update: &update, prior: &state.P };
        let memory = self.adaptation.adapt(t, self.carrying.form, row, state.memory, &seen);
        let positive = in_range(t, &row.model.settings);
        let posterior = [x.clone(), P.entries(), memory].concat();
        let alone = (0..n).map(|i| measurement.alone(&t.g, i)).collect();
        let zero = t.g.constant(0.0);
        let nis = update.nis.iter().fold(zero, |sum, share| t.g.add(sum, *share));
        let factor = |(component, pivot): (usize, &Id)| Factor { value: *pivot, component };
        let evidence = Evidence {
            innovation: measurement.nu,
            spread: update.S_diagonal,
            factors: update.pivots.iter().enumerate().map(factor).collect(),
            exponent: nis,
            nis: Some(nis),
            state: x,
            covariance: P,
            alone,
            positive,
        };
        Ok((evidence, posterior))
    }

    fn predict(&self, t: &mut Tracer<'_>, row: &Row, posterior: &[Id]) -> Result<Vec<Id>, TraceError> {
        let n = t.problem.model.states.len();
        let state = self.unpack(&mut t.g, n, posterior);
        let noise = self.noise(t, &row.model, &state.memory);
        let (x, P) = self.step(t, row, &state, noise.Q)?;
        Ok([x, P.entries(), state.memory].concat())
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
