//! What every list of names is held to.

use crate::model::error::{Cause, Fault};
use crate::model::formula::is_name;
use crate::model::{Function, Span};
use crate::words::shorten;

/// Refuses names that formulas cannot use or that mean something else.
pub(super) fn check_name(name: &str, span: Span) -> Result<(), Fault> {
    if !is_name(name) {
        return Err(Fault::new(span, Cause::BadName { name: shorten(name) }));
    }
    let taken = match name {
        "dt" => "the interval to the next row",
        "pi" => "the circle constant",
        _ if Function::ALL.iter().any(|(function, _)| *function == name) => "a function",
        _ => return Ok(()),
    };
    Err(Fault::new(span, Cause::NameTaken { name: shorten(name), taken }))
}

/// Refuses absurd sizes.
pub(super) fn limit(span: Span, count: usize, what: &'static str, limit: usize) -> Result<(), Fault> {
    if count > limit { Err(Fault::new(span, Cause::TooMany { count, what, limit })) } else { Ok(()) }
}
