//! One scalar measurement, and what it does.
#![expect(non_snake_case, reason = "Kalman notation: H, D, S, K")]

use crate::tape::{Graph, Id};

/// One decorrelated scalar measurement: z = H x + v with var v = D, taken where the gate is 1 and skipped where it is 0.
pub(in crate::filter) struct Scalar<'a> {
    pub(in crate::filter) H: &'a [Id],
    pub(in crate::filter) D: Id,
    pub(in crate::filter) gate: Id,
}

/// What a scalar measurement does to the mean.
pub(in crate::filter) struct Gain {
    /// Gain, n; 0 where gated off.
    pub(in crate::filter) K: Vec<Id>,
    /// Innovation variance H P H' + D; 1 where gated off.
    pub(in crate::filter) S: Id,
    /// 1 / S; 0 where gated off.
    pub(in crate::filter) inverse: Id,
}

impl Gain {
    /// The innovation's square over its variance; 0 where gated off.
    pub(in crate::filter) fn nis(&self, g: &mut Graph, innovation: Id) -> Id {
        let square = g.mul(innovation, innovation);
        g.mul(square, self.inverse)
    }
}

impl Scalar<'_> {
    /// A missing component neither divides by its S nor has to have a positive one.
    pub(in crate::filter) fn gated(&self, g: &mut Graph, S: Id) -> Id {
        let one = g.constant(1.0);
        g.select(self.gate, S, one)
    }

    /// The only state with a non-zero entry of H.
    pub(in crate::filter) fn only_state(&self, g: &Graph) -> Option<usize> {
        let mut seen = (0..self.H.len()).filter(|i| !g.is(self.H[*i], 0.0));
        let first = seen.next()?;
        seen.next().is_none().then_some(first)
    }
}
