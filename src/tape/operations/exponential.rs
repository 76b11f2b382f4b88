//! Exponentials, logarithms and powers.

use super::super::elementary::{double, single};
use super::{Graph, Id, Moved, One, Two, Unary, Wgsl};

pub(super) const EXP: One = One {
    name: "exp",
    wgsl: Wgsl::Single("f_exp"),
    double: double::lanes::exp,
    single: single::lanes::exp,
    derivative: |g, y, _, da| g.mul(y, da),
    difference: |g, a, [base, _]| {
        let growth = g.unary(Unary::Expm1, a.delta);
        g.mul(base, growth)
    },
};

pub(super) const EXPM1: One = One {
    name: "expm1",
    wgsl: Wgsl::Single("f_expm1"),
    double: double::lanes::expm1,
    single: single::lanes::expm1,
    derivative: |g, y, _, da| {
        let exp = one_plus(g, y);
        g.mul(exp, da)
    },
    difference: |g, a, [base, _]| {
        let (exp, growth) = (one_plus(g, base), g.unary(Unary::Expm1, a.delta));
        g.mul(exp, growth)
    },
};

pub(super) const LN: One = One {
    name: "ln",
    wgsl: Wgsl::Single("f_ln"),
    double: double::lanes::ln,
    single: single::lanes::ln,
    derivative: |g, _, a, da| g.div(da, a),
    difference: |g, a, _| {
        let share = g.div(a.delta, a.base);
        g.unary(Unary::Log1p, share)
    },
};

pub(super) const LOG1P: One = One {
    name: "log1p",
    wgsl: Wgsl::Single("f_log1p"),
    double: double::lanes::log1p,
    single: single::lanes::log1p,
    derivative: |g, _, a, da| {
        let sum = one_plus(g, a);
        g.div(da, sum)
    },
    difference: |g, a, _| {
        let sum = one_plus(g, a.base);
        let share = g.div(a.delta, sum);
        g.unary(Unary::Log1p, share)
    },
};

fn one_plus(g: &mut Graph, a: Id) -> Id {
    let one = g.constant(1.0);
    g.add(one, a)
}

pub(super) const POWER: Two = Two {
    name: "power",
    wgsl: Wgsl::Single("f_power"),
    commutes: false,
    double: lanes!(|a, b| libm::pow(a, b)),
    single: single::lanes::power,
    derivative: power_rule,
    difference: |g, [a, b], [base, _]| {
        if let Some(exponent) = whole(g, b.value) {
            return whole_power(g, a, exponent);
        }
        // base (A^B / a^b - 1), the quotient by its logarithm: b ln(A / a) + beta ln A.
        let share = g.div(a.delta, a.base);
        let (log1p, ln) = (g.unary(Unary::Log1p, share), g.unary(Unary::Ln, a.value));
        let logarithm = g.dot([(b.base, log1p), (b.delta, ln)]);
        let growth = g.unary(Unary::Expm1, logarithm);
        g.mul(base, growth)
    },
};

/// d a^b = b a^(b-1) da + a^b ln(a) db.
fn power_rule(g: &mut Graph, y: Id, [a, b]: [Id; 2], [da, db]: [Id; 2]) -> Id {
    let one = g.constant(1.0);
    let lower = g.sub(b, one);
    let power = g.pow(a, lower);
    let slope = g.mul(b, power);
    let base = g.mul(slope, da);
    if g.is(db, 0.0) {
        return base;
    }
    let ln = g.unary(Unary::Ln, a);
    let rate = g.mul(y, ln);
    let exponent = g.mul(rate, db);
    g.add(base, exponent)
}

/// Whole powers up to this are differences of products, which negative bases have too.
const MOST: f64 = 64.0;

fn whole(g: &Graph, exponent: Id) -> Option<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, and from 1 to 64")]
    g.value(exponent).filter(|b| (1.0..=MOST).contains(b) && b.fract() <= 0.0).map(|b| b as u32)
}

/// A^n - a^n = (A^(n-1) - a^(n-1)) A + a^(n-1) alpha.
fn whole_power(g: &mut Graph, a: Moved, exponent: u32) -> Id {
    let (mut delta, mut power) = (a.delta, a.base);
    for _ in 1..exponent {
        delta = g.dot([(delta, a.value), (power, a.delta)]);
        power = g.mul(power, a.base);
    }
    delta
}
