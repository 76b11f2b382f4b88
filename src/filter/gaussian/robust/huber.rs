//! Huber's density of the normalised innovation d: exp(-rho(d)) / c(k), rho = d^2 / 2 up to k and k d - k^2 / 2 beyond, over the
//! root of det S; with c(k) its integral, 2 pi (1 + exp(-k^2 / 2) / k^2) in two dimensions and
//! sqrt(2 pi) erf(k / sqrt 2) + 2 / k exp(-k^2 / 2) in one.
//!
//! d is the root of the NIS of one or two measurements; of more each decorrelated one has its own.

use super::{Seen, Verdict, by_count, factors};
use crate::filter::evidence::Likelihood;
use crate::filter::gaussian::update::Update;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::tape::{Function, Graph, Id, Unary};
use std::f64::consts::{SQRT_2, TAU};

/// min(1, k / d).
pub(in crate::filter::gaussian) fn weight(g: &mut Graph, k: Id, nis: Id) -> Id {
    let one = g.constant(1.0);
    let beyond = beyond(g, k, nis);
    let d = distance(g, beyond, nis);
    let ratio = g.div(k, d);
    g.select(beyond, ratio, one)
}

/// Weight and density of a row.
pub(super) fn update(t: &mut Tracer<'_>, row: &Row, (seen, update): (&Seen, &Update)) -> (Verdict, Likelihood) {
    let (k, one, zero) = (seen.settings[0], t.g.constant(1.0), t.g.constant(0.0));
    let factors = factors(&mut t.g, &update.pivots, one);
    if update.weights.is_empty() {
        let constant = by_count(t, row.present.len(), |g, m| constant(g, k, m));
        let rho = twice_rho(&mut t.g, k, seen.nis);
        let exponent = t.g.add(rho, constant);
        let weight = weight(&mut t.g, k, seen.nis);
        return (Verdict::Weight(weight), Likelihood { exponent, factors, powers: vec![] });
    }
    let g = &mut t.g;
    let constant = constant(g, k, 1);
    let (mut exponent, mut rejected) = (g.mul(seen.count, constant), zero);
    for (nis, weight) in update.nis.iter().zip(&update.weights) {
        let rho = twice_rho(g, k, *nis);
        exponent = g.add(exponent, rho);
        let left = g.sub(one, *weight);
        rejected = g.add(rejected, left);
    }
    let count = g.select(seen.any, seen.count, one);
    let rejected = g.div(rejected, count);
    (Verdict::Weighed(rejected), Likelihood { exponent, factors, powers: vec![] })
}

/// Positive where d is above k.
fn beyond(g: &mut Graph, k: Id, nis: Id) -> Id {
    let square = g.mul(k, k);
    g.sub(nis, square)
}

/// d beyond k, else 1.
fn distance(g: &mut Graph, beyond: Id, nis: Id) -> Id {
    let one = g.constant(1.0);
    let square = g.select(beyond, nis, one);
    g.unary(Unary::Sqrt, square)
}

/// 2 rho(d): NIS up to k^2, beyond 2 k d - k^2.
fn twice_rho(g: &mut Graph, k: Id, nis: Id) -> Id {
    let beyond = beyond(g, k, nis);
    let d = distance(g, beyond, nis);
    let (two, square) = (g.constant(2.0), g.mul(k, k));
    let slope = g.mul(two, k);
    let line = g.mul(slope, d);
    let line = g.sub(line, square);
    g.select(beyond, line, nis)
}

/// 2 ln c(k) - m ln 2 pi, m 1 or 2.
fn constant(g: &mut Graph, k: Id, m: usize) -> Id {
    let [half, one, two, root] = [-0.5, 1.0, 2.0, SQRT_2].map(|value| g.constant(value));
    let square = g.mul(k, k);
    let exponent = g.mul(half, square);
    let bell = g.unary(Unary::Exp, exponent);
    if m == 2 {
        // The 2 pi of c(k) is that of two dimensions.
        let tail = g.div(bell, square);
        let whole = g.add(one, tail);
        let ln = g.unary(Unary::Ln, whole);
        return g.mul(two, ln);
    }
    let argument = g.div(k, root);
    let inside = g.call(Function::Erf, &[argument]);
    let (tail, turn) = (g.div(two, k), g.constant(TAU.sqrt()));
    let tail = g.mul(tail, bell);
    let tail = g.div(tail, turn);
    let whole = g.add(inside, tail);
    let ln = g.unary(Unary::Ln, whole);
    g.mul(two, ln)
}
