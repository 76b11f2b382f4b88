//! A curve on the graph: no lookup, a sum of what every piece rises up to x, so that derivatives and differences follow from
//! the rules of sums, products and selects.

use crate::model::{Curve, Piece};
use crate::tape::{Graph, Id};

/// The curve at x: y_0 + sum of the rises of its pieces, and the straight ends.
///
/// A piece that begins at x_k and is h long rises by p(t) at t = x - x_k, by 0 before it and by p(h) beyond. Where x is at a
/// point, its slope is that of the piece that begins there.
pub(super) fn trace(g: &mut Graph, curve: &Curve, x: Id) -> Id {
    let (xs, ys, slopes) = (curve.x(), curve.y(), curve.slopes());
    let (zero, first) = (g.constant(0.0), g.constant(ys[0]));
    let below = offset(g, x, xs[0]);
    let below_start = g.neg(below);
    let below = scaled(g, below, slopes[0]);
    let below = g.select(below_start, below, zero);
    let mut sum = g.add(first, below);
    for piece in curve.pieces() {
        let rise = rise(g, &piece, x);
        sum = g.add(sum, rise);
    }
    let last = xs.len() - 1;
    let beyond = positive_part(g, x, xs[last]);
    let beyond = scaled(g, beyond, slopes[last]);
    g.add(sum, beyond)
}

/// What a piece adds at x.
fn rise(g: &mut Graph, piece: &Piece, x: Id) -> Id {
    let t = positive_part(g, x, piece.start);
    let [square, cube] = [piece.square, piece.cube].map(|c| g.constant(c));
    let (linear, whole) = (g.constant(piece.linear), g.constant(piece.rise));
    let inner = g.mul(t, cube);
    let inner = g.add(square, inner);
    let inner = g.mul(t, inner);
    let inner = g.add(linear, inner);
    let within = g.mul(t, inner);
    let length = g.constant(piece.length);
    let left = g.sub(length, t);
    g.select(left, within, whole)
}

/// x - start, or 0 before it; at the start itself its slope is that of x.
fn positive_part(g: &mut Graph, x: Id, start: f64) -> Id {
    let (zero, t) = (g.constant(0.0), offset(g, x, start));
    let before = g.neg(t);
    g.select(before, zero, t)
}

fn offset(g: &mut Graph, x: Id, start: f64) -> Id {
    let start = g.constant(start);
    g.sub(x, start)
}

fn scaled(g: &mut Graph, a: Id, factor: f64) -> Id {
    let factor = g.constant(factor);
    g.mul(factor, a)
}
