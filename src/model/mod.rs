//! Models: formulas, built-in motion models, parameters, and the problem that ties them to a log.

mod draft;
mod expr;
mod parameter;
mod problem;

pub use draft::{Draft, draft};
pub use expr::{Binary, Expr, ExprKind, Function, Span, Symbol};
pub use parameter::{Parameter, Parameters, Scale, Search, Value};
pub use problem::{DataSpec, FilterKind, First, Model, Problem, SimulateSpec, Start, TuneSpec};
