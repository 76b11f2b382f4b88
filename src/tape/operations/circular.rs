//! Functions of angles, and angles of coordinates.

use super::super::elementary::{double, reaching, single};
use super::{Binary, Graph, Id, One, Two, Unary, Wgsl};
use std::f64::consts::PI;

/// Beyond the reach of reduction by quarter turns; NaN is not.
fn far(a: f64) -> bool {
    a.abs() > double::FAR
}

fn far_single(a: f32) -> bool {
    a.abs() > single::FAR
}

pub(super) const SIN: One = One {
    name: "sin",
    wgsl: Wgsl::Single("f_sin"),
    double: |lanes| reaching(lanes, double::lanes::sin, far, libm::sin),
    single: |lanes| reaching(lanes, single::lanes::sin, far_single, |a| libm::sin(f64::from(a)) as f32),
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
    wgsl: Wgsl::Single("f_cos"),
    double: |lanes| reaching(lanes, double::lanes::cos, far, libm::cos),
    single: |lanes| reaching(lanes, single::lanes::cos, far_single, |a| libm::cos(f64::from(a)) as f32),
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

pub(super) const WRAP: One = One {
    name: "wrap",
    wgsl: Wgsl::Single("f_wrap"),
    double: |lanes| reaching(lanes, double::lanes::wrap, far, wrap_far),
    single: |lanes| reaching(lanes, single::lanes::wrap, far_single, |a| wrap_far(f64::from(a)) as f32),
    derivative: |_, _, _, da| da,
    // alpha less the turns that the wrapped base makes with it, which are exactly none but at the seam.
    difference: |g, a, [base, _]| {
        let moved = g.add(base, a.delta);
        let wrapped = g.unary(Unary::Wrap, moved);
        let turns = g.sub(moved, wrapped);
        g.sub(a.delta, turns)
    },
};

fn wrap_far(a: f64) -> f64 {
    let angle = libm::atan2(libm::sin(a), libm::cos(a));
    if angle < PI { angle } else { -PI }
}

pub(super) const ATAN2: Two = Two {
    name: "atan2",
    wgsl: Wgsl::Single("f_atan2"),
    commutes: false,
    double: double::lanes::atan2,
    single: single::lanes::atan2,
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
