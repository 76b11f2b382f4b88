//! Sums, products, roots and comparisons: what every machine does exactly, or rounds correctly.

use super::{Graph, Id, Moved, One, Two, Wgsl};

pub(super) const NEGATE: One = One {
    name: "-",
    wgsl: Wgsl::Sign,
    double: lanes!(|a| -a),
    single: lanes!(|a| -a),
    derivative: |g, _, _, da| g.neg(da),
    difference: |g, a, _| g.neg(a.delta),
};

pub(super) const SQRT: One = One {
    name: "sqrt",
    wgsl: Wgsl::Call("sqrt"),
    double: lanes!(|a| a.sqrt()),
    single: lanes!(|a| a.sqrt()),
    derivative: |g, y, _, da| {
        let twice = g.add(y, y);
        g.div(da, twice)
    },
    difference: |g, a, [base, value]| {
        let sum = g.add(value, base);
        g.div(a.delta, sum)
    },
};

pub(super) const ABS: One = One {
    name: "abs",
    wgsl: Wgsl::Call("abs"),
    double: lanes!(|a| a.abs()),
    single: lanes!(|a| a.abs()),
    derivative: |g, _, a, da| {
        let minus = g.neg(da);
        g.select(a, da, minus)
    },
    // With s the sign of the base: s alpha on its side of 0, else -s alpha - 2 |base|.
    difference: |g, a, [base, _]| {
        let (plus, minus) = (g.constant(1.0), g.constant(-1.0));
        let sign = g.select(a.base, plus, minus);
        let (same_side, along) = (g.mul(a.value, sign), g.mul(a.delta, sign));
        let twice = g.add(base, base);
        let back = g.add(along, twice);
        let back = g.neg(back);
        g.select(same_side, along, back)
    },
};

pub(super) const POSITIVE: One = One {
    name: "positive",
    wgsl: Wgsl::Call("positive_part"),
    double: lanes!(|a| if a > 0.0 { a } else { 0.0 }),
    single: lanes!(|a| if a > 0.0 { a } else { 0.0 }),
    derivative: |g, _, a, da| {
        let zero = g.constant(0.0);
        g.select(a, da, zero)
    },
    difference: |g, a, [base, _]| {
        let zero = g.constant(0.0);
        let zero = Moved::still(g, zero);
        larger(g, [a, zero], [a, zero], base)
    },
};

pub(super) const ADD: Two = Two {
    name: "+",
    wgsl: Wgsl::Sign,
    commutes: true,
    double: lanes!(|a, b| a + b),
    single: lanes!(|a, b| a + b),
    derivative: |g, _, _, [da, db]| g.add(da, db),
    difference: |g, [a, b], _| g.add(a.delta, b.delta),
};

pub(super) const SUBTRACT: Two = Two {
    name: "-",
    wgsl: Wgsl::Sign,
    commutes: false,
    double: lanes!(|a, b| a - b),
    single: lanes!(|a, b| a - b),
    derivative: |g, _, _, [da, db]| g.sub(da, db),
    difference: |g, [a, b], _| g.sub(a.delta, b.delta),
};

pub(super) const MULTIPLY: Two = Two {
    name: "*",
    wgsl: Wgsl::Sign,
    commutes: true,
    double: lanes!(|a, b| a * b),
    single: lanes!(|a, b| a * b),
    derivative: |g, _, [a, b], [da, db]| g.dot([(a, db), (da, b)]),
    difference: |g, [a, b], _| {
        if a.value == b.value {
            let sum = g.add(a.base, a.value);
            return g.mul(a.delta, sum);
        }
        g.dot([(a.delta, b.value), (a.base, b.delta)])
    },
};

pub(super) const DIVIDE: Two = Two {
    name: "/",
    wgsl: Wgsl::Sign,
    commutes: false,
    double: lanes!(|a, b| a / b),
    single: lanes!(|a, b| a / b),
    derivative: |g, y, [_, b], [da, db]| quotient(g, y, b, [da, db]),
    difference: |g, [a, b], [base, _]| quotient(g, base, b.value, [a.delta, b.delta]),
};

/// (da - y db) / b.
fn quotient(g: &mut Graph, y: Id, b: Id, [da, db]: [Id; 2]) -> Id {
    let part = g.mul(y, db);
    let numerator = g.sub(da, part);
    g.div(numerator, b)
}

pub(super) const MIN: Two = Two {
    name: "min",
    wgsl: Wgsl::Call("min"),
    commutes: true,
    double: lanes!(|a, b| a.min(b)),
    single: lanes!(|a, b| a.min(b)),
    derivative: |g, _, [a, b], [da, db]| {
        let b_larger = g.sub(b, a);
        g.select(b_larger, da, db)
    },
    difference: |g, [a, b], [base, _]| larger(g, [b, a], [a, b], base),
};

pub(super) const MAX: Two = Two {
    name: "max",
    wgsl: Wgsl::Call("max"),
    commutes: true,
    double: lanes!(|a, b| a.max(b)),
    single: lanes!(|a, b| a.max(b)),
    derivative: |g, _, [a, b], [da, db]| {
        let a_larger = g.sub(a, b);
        g.select(a_larger, da, db)
    },
    difference: |g, [a, b], [base, _]| larger(g, [a, b], [a, b], base),
};

/// The delta of the first of two choices where `large > small`, else of the second. How much larger is told from bases and
/// deltas apart, so that it keeps its digits.
fn larger(g: &mut Graph, [large, small]: [Moved; 2], choices: [Moved; 2], base: Id) -> Id {
    let (bases, deltas) = (g.sub(large.base, small.base), g.sub(large.delta, small.delta));
    let margin = g.add(bases, deltas);
    let [then, otherwise] = choices.map(|moved| moved.from(g, base));
    g.select(margin, then, otherwise)
}
