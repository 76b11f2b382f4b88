//! What tracing works on: the graph, and the log as its columns.

use super::columns::{Columns, Key};
use super::nominal::Nominal;
use super::rows::{Place, Rows};
use super::units::Units;
use crate::model::Problem;
use crate::tape::{Calculator, Graph, Id, Leaf};

/// Everything that tracing a filter needs.
pub(super) struct Tracer<'a> {
    pub(super) g: Graph,
    pub(super) columns: &'a mut Columns,
    pub(super) rows: &'a Rows<'a>,
    pub(super) problem: &'a Problem,
    pub(super) nominal: Option<&'a Nominal>,
    /// In which the filter computes; formulas, columns and the nominal are in the problem's own.
    pub(super) units: &'a Units,
}

impl<'a> Tracer<'a> {
    /// A fresh graph for the rows of a log.
    pub(super) fn new(
        problem: &'a Problem,
        rows: &'a Rows<'a>,
        columns: &'a mut Columns,
        units: &'a Units,
        nominal: Option<&'a Nominal>,
    ) -> Self {
        Self { g: Graph::default(), columns, rows, problem, nominal, units }
    }

    /// Traces another problem over the same log, on the same graph and columns.
    pub(super) fn on<T>(&mut self, problem: &Problem, trace: impl FnOnce(&mut Tracer<'_>) -> T) -> T {
        let (rows, nominal, units) = (self.rows, self.nominal, self.units);
        let g = std::mem::take(&mut self.g);
        let mut own = Tracer { g, columns: &mut *self.columns, rows, problem, nominal, units };
        let traced = trace(&mut own);
        self.g = own.g;
        traced
    }

    /// The node of a value for every used row.
    pub(super) fn column(&mut self, key: Key, value: impl Fn(Place<'_>) -> f64) -> Id {
        self.columns.node(&mut self.g, key, || self.rows.places().map(value).collect())
    }

    /// A column of 1 where a condition holds, else 0.
    pub(super) fn flag(&mut self, key: Key, holds: impl Fn(Place<'_>) -> bool) -> Id {
        self.column(key, |place| f64::from(u8::from(holds(place))))
    }

    /// Inputs and dt of every row. What follows the last row is never used: dt repeats there and inputs may be 0.
    pub(super) fn inputs(&mut self) -> (Vec<Id>, Id) {
        let dt = self.column(Key::Dt, |place| place.dt());
        let inputs = (0..self.problem.model.inputs.len())
            .map(|i| self.column(Key::Input(i), |place| zero_if_missing(place.trajectory.u.row(place.k)[i])))
            .collect();
        (inputs, dt)
    }

    /// The measurements of every row, 0 where missing.
    pub(super) fn measurements(&mut self) -> Vec<Id> {
        let value = |place: Place<'_>, i: usize| zero_if_missing(place.trajectory.z.row(place.k)[i]);
        (0..self.problem.model.measurements.len())
            .map(|i| self.column(Key::Measurement(i), |place| value(place, i)))
            .collect()
    }

    /// For each measurement 1 in the rows that it updates the filter in, else 0.
    pub(super) fn present(&mut self) -> Vec<Id> {
        (0..self.problem.model.measurements.len())
            .map(|i| self.flag(Key::Present(i), |place| place.present(i)))
            .collect()
    }

    /// Every value that some nodes take over the rows of the log.
    pub(super) fn over_rows(&self, ids: &[Id], mut take: impl FnMut(f64)) {
        let constant = ids.iter().all(|id| self.g.depends(*id).is_constant());
        let rows = if constant { 1 } else { self.rows.len() };
        let mut calculator = Calculator::new(&self.g, ids);
        for row in 0..rows {
            calculator.evaluate(|leaf| self.at(leaf, row)).for_each(&mut take);
        }
    }

    /// What a leaf is worth at a used row of the log; columns alone are known there.
    pub(super) fn at(&self, leaf: Leaf, row: usize) -> f64 {
        match leaf {
            Leaf::Column(column) => self.columns.value(column, row),
            _ => f64::NAN,
        }
    }
}

const fn zero_if_missing(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}
