//! What every mode goes on from: the gaussians of all, weighed by how likely the chain has come from each.
//!
//! Covariances are sums of nothing but squares and covariances, about the mixed mean itself: taking dm dm' off a sum about
//! another point loses digits where estimates part.
#![expect(non_snake_case, reason = "Kalman notation: P")]

use super::State;
use crate::filter::covariance::Symmetric;
use crate::filter::tracer::Tracer;
use crate::tape::{Graph, Id, Unary};

/// c_j = sum_i p_ij mu_i.
pub(super) fn after_step(g: &mut Graph, chain: &[Id], probabilities: &[Id]) -> Vec<Id> {
    let r = probabilities.len();
    (0..r).map(|j| g.dot((0..r).map(|i| (chain[i * r + j], probabilities[i])))).collect()
}

/// For each mode the mixture of all by p_ij mu_i / c_j. Where c_j is 0 it is the first mode's mean, known exactly.
pub(super) fn mixed(
    t: &mut Tracer<'_>,
    chain: &[Id],
    states: &[State],
    probabilities: &[Id],
    next: &[Id],
) -> Vec<State> {
    let r = states.len();
    let apart = apart(t, states);
    let g = &mut t.g;
    let never_zero = chain.iter().all(|p| g.value(*p).is_some_and(|p| p > 0.0));
    let one = g.constant(1.0);
    let mut mixed = Vec::with_capacity(r);
    for j in 0..r {
        let divisor = if never_zero { next[j] } else { g.select(next[j], next[j], one) };
        let inverse = g.div(one, divisor);
        let weights: Vec<Id> = (0..r)
            .map(|i| {
                let came = g.mul(chain[i * r + j], probabilities[i]);
                g.mul(came, inverse)
            })
            .collect();
        mixed.push(mixture(g, &weights, states, &apart));
    }
    mixed
}

/// How far each mean is from the first, the short way round where a state is an angle.
pub(super) fn apart(t: &mut Tracer<'_>, states: &[State]) -> Vec<Vec<Id>> {
    let from_first = |state: &State| {
        let pairs = state.x.iter().zip(&states[0].x).enumerate();
        pairs
            .map(|(i, (x, first))| {
                let d = t.g.sub(*x, *first);
                if t.problem.model.angles.state(i) { t.g.unary(Unary::Wrap, d) } else { d }
            })
            .collect()
    };
    states.iter().map(from_first).collect()
}

/// Mean and covariance of a mixture, whose means are `apart` from the first. Weights need not add up to one.
pub(super) fn mixture(g: &mut Graph, weights: &[Id], states: &[State], apart: &[Vec<Id>]) -> State {
    let n = states[0].x.len();
    let moved: Vec<Id> = (0..n).map(|a| g.dot(weights.iter().zip(apart).skip(1).map(|(w, d)| (*w, d[a])))).collect();
    let x = states[0].x.iter().zip(&moved).map(|(x, moved)| g.add(*x, *moved)).collect();
    let P =
        if states.len() == 2 { pair(g, weights, states, &apart[1]) } else { about(g, weights, states, apart, &moved) };
    State { x, P }
}

/// Of two: w_1 P_1 + w_2 P_2 + w_1 w_2 d d'.
fn pair(g: &mut Graph, weights: &[Id], states: &[State], d: &[Id]) -> Symmetric {
    let both = g.mul(weights[0], weights[1]);
    let spread: Vec<Id> = d.iter().map(|d| g.mul(both, *d)).collect();
    Symmetric::from_fn(d.len(), |a, b| {
        let own = weights.iter().zip(states).map(|(w, state)| (*w, state.P.at(a, b)));
        g.dot(own.chain([(spread[a], d[b])]))
    })
}

/// sum_i w_i (P_i + d_i d_i'), d_i from the mixed mean.
fn about(g: &mut Graph, weights: &[Id], states: &[State], apart: &[Vec<Id>], moved: &[Id]) -> Symmetric {
    let d: Vec<Vec<Id>> =
        apart.iter().map(|apart| apart.iter().zip(moved).map(|(d, moved)| g.sub(*d, *moved)).collect()).collect();
    let spread: Vec<Vec<Id>> = weights.iter().zip(&d).map(|(w, d)| d.iter().map(|d| g.mul(*w, *d)).collect()).collect();
    Symmetric::from_fn(moved.len(), |a, b| {
        let own = weights.iter().zip(states).map(|(w, state)| (*w, state.P.at(a, b)));
        let spread = spread.iter().zip(&d).map(|(spread, d)| (spread[a], d[b]));
        g.dot(own.chain(spread))
    })
}
