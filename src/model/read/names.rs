//! What every list of names is held to.

use crate::model::Span;
use crate::model::error::{Cause, Fault};
use crate::model::formula::{is_name, reserved};
use crate::words::shorten;

/// Refuses names that formulas cannot use or that mean something else.
pub(super) fn check_name(name: &str, span: Span) -> Result<(), Fault> {
    if !is_name(name) {
        return Err(Fault::new(span, Cause::BadName { name: shorten(name) }));
    }
    match reserved(name) {
        Some(taken) => Err(Fault::new(span, Cause::NameTaken { name: shorten(name), taken })),
        None => Ok(()),
    }
}

/// Refuses absurd sizes.
pub(super) fn limit(span: Span, count: usize, what: &'static str, limit: usize) -> Result<(), Fault> {
    if count > limit { Err(Fault::new(span, Cause::TooMany { count, what, limit })) } else { Ok(()) }
}
