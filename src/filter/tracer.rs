//! From formulas and a log to the matrices of the recursion, as nodes: Jacobians derived on the graph, and the deviation
//! form around a nominal.
#![expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, P")]

use super::columns::{Columns, Key, Place, Rows};
use super::covariance::Covariance;
use super::error::TraceError;
use super::form::Form;
use super::formula::{self, Scope};
use super::kalman::Recursion;
use super::nominal::Nominal;
use super::symmetric::Symmetric;
use super::units::Units;
use crate::model::{Expr, First, Problem, Start};
use crate::tape::{Graph, Id, Leaf};

/// A linear map with its offset: rows of the Jacobian, and the value at x = 0.
struct Affine {
    jacobian: Vec<Vec<Id>>,
    offset: Vec<Id>,
}

/// A linear map around the nominal. Its offset is `fixed + moved`, kept apart because `fixed` may be hundreds of
/// kilometres: it must meet what it cancels (z) in f64, before single precision adds a candidate's own share.
struct Local {
    jacobian: Vec<Vec<Id>>,
    /// The same for every candidate.
    fixed: Vec<Id>,
    /// What the candidate's parameters change; 0 where they do not stand in the formula.
    moved: Vec<Id>,
}

/// Everything that tracing a filter needs.
pub(super) struct Tracer<'a> {
    pub(super) g: Graph,
    pub(super) columns: &'a mut Columns,
    pub(super) rows: &'a Rows<'a>,
    pub(super) problem: &'a Problem,
    pub(super) nominal: Option<&'a Nominal>,
    /// In which the filter computes; formulas, columns and the nominal are in the problem's own.
    pub(super) units: &'a Units,
    /// See [`Recursion::anchored`].
    pub(super) anchored: bool,
}

impl Tracer<'_> {
    /// The recursion over the rows of the log.
    pub(super) fn recursion(&mut self) -> Result<Recursion, TraceError> {
        let model = &self.problem.model;
        let m = model.measurements.len();
        let (inputs, dt) = self.inputs();
        let z: Vec<Id> =
            (0..m).map(|i| self.column(Key::Measurement(i), |p| zero_if_missing(p.trajectory.z.row(p.k)[i]))).collect();
        let present = (0..m).map(|i| self.column(Key::Present(i), |p| f64::from(u8::from(p.present(i))))).collect();
        let f = self.linear(&model.f, &inputs, dt, ("f", &model.states))?;
        let h = self.linear(&model.h, &inputs, dt, ("h", &model.measurements))?;
        let (mut innovations, mut drift) = (Vec::with_capacity(m), Vec::with_capacity(f.fixed.len()));
        for (z, (fixed, moved)) in z.iter().zip(h.fixed.iter().zip(&h.moved)) {
            let z = self.g.sub(*z, *fixed);
            innovations.push(self.g.sub(z, *moved));
        }
        for (fixed, moved) in f.fixed.iter().zip(&f.moved) {
            drift.push(self.g.add(*fixed, *moved));
        }
        let parameters = formula::parameters(&mut self.g, &self.problem.parameters, None);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &inputs, dt };
        let (x, y) = (&self.units.states, &self.units.measurements);
        Ok(Recursion {
            F: self.scaled_map(f.jacobian, x),
            H: self.scaled_map(h.jacobian, y),
            Q: Covariance::Full(self.covariance(&model.q, scope, x)),
            R: self.covariance(&model.r, scope, y),
            drift: self.scaled(&drift, x),
            z: self.scaled(&innovations, y),
            present,
            anchored: self.anchored,
        })
    }

    /// Values from the problem's units to those of the filter.
    fn scaled(&mut self, values: &[Id], units: &[i32]) -> Vec<Id> {
        values.iter().zip(units).map(|(value, unit)| self.g.scale(*value, -unit)).collect()
    }

    /// The same for a matrix that takes states to what has `units`.
    fn scaled_map(&mut self, mut rows: Vec<Vec<Id>>, units: &[i32]) -> Vec<Vec<Id>> {
        for (row, unit) in rows.iter_mut().zip(units) {
            for (entry, state) in row.iter_mut().zip(&self.units.states) {
                *entry = self.g.scale(*entry, state - unit);
            }
        }
        rows
    }

    /// H and h(0) of a candidate, at every row.
    pub(super) fn measurement_map(&mut self, candidate: &[f64]) -> Result<(Vec<Vec<Id>>, Vec<Id>), TraceError> {
        let model = &self.problem.model;
        let (inputs, dt) = self.inputs();
        let h = self.affine(&model.h, Some(candidate), &inputs, dt, ("h", &model.measurements))?;
        Ok((h.jacobian, h.offset))
    }

    /// F of a candidate, at every row.
    pub(super) fn transition_map(&mut self, candidate: &[f64]) -> Result<Vec<Vec<Id>>, TraceError> {
        let model = &self.problem.model;
        let (inputs, dt) = self.inputs();
        Ok(self.affine(&model.f, Some(candidate), &inputs, dt, ("f", &model.states))?.jacobian)
    }

    /// Inputs and dt of every row. What follows the last row is never used: dt repeats there and inputs may be 0.
    pub(super) fn inputs(&mut self) -> (Vec<Id>, Id) {
        let dt = self.column(Key::Dt, |place| place.dt());
        let inputs = (0..self.problem.model.inputs.len())
            .map(|i| self.column(Key::Input(i), |place| zero_if_missing(place.trajectory.u.row(place.k)[i])))
            .collect();
        (inputs, dt)
    }

    /// The node of a value for every used row.
    pub(super) fn column(&mut self, key: Key, value: impl Fn(Place<'_>) -> f64) -> Id {
        self.columns.node(&mut self.g, key, || self.rows.places().map(value).collect())
    }

    /// The recursion that steps from one interval before the first row to it.
    fn first_step(&mut self, dt: f64) -> Result<Recursion, TraceError> {
        let model = &self.problem.model;
        let dt = self.g.constant(dt);
        let f = self.affine(&model.f, None, &[], dt, ("f", &model.states))?;
        let parameters = formula::parameters(&mut self.g, &self.problem.parameters, None);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &[], dt };
        let units = &self.units.states;
        let Q = Covariance::Full(self.covariance(&model.q, scope, units));
        let (F, drift) = (self.scaled_map(f.jacobian, units), self.scaled(&f.offset, units));
        let R = Symmetric::from_fn(0, |_, _| dt);
        Ok(Recursion { F, H: vec![], Q, R, drift, z: vec![], present: vec![], anchored: false })
    }

    /// x0 and P0 at the first row, in deviation from the nominal if there is one.
    pub(super) fn start(&mut self, form: Form) -> Result<(Vec<Id>, Covariance), TraceError> {
        let model = &self.problem.model;
        let n = model.states.len();
        let parameters = formula::parameters(&mut self.g, &self.problem.parameters, None);
        let dt = self.g.constant(f64::NAN);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &[], dt };
        let mut x: Vec<Id> = match &model.x0 {
            Start::Values(values) => values.iter().map(|v| formula::trace(&mut self.g, v, scope)).collect(),
            Start::Measurement => (0..n).map(|i| self.g.leaf(Leaf::Start(narrow(i)))).collect(),
        };
        x = self.scaled(&x, &self.units.states);
        let P = self.covariance(&model.p0, scope, &self.units.states);
        let mut P = Covariance::new(&mut self.g, form, P);
        if let First::Predict { dt } = model.first {
            let dt = dt.or_else(|| self.rows.log.regular_dt()).ok_or(TraceError::NoFirstInterval)?;
            let step = self.first_step(dt)?;
            (x, P) = step.predict(&mut self.g, &x, &P);
        }
        if self.nominal.is_some() {
            for (i, x) in x.iter_mut().enumerate() {
                let nominal = self.g.leaf(Leaf::Start(narrow(n + i)));
                let nominal = self.g.scale(nominal, -self.units.states[i]);
                *x = self.g.sub(*x, nominal);
            }
        }
        Ok((x, P))
    }

    /// A covariance of what has `units`, in the filter's.
    pub(super) fn covariance(&mut self, entries: &[Expr], scope: Scope<'_>, units: &[i32]) -> Symmetric {
        let n = units.len();
        Symmetric::from_fn(n, |i, j| {
            let entry = formula::trace(&mut self.g, &entries[i * n + j], scope);
            self.g.scale(entry, -units[i] - units[j])
        })
    }

    /// f or h around the nominal: its Jacobian, and what is to be added to F x (f) or taken from z (h).
    fn linear(
        &mut self,
        formulas: &[Expr],
        inputs: &[Id],
        dt: Id,
        what: (&'static str, &[String]),
    ) -> Result<Local, TraceError> {
        let theta = self.affine(formulas, None, inputs, dt, what)?;
        let Some(nominal) = self.nominal else {
            let moved = vec![self.g.constant(0.0); formulas.len()];
            return Ok(Local { jacobian: theta.jacobian, fixed: theta.offset, moved });
        };
        let at = self.affine(formulas, Some(&nominal.candidate), inputs, dt, what)?;
        let n = self.problem.model.states.len();
        let x: Vec<Id> = (0..n).map(|i| self.columns.node(&mut self.g, Key::Nominal(i), || nominal.at(i))).collect();
        let mut local = Local { jacobian: vec![], fixed: vec![], moved: vec![] };
        for i in 0..formulas.len() {
            // f_theta0(x_nom) is the same for every candidate and is taken in f64, once; what theta changes is added:
            // [F_theta - F_theta0] x_nom + c_theta - c_theta0, which vanishes where theta does not stand in the formula.
            let fixed = self.g.dot(at.jacobian[i].iter().copied().zip(x.iter().copied()));
            let mut fixed = self.g.add(fixed, at.offset[i]);
            if what.0 == "f" {
                let next = self.columns.node(&mut self.g, Key::NextNominal(i), || nominal.next(i, self.rows));
                fixed = self.g.sub(fixed, next);
            }
            let change = self.g.sub(theta.offset[i], at.offset[i]);
            self.require_invariant(change, what, i)?;
            let mut moved = change;
            for (j, x) in x.iter().enumerate() {
                let change = self.g.sub(theta.jacobian[i][j], at.jacobian[i][j]);
                self.require_invariant(change, what, i)?;
                let share = self.g.mul(change, *x);
                moved = self.g.add(moved, share);
            }
            local.fixed.push(fixed);
            local.moved.push(moved);
        }
        local.jacobian = theta.jacobian;
        Ok(local)
    }

    fn require_invariant(&self, change: Id, what: (&'static str, &[String]), i: usize) -> Result<(), TraceError> {
        if self.g.depends(change).is_invariant() {
            return Ok(());
        }
        Err(TraceError::NeedsF64 { formula: what.0, name: what.1[i].clone() })
    }

    /// Jacobian (derived, never typed) and offset of affine formulas, for the searched parameters or for a candidate.
    fn affine(
        &mut self,
        formulas: &[Expr],
        candidate: Option<&[f64]>,
        inputs: &[Id],
        dt: Id,
        what: (&'static str, &[String]),
    ) -> Result<Affine, TraceError> {
        let n = self.problem.model.states.len();
        let parameters = formula::parameters(&mut self.g, &self.problem.parameters, candidate);
        let variables: Vec<Id> = (0..n).map(|j| self.g.leaf(Leaf::Variable(narrow(j)))).collect();
        let zeros = vec![self.g.constant(0.0); n];
        let mut affine = Affine { jacobian: vec![], offset: vec![] };
        for (i, f) in formulas.iter().enumerate() {
            let value =
                formula::trace(&mut self.g, f, Scope { states: &variables, parameters: &parameters, inputs, dt });
            let row: Vec<Id> = (0..n).map(|j| self.g.differentiate(value, Leaf::Variable(narrow(j)))).collect();
            if row.iter().any(|d| self.g.depends(*d).has_variable()) {
                return Err(TraceError::NotLinear { formula: what.0, name: what.1[i].clone() });
            }
            affine.jacobian.push(row);
            let scope = Scope { states: &zeros, parameters: &parameters, inputs, dt };
            affine.offset.push(formula::trace(&mut self.g, f, scope));
        }
        Ok(affine)
    }
}

const fn zero_if_missing(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}

#[expect(clippy::cast_possible_truncation, reason = "dimensions are bounded far below 2^32")]
pub(super) const fn narrow(i: usize) -> u32 {
    i as u32
}
