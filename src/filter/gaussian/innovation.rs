//! What a measurement differs by from what was expected.

use super::moments::Moments;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units::scaled;
use crate::tape::{Graph, Id, Unary};

/// z - E h(x), in the filter's units.
pub(super) struct Innovation {
    /// z without the part of it that does not depend on x.
    pub(super) z: Vec<Id>,
    /// Joint innovation, m, of angles in [-pi, pi); meaningless where missing.
    pub(super) nu: Vec<Id>,
}

impl Innovation {
    /// Of a row. What is large cancels first.
    pub(super) fn new(t: &mut Tracer<'_>, row: &Row, expected: &Moments) -> Self {
        let Moments { fixed, moved, linear, .. } = expected;
        let measured = scaled(&mut t.g, &row.z, &t.units.measurements);
        let (mut free, mut nu) = (Vec::with_capacity(measured.len()), Vec::with_capacity(measured.len()));
        for (i, z) in measured.into_iter().enumerate() {
            let turns = t.problem.model.angles.measurement(i);
            let wrapped = |g: &mut Graph, a: Id| if turns { g.unary(Unary::Wrap, a) } else { a };
            let z = t.g.sub(z, fixed[i]);
            // What is the same for all candidates is wrapped in f64.
            let z = wrapped(&mut t.g, z);
            let z = t.g.sub(z, moved[i]);
            free.push(z);
            let innovation = t.g.sub(z, linear[i]);
            nu.push(wrapped(&mut t.g, innovation));
        }
        Self { z: free, nu }
    }
}
