//! How likely each mode makes a measurement, and what that makes of the probabilities.
//!
//! Likelihoods are taken relative to the mode with the least NIS and to the determinant of the first mode, component by
//! component: exp(-NIS / 2) over the root of det S by itself leaves the range of single precision, and with outliers that of
//! double precision. No logarithm is needed in the loop.

use crate::filter::evidence::Evidence;
use crate::model::family::Imm;
use crate::tape::{Binary, Graph, Id, Unary};

/// The NIS of a mode that cannot be: none that can is so large.
const NEVER: f64 = 1e30;

/// What a measurement makes of the probabilities of the modes.
pub(super) struct Weighed {
    /// Before the measurement, of what is allowed.
    pub(super) before: Vec<Id>,
    /// After it.
    pub(super) after: Vec<Id>,
    /// The least NIS among the modes that can be.
    pub(super) low: Id,
    /// By how much the likelihood of the row exceeds that of the first mode with the least NIS in the place of its own.
    pub(super) weight: Id,
}

/// w_j = c_j sqrt(prod_i S_1i / S_ji) exp(-(NIS_j - low) / 2), and from it mu_j = w_j / sum w, at least [`Imm::FLOOR`].
pub(super) fn weighed(g: &mut Graph, predicted: &[Id], allowed: &[Option<Id>], seen: &[Evidence]) -> Weighed {
    let restricted = allowed.iter().any(Option::is_some);
    let gate = |g: &mut Graph, (value, allowed): (Id, &Option<Id>)| match allowed {
        Some(allowed) => g.mul(value, *allowed),
        None => value,
    };
    let before: Vec<Id> = predicted.iter().copied().zip(allowed).map(|pair| gate(g, pair)).collect();
    let low = least(g, &before, seen);
    let mut weights = Vec::with_capacity(before.len());
    for (c, own) in before.iter().zip(seen) {
        let (half, beyond) = (g.constant(-0.5), g.sub(own.likelihood.exponent, low));
        let exponent = g.mul(half, beyond);
        let mut weight = g.unary(Unary::Exp, exponent);
        if let Some(ratio) = determinants(g, &seen[0], own) {
            let root = g.unary(Unary::Sqrt, ratio);
            weight = g.mul(weight, root);
        }
        weights.push(g.mul(*c, weight));
    }
    let total = sum(g, &weights);
    let one = g.constant(1.0);
    let inverse = g.div(one, total);
    let floor = g.constant(Imm::FLOOR);
    let after = weights.iter().zip(allowed).map(|(weight, allowed)| {
        let share = g.mul(*weight, inverse);
        let share = g.binary(Binary::Max, share, floor);
        gate(g, (share, allowed))
    });
    let after = after.collect();
    // What is known to be ruled out is no part of the prediction.
    let weight = if restricted {
        let all = sum(g, &before);
        g.div(total, all)
    } else {
        total
    };
    let before = if restricted { shares(g, &before) } else { before };
    Weighed { before, after, low, weight }
}

/// The least NIS among the modes that can be.
fn least(g: &mut Graph, before: &[Id], seen: &[Evidence]) -> Id {
    let never = g.constant(NEVER);
    let possible =
        before.iter().zip(seen).map(|(c, own)| g.select(*c, own.likelihood.exponent, never)).collect::<Vec<_>>();
    possible.into_iter().reduce(|a, b| g.binary(Binary::Min, a, b)).unwrap_or(never)
}

/// prod_i S_1i / S_ji; `None` where it is 1 by its form.
fn determinants(g: &mut Graph, first: &Evidence, own: &Evidence) -> Option<Id> {
    let pairs =
        first.likelihood.factors.iter().zip(&own.likelihood.factors).filter(|(first, own)| first.value != own.value);
    let ratios: Vec<Id> = pairs.map(|(first, own)| g.div(first.value, own.value)).collect();
    ratios.into_iter().reduce(|a, b| g.mul(a, b))
}

fn sum(g: &mut Graph, values: &[Id]) -> Id {
    let zero = g.constant(0.0);
    values.iter().fold(zero, |sum, value| g.add(sum, *value))
}

/// The same as parts of one.
fn shares(g: &mut Graph, values: &[Id]) -> Vec<Id> {
    let all = sum(g, values);
    let one = g.constant(1.0);
    let inverse = g.div(one, all);
    values.iter().map(|value| g.mul(*value, inverse)).collect()
}
