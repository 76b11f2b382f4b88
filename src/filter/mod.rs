//! Filters, traced: the recursion of a filter over a log becomes a [`Program`] of tapes.

mod adaptive;
mod carry;
mod columns;
mod covariance;
mod error;
mod factored;
mod form;
mod formula;
mod kalman;
mod nominal;
mod positivity;
mod probe;
mod program;
mod score;
mod start;
mod symmetric;
#[cfg(test)]
mod tests;
mod trace;
mod tracer;
mod track;
mod units;

pub use carry::Entry;
pub(crate) use columns::Place;
pub use error::TraceError;
pub use form::Form;
pub use nominal::Nominal;
pub use positivity::Positivity;
pub(crate) use probe::{probed, scattered};
pub use program::{Carried, Program, Role, Span};
pub use trace::{trace, trace_as};
pub use units::Units;
