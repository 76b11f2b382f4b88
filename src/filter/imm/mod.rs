//! The interacting multiple model filter: a filter a mode, mixed before every step by a Markov chain between the modes, weighed
//! by what is measured. Blom and Bar-Shalom (1988), doi 10.1109/9.1299; Bar-Shalom, Li and Kirubarajan (2001), section 11.6.
//!
//! A step is: update every mode, weigh, mix, predict every mode. What is carried is a gaussian a mode and the probabilities of
//! the modes, before the row by prediction alone.
#![expect(non_snake_case, reason = "Kalman notation: P, S")]

mod combined;
mod mixing;
mod weighing;

use super::covariance::{Covariance, Symmetric};
use super::error::TraceError;
use super::evidence::{Evidence, Power};
use super::family::{Family, Predicted};
use super::form::Form;
use super::formula::{self, Scope};
use super::gaussian::adapt::in_range;
use super::row::Row;
use super::tracer::Tracer;
use crate::model::{Expr, First, Model, Problem};
use crate::tape::{Graph, Id};
use weighing::Weighed;

/// One model with its filter.
pub(super) struct ModeFilter {
    pub(super) name: String,
    /// The problem with this model and filter alone.
    pub(super) problem: Problem,
    pub(super) family: Box<dyn Family>,
    /// In rows where it is not above 0 the mode is ruled out.
    pub(super) allowed: Option<Expr>,
}

/// The filter of all modes. P itself is carried: it is mixed.
pub(super) struct Imm {
    pub(super) modes: Vec<ModeFilter>,
    /// The chain, r x r by rows.
    pub(super) transition: Vec<Expr>,
    /// Probabilities before the first row, r.
    pub(super) start: Vec<Expr>,
}

/// The gaussian of a mode.
#[derive(Clone)]
struct State {
    x: Vec<Id>,
    P: Symmetric,
}

impl State {
    fn of(g: &mut Graph, n: usize, entries: &[Id]) -> Self {
        let (x, P) = entries.split_at(n);
        Self { x: x.to_vec(), P: Covariance::from_entries(g, Form::Full, n, P).matrix(g) }
    }

    fn entries(&self) -> Vec<Id> {
        [self.x.as_slice(), self.P.upper()].concat()
    }
}

impl Imm {
    /// Every mode's gaussian, and the probabilities.
    fn unpack(&self, t: &mut Tracer<'_>, entries: &[Id]) -> (Vec<State>, Vec<Id>) {
        let n = t.problem.model.states.len();
        let stride = n + n * (n + 1) / 2;
        let (states, probabilities) = entries.split_at(self.modes.len() * stride);
        (states.chunks(stride).map(|entries| State::of(&mut t.g, n, entries)).collect(), probabilities.to_vec())
    }

    /// Formulas of parameters, inputs and the interval `dt`.
    fn values<'e>(t: &mut Tracer<'_>, formulas: impl IntoIterator<Item = &'e Expr>, dt: Id) -> Vec<Id> {
        let (inputs, _) = t.inputs();
        let parameters = formula::parameters(&mut t.g, &t.problem.parameters, None);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &inputs, dt };
        formulas.into_iter().map(|formula| formula::trace(&mut t.g, formula, scope)).collect()
    }

    /// For each mode 1 where it is allowed in a row and 0 where it is ruled out; `None` for one that never is.
    fn allowed(&self, t: &mut Tracer<'_>) -> Vec<Option<Id>> {
        let (_, dt) = t.inputs();
        let (one, zero) = (t.g.constant(1.0), t.g.constant(0.0));
        let mask = |mode: &ModeFilter| {
            let value = *Self::values(t, &mode.allowed, dt).first()?;
            Some(t.g.select(value, one, zero))
        };
        self.modes.iter().map(mask).collect()
    }

    /// The prior of the next row from what is mixed: predictions of every mode, and the probabilities.
    fn predicted(&self, t: &mut Tracer<'_>, mixed: &[State], probabilities: Vec<Id>) -> Result<Predicted, TraceError> {
        let mut all = Predicted { prior: vec![], positive: vec![] };
        for (mode, state) in self.modes.iter().zip(mixed) {
            let Predicted { prior, positive } = t.on(&mode.problem, |t| {
                let row = Row::new(t)?;
                mode.family.predict(t, &row, &state.entries())
            })?;
            all.prior.extend(prior);
            all.positive.extend(positive);
        }
        all.prior.extend(probabilities);
        Ok(all)
    }
}

impl Family for Imm {
    fn names(&self, _: &Model) -> Vec<String> {
        let own = |mode: &ModeFilter| {
            let names = mode.family.names(&mode.problem.model).into_iter();
            names.map(|name| format!("{}.{name}", mode.name)).collect::<Vec<_>>()
        };
        let probabilities = self.modes.iter().map(|mode| format!("p.{}", mode.name));
        self.modes.iter().flat_map(own).chain(probabilities).collect()
    }

    fn modes(&self) -> usize {
        self.modes.len()
    }

    fn start(&self, t: &mut Tracer<'_>) -> Result<Vec<Id>, TraceError> {
        let mut entries = Vec::new();
        for mode in &self.modes {
            entries.extend(t.on(&mode.problem, |t| mode.family.start(t))?);
        }
        let none = t.g.constant(f64::NAN);
        let mut probabilities = Self::values(t, &self.start, none);
        if let First::Predict { dt } = t.problem.model.first {
            let dt = dt.or_else(|| t.rows.log.regular_dt()).ok_or(TraceError::NoFirstInterval)?;
            let dt = t.g.constant(dt);
            let chain = Self::values(t, &self.transition, dt);
            // All modes start from one gaussian, which mixing leaves as it is.
            probabilities = mixing::after_step(&mut t.g, &chain, &probabilities);
        }
        entries.extend(probabilities);
        Ok(entries)
    }

    fn update(&self, t: &mut Tracer<'_>, row: &Row, prior: &[Id]) -> Result<(Evidence, Vec<Id>), TraceError> {
        let (priors, probabilities) = self.unpack(t, prior);
        let n = t.problem.model.states.len();
        let (mut seen, mut posteriors) = (Vec::new(), Vec::new());
        for (mode, prior) in self.modes.iter().zip(&priors) {
            let (evidence, posterior) = t.on(&mode.problem, |t| {
                let row = Row::new(t)?;
                mode.family.update(t, &row, &prior.entries())
            })?;
            posteriors.push(State::of(&mut t.g, n, &posterior));
            seen.push(evidence);
        }
        let allowed = self.allowed(t);
        let Weighed { before, after, low, weight } = weighing::weighed(&mut t.g, &probabilities, &allowed, &seen);
        let mut evidence = combined::evidence(t, row, (&priors, &seen), &before, (&posteriors, &after));
        evidence.likelihood.exponent = low;
        // A density counts twice against -2 ln of it.
        let power = t.g.constant(-2.0);
        evidence.likelihood.powers.push(Power { value: weight, power });
        evidence.positive.push(weight);
        evidence.positive.extend(in_range(t, &row.model.settings));
        let entries = posteriors.iter().flat_map(State::entries);
        Ok((evidence, entries.chain(after).collect()))
    }

    fn predict(&self, t: &mut Tracer<'_>, _: &Row, posterior: &[Id]) -> Result<Predicted, TraceError> {
        let (states, probabilities) = self.unpack(t, posterior);
        let (_, dt) = t.inputs();
        let chain = Self::values(t, &self.transition, dt);
        let next = mixing::after_step(&mut t.g, &chain, &probabilities);
        let mixed = mixing::mixed(t, &chain, &states, &probabilities, &next);
        self.predicted(t, &mixed, next)
    }

    /// By the first mode: no objective that asks is allowed with several.
    fn advance(&self, t: &mut Tracer<'_>, _: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError> {
        let Some(mode) = self.modes.first() else { return Ok(x.to_vec()) };
        t.on(&mode.problem, |t| {
            let row = Row::new(t)?;
            mode.family.advance(t, &row, x)
        })
    }

    fn residual(&self, t: &mut Tracer<'_>, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError> {
        let Some(mode) = self.modes.first() else { return Ok(row.z.clone()) };
        t.on(&mode.problem, |t| {
            let row = Row::new(t)?;
            mode.family.residual(t, &row, x)
        })
    }
}
