//! A quantity that moves.

use super::graph::{Graph, Id};

/// A quantity that moves: three nodes, with value = base + delta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moved {
    /// Where it is without the move (a nominal: of columns and starts alone, it is computed in f64 and rounded once).
    pub base: Id,
    /// How far it moves.
    pub delta: Id,
    /// Where it ends. Not always the sum of the two nodes above: see [`Graph::difference`].
    pub value: Id,
}

impl Moved {
    /// What does not move.
    pub fn still(g: &mut Graph, id: Id) -> Self {
        Self { base: id, delta: g.constant(0.0), value: id }
    }

    /// What moves from `base` by `delta`. With the constant 0 as base it is replaced by `delta`, all digits kept.
    pub fn by(g: &mut Graph, base: Id, delta: Id) -> Self {
        Self { base, delta, value: g.add(base, delta) }
    }

    /// How far its value is from another place, of which its own base is near.
    pub(super) fn from(self, g: &mut Graph, place: Id) -> Id {
        let offset = g.sub(self.base, place);
        g.add(self.delta, offset)
    }
}
