//! Models: formulas, built-in motion models, parameters, and the problem that ties them to a log.

mod check_log;
mod check_start;
mod curve;
mod definite;
mod draft;
mod dual;
mod error;
mod evaluate;
mod expr;
pub mod family;
mod formula;
mod library;
mod linear;
mod other_filter;
mod parameter;
mod problem;
mod read;
mod standstill;
mod tuned;

pub use crate::tape::Function;
pub use curve::{Curve, Piece};
pub(crate) use definite::{ROUNDING, is_covariance, is_product, must_be_definite};
pub use draft::{Draft, draft};
pub(crate) use dual::Duals;
pub use error::{Cause, Place, ProblemError};
pub(crate) use evaluate::Formula;
pub use expr::{Binary, Expr, ExprKind, Logical, Span, Symbol};
pub use family::{Adapts, Facts, FilterKind, Range, Robust, Setting, View};
pub use library::{built_in_models, built_in_sensors};
pub use other_filter::FilterError;
pub use parameter::{Parameter, Parameters, Scale, Search, Value};
pub use problem::{Angles, First, Mode, Model, Pick, Problem, SimulateSpec, Start, TuneSpec};

#[cfg(test)]
pub(crate) use formula::{FormulaPlace, Names, Scope as FormulaScope, parse};

#[cfg(test)]
mod tests;
