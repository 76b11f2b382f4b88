//! The mean alone through formulas: a gaussian without spread, which every moment rule takes to f(x) or h(x).

use super::innovation::Innovation;
use super::moments::{Map, MomentRule, Moments};
use crate::filter::covariance::{Covariance, Symmetric};
use crate::filter::error::TraceError;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::tape::Id;

fn through(t: &mut Tracer<'_>, rule: &dyn MomentRule, row: &Row, map: Map, x: &[Id]) -> Result<Moments, TraceError> {
    let zero = t.g.constant(0.0);
    let spread = Covariance::Full(Symmetric::from_fn(x.len(), |_, _| zero));
    rule.through(t, row, map, x, &spread)
}

/// f(x), in the deviation form less the nominal of the next row.
pub(super) fn advance(t: &mut Tracer<'_>, rule: &dyn MomentRule, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError> {
    Ok(through(t, rule, row, Map::Transition, x)?.mean(&mut t.g))
}

/// z - h(x).
pub(super) fn residual(t: &mut Tracer<'_>, rule: &dyn MomentRule, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError> {
    let expected = through(t, rule, row, Map::Measurement, x)?;
    Ok(Innovation::new(t, row, &expected).nu)
}
