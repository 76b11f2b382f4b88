//! The extended filter's rule: formulas are replaced by their tangents at the mean. Jazwinski (1970), section 8.3; iterated:
//! Bell and Cathey (1993), doi 10.1109/9.250476.

use super::tangent::{Tangent, tangent};
use super::{Map, MomentRule, Moments, exact};
use crate::filter::covariance::Covariance;
use crate::filter::error::TraceError;
use crate::filter::form::Carrying;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::tape::Id;

/// E f(x) = f(E x), and F = df/dx there.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Linearised {
    iterations: usize,
    /// See [`Carrying::affine`].
    affine: bool,
}

impl Linearised {
    pub(in crate::filter) const fn new(carrying: Carrying, iterations: usize) -> Self {
        Self { iterations, affine: carrying.affine }
    }

    fn is_affine(&self, row: &Row, map: Map) -> bool {
        self.affine && map.of(&row.model).is_affine()
    }
}

impl MomentRule for Linearised {
    fn through(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        map: Map,
        x: &[Id],
        P: &Covariance,
    ) -> Result<Moments, TraceError> {
        if self.is_affine(row, map) {
            return exact(t, row, map, x, P);
        }
        let Tangent { fixed, value, jacobian, .. } = tangent(t, row, map, x);
        let moved = vec![t.g.constant(0.0); fixed.len()];
        Ok(Moments { fixed, moved, linear: value, jacobian, excess: None, columns: None, positive: vec![] })
    }

    fn iterations(&self, row: &Row) -> usize {
        if self.is_affine(row, Map::Measurement) { 1 } else { self.iterations }
    }
}
