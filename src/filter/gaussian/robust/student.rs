//! Innovations with a Student's t distribution of v degrees of freedom and covariance S:
//! p = G((v + m) / 2) / G(v / 2) ((v - 2) pi)^(-m / 2) det S^(-1/2) (1 + NIS / (v - 2))^(-(v + m) / 2), G the gamma function.
//!
//! The weight (v + m) / (v + NIS), at most 1, is that of iteratively reweighted least squares; after Agamennoni, Nieto and Nebot
//! (2012, doi 10.1109/TSP.2012.2208106), in one step.

use super::{Seen, Verdict, by_count, factors};
use crate::filter::evidence::{Likelihood, Power};
use crate::filter::gaussian::update::Update;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::tape::{Binary, Function, Graph, Id, Unary};
use std::f64::consts::LN_2;

/// Weight and density of a row.
pub(super) fn update(t: &mut Tracer<'_>, row: &Row, (seen, update): (&Seen, &Update)) -> (Verdict, Likelihood) {
    let dof = seen.settings[0];
    let exponent = by_count(t, row.present.len(), |g, m| constant(g, dof, m));
    let g = &mut t.g;
    let (one, two) = (g.constant(1.0), g.constant(2.0));
    let less = g.sub(dof, two);
    let tail = g.div(seen.nis, less);
    let tail = g.add(one, tail);
    // The power m of (v + m) goes with the components, which may be missing.
    let factors = factors(g, &update.pivots, tail);
    let (expected, found) = (g.add(dof, seen.count), g.add(dof, seen.nis));
    let ratio = g.div(expected, found);
    let weight = g.binary(Binary::Min, ratio, one);
    (Verdict::Weight(weight), Likelihood { exponent, factors, powers: vec![Power { value: tail, power: dof }] })
}

/// -2 ln of what does not depend on the innovation, without det S and (2 pi)^(-m / 2).
fn constant(g: &mut Graph, dof: Id, m: usize) -> Id {
    #[expect(clippy::cast_precision_loss, reason = "a count of components")]
    let [m, half, two, turn] = [m as f64, 0.5, 2.0, LN_2].map(|value| g.constant(value));
    let more = g.add(dof, m);
    let [with, without] = [more, dof].map(|dof| {
        let half = g.mul(half, dof);
        g.call(Function::Lgamma, &[half])
    });
    let gammas = g.sub(without, with);
    let gammas = g.mul(two, gammas);
    let less = g.sub(dof, two);
    let ln = g.unary(Unary::Ln, less);
    let each = g.sub(ln, turn);
    let all = g.mul(m, each);
    g.add(gammas, all)
}
