//! Whole numbers: exact on every machine.

use super::{Graph, Id, Moved, One, Wgsl};

pub(super) const FLOOR: One = One {
    name: "floor",
    wgsl: Wgsl::Call("floor"),
    double: lanes!(|a| a.floor()),
    single: lanes!(|a| a.floor()),
    derivative: |g, _, _, _| g.constant(0.0),
    difference: jump,
};

pub(super) const ROUND: One = One {
    name: "round",
    wgsl: Wgsl::Call("round"),
    double: lanes!(|a| a.round_ties_even()),
    single: lanes!(|a| a.round_ties_even()),
    derivative: |g, _, _, _| g.constant(0.0),
    difference: jump,
};

/// A difference of whole numbers is exact.
fn jump(g: &mut Graph, _: Moved, [base, value]: [Id; 2]) -> Id {
    g.sub(value, base)
}
