//! Filters, traced: the recursion of a filter over a log becomes a [`Program`] of tapes.

mod assemble;
mod carried;
mod carry;
mod columns;
mod covariance;
mod cut;
mod difference;
mod error;
mod evidence;
mod families;
mod family;
mod fold;
mod form;
mod formula;
mod gaussian;
mod kinds;
mod listing;
mod nodes;
mod nominal;
mod positivity;
mod program;
mod rounds;
mod row;
mod rows;
mod score;
mod start;
mod step;
mod survey;
#[cfg(test)]
mod tests;
mod trace;
mod tracer;
mod track;
mod units;

pub use carried::{Carried, Role};
pub use carry::Entry;
pub use error::TraceError;
pub use form::Form;
pub use nominal::Nominal;
pub use positivity::Positivity;
pub use program::{Cursor, Initial, Program, Span, Step};
pub(crate) use rows::Place;
pub(crate) use survey::{probed, scattered};
pub(crate) use trace::trace_around;
pub use trace::{trace, trace_as};
pub use units::Units;
