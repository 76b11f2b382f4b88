//! Functions of angles, and angles of coordinates.

use super::{Binary, Graph, Id, One, Two, Unary, Wgsl};

pub(super) const SIN: One = One {
    name: "sin",
    wgsl: Wgsl::Single("sin"),
    double: lanes!(|a| a.sin()),
    single: lanes!(|a| a.sin()),
    derivative: |g, _, a, da| {
        let cos = g.unary(Unary::Cos, a);
        g.mul(cos, da)
    },
    // 2 s (cos a c - sin a s) with s, c of half the delta.
    difference: |g, a, [base, _]| {
        let ([s, c], cos) = (half_angle(g, a.delta), g.unary(Unary::Cos, a.base));
        let (left, right) = (g.mul(cos, c), g.mul(base, s));
        let slope = g.sub(left, right);
        twice(g, s, slope)
    },
};

pub(super) const COS: One = One {
    name: "cos",
    wgsl: Wgsl::Single("cos"),
    double: lanes!(|a| a.cos()),
    single: lanes!(|a| a.cos()),
    derivative: |g, _, a, da| {
        let sin = g.unary(Unary::Sin, a);
        let product = g.mul(sin, da);
        g.neg(product)
    },
    // -2 s (sin a c + cos a s).
    difference: |g, a, [base, _]| {
        let ([s, c], sin) = (half_angle(g, a.delta), g.unary(Unary::Sin, a.base));
        let slope = g.dot([(sin, c), (base, s)]);
        let delta = twice(g, s, slope);
        g.neg(delta)
    },
};

/// Sine and cosine of half an angle.
fn half_angle(g: &mut Graph, angle: Id) -> [Id; 2] {
    let half = g.constant(0.5);
    let half = g.mul(half, angle);
    [Unary::Sin, Unary::Cos].map(|op| g.unary(op, half))
}

fn twice(g: &mut Graph, a: Id, b: Id) -> Id {
    let double = g.add(a, a);
    g.mul(double, b)
}

pub(super) const TAN: One = One {
    name: "tan",
    wgsl: Wgsl::Single("tan"),
    double: lanes!(|a| a.tan()),
    single: lanes!(|a| a.tan()),
    derivative: |g, y, _, da| {
        let slope = one_plus_product(g, y, y);
        g.mul(slope, da)
    },
    // t (1 + y^2) / (1 - y t) with t the tangent of the delta.
    difference: |g, a, [base, _]| {
        let t = g.unary(Unary::Tan, a.delta);
        let (minus, slope) = (g.neg(base), one_plus_product(g, base, base));
        let (numerator, denominator) = (g.mul(t, slope), one_plus_product(g, minus, t));
        g.div(numerator, denominator)
    },
};

pub(super) const ATAN: One = One {
    name: "atan",
    wgsl: Wgsl::Single("atan"),
    double: lanes!(|a| a.atan()),
    single: lanes!(|a| a.atan()),
    derivative: |g, _, a, da| {
        let denominator = one_plus_product(g, a, a);
        g.div(da, denominator)
    },
    difference: |g, a, _| {
        let x = one_plus_product(g, a.base, a.value);
        g.binary(Binary::Atan2, a.delta, x)
    },
};

fn one_plus_product(g: &mut Graph, a: Id, b: Id) -> Id {
    let (one, product) = (g.constant(1.0), g.mul(a, b));
    g.add(one, product)
}

pub(super) const ATAN2: Two = Two {
    name: "atan2",
    wgsl: Wgsl::Single("atan2"),
    commutes: false,
    double: lanes!(|a, b| a.atan2(b)),
    single: lanes!(|a, b| a.atan2(b)),
    derivative: |g, _, [a, b], [da, db]| {
        let (left, right) = (g.mul(b, da), g.mul(a, db));
        let numerator = g.sub(left, right);
        let square = g.dot([(a, a), (b, b)]);
        g.div(numerator, square)
    },
    // The angle between the directions, from the deltas turned by that of the bases: right but for whole turns.
    difference: |g, [y, x], _| {
        let square = g.dot([(y.base, y.base), (x.base, x.base)]);
        let radius = g.unary(Unary::Sqrt, square);
        let (sin, cos) = (g.div(y.base, radius), g.div(x.base, radius));
        let (left, right) = (g.mul(y.delta, cos), g.mul(x.delta, sin));
        let across = g.sub(left, right);
        let moved = g.dot([(x.delta, cos), (y.delta, sin)]);
        let along = g.add(radius, moved);
        g.binary(Binary::Atan2, across, along)
    },
};
