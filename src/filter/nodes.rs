//! The model as nodes: every formula of it traced once, for any candidate or for one.
#![expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, P0")]

use super::carried::narrow;
use super::covariance::Symmetric;
use super::error::TraceError;
use super::formula::{self, Scope};
use super::tracer::Tracer;
use crate::model::{Expr, Start};
use crate::tape::{Id, Leaf};

/// f or h.
pub(super) struct MapNodes {
    /// Rows of its Jacobian (derived, never typed), of free variables for the states where they are not affine.
    pub(super) jacobian: Vec<Vec<Id>>,
    /// Its value at x = 0, for affine rows.
    pub(super) offset: Vec<Id>,
    /// The formulas themselves, of free variables for the states.
    pub(super) values: Vec<Id>,
    /// For each row whether it is affine in the states.
    pub(super) affine: Vec<bool>,
}

impl MapNodes {
    /// Whether every row is affine.
    pub(super) fn is_affine(&self) -> bool {
        self.affine.iter().all(|affine| *affine)
    }
}

/// The model in the problem's own units. Searched parameters are leaves, or the values of one candidate.
pub(super) struct ModelNodes {
    /// Time update: F, and f(0).
    pub(super) f: MapNodes,
    /// Measurement: H, and h(0).
    pub(super) h: MapNodes,
    /// Covariance of the process noise of one step, n x n.
    pub(super) Q: Symmetric,
    /// Covariance of the measurement noise, m x m.
    pub(super) R: Symmetric,
    /// Covariance at the start, n x n.
    pub(super) P0: Symmetric,
    /// Mean at the start; none where it comes from a measurement.
    pub(super) x0: Option<Vec<Id>>,
    /// Settings of the filter, in their order.
    pub(super) settings: Vec<Id>,
}

impl ModelNodes {
    /// For every row of the log.
    ///
    /// # Errors
    /// If f or h is not affine in the states.
    pub(super) fn new(t: &mut Tracer<'_>, candidate: Option<&[f64]>) -> Result<Self, TraceError> {
        let (_, dt) = t.inputs();
        Self::at(t, candidate, dt)
    }

    /// For an interval of `dt`.
    ///
    /// # Errors
    /// If f or h is not affine in the states.
    pub(super) fn at(t: &mut Tracer<'_>, candidate: Option<&[f64]>, dt: Id) -> Result<Self, TraceError> {
        let (inputs, _) = t.inputs();
        let parameters = formula::parameters(&mut t.g, &t.problem.parameters, candidate);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &inputs, dt };
        let model = &t.problem.model;
        let f = map(t, &model.f, scope, ("f", &model.states))?;
        let h = map(t, &model.h, scope, ("h", &model.measurements))?;
        let mut value = |formula: &Expr| formula::trace(&mut t.g, formula, scope);
        let mut covariance = |entries: &[Expr]| {
            let n = entries.len().isqrt();
            Symmetric::from_fn(n, |i, j| value(&entries[i * n + j]))
        };
        let (Q, R, P0) = (covariance(&model.q), covariance(&model.r), covariance(&model.p0));
        let x0 = match &model.x0 {
            Start::Values(values) => Some(values.iter().map(&mut value).collect()),
            Start::Measurement => None,
        };
        let settings = t.problem.settings().iter().map(|setting| value(setting.formula)).collect();
        Ok(Self { f, h, Q, R, P0, x0, settings })
    }
}

/// Formulas as a map of the states; `what` names them.
fn map(
    t: &mut Tracer<'_>,
    formulas: &[Expr],
    scope: Scope<'_>,
    what: (&'static str, &[String]),
) -> Result<MapNodes, TraceError> {
    let n = t.problem.model.states.len();
    let variables: Vec<Id> = (0..n).map(|j| t.g.leaf(Leaf::Variable(narrow(j)))).collect();
    let zeros = vec![t.g.constant(0.0); n];
    let mut map = MapNodes { jacobian: vec![], offset: vec![], values: vec![], affine: vec![] };
    for (formula, name) in formulas.iter().zip(what.1) {
        let value = formula::trace(&mut t.g, formula, Scope { states: &variables, ..scope });
        let row: Vec<Id> = (0..n).map(|j| t.g.differentiate(value, Leaf::Variable(narrow(j)))).collect();
        let affine = !row.iter().any(|derivative| t.g.depends(*derivative).has_variable());
        if !affine && t.problem.filter.is_linear() {
            return Err(TraceError::NotLinear { formula: what.0, name: name.clone() });
        }
        map.affine.push(affine);
        map.jacobian.push(row);
        map.values.push(value);
        map.offset.push(formula::trace(&mut t.g, formula, Scope { states: &zeros, ..scope }));
    }
    Ok(map)
}
