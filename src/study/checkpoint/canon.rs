//! A problem in the order and the words that its identity is taken over.
//!
//! The words are those of problem files and of this file, not names of types or fields: who renames those in Rust changes
//! no identity. Every struct is taken apart by name and every enum matched, so that what is added to one has to be put
//! on one side or the other.

use super::sum::Sum;
use crate::model::{
    Angles, Expr, ExprKind, FilterKind, First, Mode, Model, Parameter, Parameters, Problem, Robust, Scale, Search,
    Start, Symbol, TuneSpec, Value,
};
use crate::objective::{Constraint, Kind, Objective};

/// Writes into a hash.
pub(super) struct Canon(Sum);

impl Canon {
    pub(super) const fn new(sum: Sum) -> Self {
        Self(sum)
    }

    pub(super) fn finish(self) -> Sum {
        self.0
    }

    /// What the bits of a search over it depend on, but for the log.
    pub(super) fn problem(&mut self, problem: &Problem) {
        let Problem { source: _, text: _, data: _, model, parameters, filter, robust, modes, tune, simulate: _ } =
            problem;
        self.model(model);
        self.parameters(parameters);
        self.filter(filter);
        // Problems without robust updates keep the identity that they had before there were any.
        robust.iter().for_each(|robust| self.robust(robust));
        // Filters of one model keep the identity that they had before there were any of several.
        if !modes.is_empty() {
            self.list("modes", modes, Self::mode);
        }
        self.tune(tune);
    }

    fn model(&mut self, model: &Model) {
        // How a built-in model was called is said nowhere in a search: its formulas count.
        let Model { kind: _, states, measurements, inputs, angles, f, h, q, r, x0, p0, first } = model;
        for (word, names) in [("states", states), ("measurements", measurements), ("inputs", inputs)] {
            self.list(word, names, |canon, name| canon.0.text(name));
        }
        let Angles { states, measurements } = angles;
        for (word, indices) in [("angle states", states), ("angle measurements", measurements)] {
            // Problems without angles keep the identity that they had before there were any.
            if !indices.is_empty() {
                self.list(word, indices, |canon, index| canon.0.number(*index as u64));
            }
        }
        for (word, formulas) in [("f", f), ("h", h), ("Q", q), ("R", r), ("P0", p0)] {
            self.list(word, formulas, Self::formula);
        }
        match x0 {
            Start::Values(formulas) => self.list("x0", formulas, Self::formula),
            Start::Measurement => self.0.text("x0 measurement"),
        }
        match first {
            First::Update => self.0.text("first update"),
            First::Predict { dt } => {
                self.0.text("first predict");
                self.optional(*dt);
            }
        }
    }

    fn formula(&mut self, Expr { kind, span: _ }: &Expr) {
        match kind {
            ExprKind::Number(value) => {
                self.0.text("number");
                self.0.value(*value);
            }
            ExprKind::Symbol(symbol) => self.symbol(*symbol),
            ExprKind::Negate(a) => {
                self.0.text("negate");
                self.formula(a);
            }
            ExprKind::Binary(operator, a, b) => {
                self.0.text(operator.symbol().encode_utf8(&mut [0; 4]));
                self.formula(a);
                self.formula(b);
            }
            ExprKind::Logical(operator, a, b) => {
                self.0.text(operator.symbol());
                self.formula(a);
                self.formula(b);
            }
            ExprKind::If(operands) => self.list("if", operands.as_slice(), Self::formula),
            // What the curve is called and where it lies does not count: its numbers do.
            ExprKind::Table(curve, a) => {
                self.values("table", curve.x());
                self.values("values", curve.y());
                self.formula(a);
            }
            ExprKind::Call(function, arguments) => self.list(function.name(), arguments, Self::formula),
        }
    }

    fn symbol(&mut self, symbol: Symbol) {
        let (word, index) = match symbol {
            Symbol::State(i) => ("state", i),
            Symbol::Parameter(i) => ("parameter", i),
            Symbol::Input(i) => ("input", i),
            Symbol::Dt => ("dt", 0),
        };
        self.0.text(word);
        self.0.number(index as u64);
    }

    fn parameters(&mut self, Parameters { all }: &Parameters) {
        self.list("parameters", all, |canon, Parameter { name, unit: _, value }| {
            canon.0.text(name);
            match value {
                Value::Fixed(value) => canon.values("fixed", &[*value]),
                Value::Tied(to) => {
                    canon.0.text("tied");
                    canon.0.number(*to as u64);
                }
                Value::Searched(search) => canon.search(search),
            }
        });
    }

    fn search(&mut self, Search { min, max, scale, init: [low, high], start }: &Search) {
        self.values("searched", &[*min, *max, *low, *high]);
        self.0.text(match scale {
            Scale::Linear => "linear",
            Scale::Log => "log",
        });
        self.optional(*start);
    }

    fn filter(&mut self, filter: &FilterKind) {
        self.0.text(filter.name());
        for setting in filter.settings() {
            self.0.text(setting.key);
            self.formula(setting.formula);
        }
        filter.sizes().into_iter().for_each(|size| self.0.number(size as u64));
    }

    fn mode(&mut self, Mode { name, model, filter, allowed }: &Mode) {
        self.0.text(name);
        self.model(model);
        self.filter(filter);
        if let Some(allowed) = allowed {
            self.0.text("allowed");
            self.formula(allowed);
        }
    }

    fn robust(&mut self, robust: &Robust) {
        self.0.text("robust");
        self.0.text(robust.name());
        for setting in robust.settings() {
            self.0.text(setting.key);
            self.formula(setting.formula);
        }
        robust.sizes().into_iter().for_each(|size| self.0.number(size as u64));
    }

    fn tune(&mut self, tune: &TuneSpec) {
        #[rustfmt::skip]
        let TuneSpec {
            algorithm, objectives, constraints, population, generations, seed, include_start,
            evaluations: _, wall_time: _, stall: _, target: _, polish: _, pick: _,
        } = tune;
        self.0.text(algorithm);
        self.list("objectives", objectives, Self::objective);
        self.list("constraints", constraints, |canon, Constraint { measure, relation, limit }| {
            canon.objective(measure);
            canon.0.text(&relation.to_string());
            canon.0.value(*limit);
        });
        for number in [*population as u64, *generations as u64, *seed, u64::from(*include_start)] {
            self.0.number(number);
        }
    }

    fn objective(&mut self, objective: &Objective) {
        let Objective { kind, states, skip, window, ct_last, lags, ahead: _ } = objective;
        self.list(kind.name(), states, |canon, state| canon.0.number(*state as u64));
        for number in [*skip as u64, *window as u64, u64::from(*ct_last)] {
            self.0.number(number);
        }
        // Objectives without them keep the identity that they had before there were any.
        match kind {
            Kind::Whiteness => self.0.number(*lags as u64),
            Kind::Prediction => {
                self.list("ahead", objective.horizons(), |canon, ahead| canon.0.number(*ahead as u64));
            }
            _ => {}
        }
    }

    fn list<T>(&mut self, word: &str, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.0.text(word);
        self.0.number(items.len() as u64);
        items.iter().for_each(|item| write(self, item));
    }

    fn values(&mut self, word: &str, values: &[f64]) {
        self.list(word, values, |canon, value| canon.0.value(*value));
    }

    fn optional(&mut self, value: Option<f64>) {
        self.values("optional", value.as_slice());
    }
}
