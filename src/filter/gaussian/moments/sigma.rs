//! Sigma points: formulas at x and at x +- c L_j, P = L L'. Julier and Uhlmann (2004), doi 10.1109/JPROC.2003.823141; with equal
//! weights and no centre Arasaratnam and Haykin (2009), doi 10.1109/TAC.2009.2019800.
//!
//! Not by weighted sums of values but by differences from the centre, D+ and D- along each column: even parts e = D+ + D- make
//! the mean and the excess noise, odd parts o = D+ - D- the linear map. The moments are those of the textbook, for any spread
//! of the points, without a difference of large numbers.

use super::tangent::{Tangent, tangent};
use super::{Columns, Map, MapNodes, MomentRule, Moments, exact};
use crate::filter::carried::narrow;
use crate::filter::covariance::{Covariance, Root, Symmetric};
use crate::filter::error::TraceError;
use crate::filter::form::Carrying;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units::scaled;
use crate::tape::{Centre, Graph, Id, Leaf, Unary};
use std::collections::HashMap;

/// Which points.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) enum Points {
    /// Those of the settings alpha, beta and kappa.
    Settings,
    /// alpha = 1, beta = kappa = 0.
    Equal,
}

/// E f(x) and its covariance from points.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Sigma {
    points: Points,
    /// See [`Carrying::affine`].
    affine: bool,
}

/// What points are taken and how they count.
struct Weights {
    /// c: points are c L_j away from the centre, c^2 = n + lambda = alpha^2 (n + kappa).
    reach: Id,
    /// w = 1 / (2 c^2), of each point in the mean.
    w: Id,
    /// w c = 1 / (2 c).
    odd: Id,
    /// beta - alpha^2: how much more the centre counts in the covariance than in the mean.
    centre: Id,
}

/// Even and odd parts of formulas along the columns of L: one a column, each with one a row.
struct Parts {
    even: Vec<Vec<Id>>,
    odd: Vec<Vec<Id>>,
}

impl Sigma {
    pub(in crate::filter) const fn new(carrying: Carrying, points: Points) -> Self {
        Self { points, affine: carrying.affine }
    }

    fn weights(self, g: &mut Graph, n: usize, settings: &[Id]) -> Weights {
        let [one, two] = [1.0, 2.0].map(|value| g.constant(value));
        let n = g.constant(u32::try_from(n).unwrap_or(u32::MAX).into());
        let zero = g.constant(0.0);
        let [alpha, beta, kappa] = match (self.points, settings) {
            (Points::Settings, [alpha, beta, kappa, ..]) => [*alpha, *beta, *kappa],
            _ => [one, zero, zero],
        };
        let spread = g.add(n, kappa);
        // A candidate whose spread is not positive fails by its settings; its points are anywhere but at no number.
        let spread = if g.value(spread).is_some() { spread } else { g.select(spread, spread, one) };
        let root = g.unary(Unary::Sqrt, spread);
        let reach = g.mul(alpha, root);
        let (square, twice) = (g.mul(alpha, alpha), g.mul(two, reach));
        let (centre, odd) = (g.sub(beta, square), g.div(one, twice));
        let w = g.div(odd, reach);
        Weights { reach, w, odd, centre }
    }
}

impl MomentRule for Sigma {
    fn through(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        map: Map,
        x: &[Id],
        P: &Covariance,
    ) -> Result<Moments, TraceError> {
        let formulas = map.of(&row.model);
        if self.affine && formulas.is_affine() {
            return exact(t, row, map, x, P);
        }
        let weights = self.weights(&mut t.g, x.len(), &row.model.settings);
        let Tangent { fixed, mut value, mut jacobian, centre } = tangent(t, row, map, x);
        let root = P.root(&mut t.g);
        let own: Vec<bool> = formulas.affine.iter().map(|affine| *affine && self.affine).collect();
        let parts = parts(t, (formulas, map), &own, (&root, &centre), &weights);
        let g = &mut t.g;
        let mut moved = vec![];
        for (i, value) in value.iter_mut().enumerate() {
            let zero = g.constant(0.0);
            let even = parts.even.iter().fold(zero, |sum, even| g.add(sum, even[i]));
            moved.push(g.mul(weights.w, even));
            *value = g.add(*value, moved[i]);
        }
        let mut columns =
            Columns { linear: vec![vec![]; root.n()], excess: excess_columns(g, &weights, &parts, &moved) };
        for (i, row) in jacobian.iter_mut().enumerate() {
            let along = |g: &mut Graph, j: usize| {
                if own[i] {
                    // The row is its own tangent.
                    g.dot(row.iter().copied().zip(root.column(j)))
                } else {
                    g.mul(weights.odd, parts.odd[j][i])
                }
            };
            let seen: Vec<Id> = (0..root.n()).map(|j| along(g, j)).collect();
            columns.linear.iter_mut().zip(&seen).for_each(|(column, seen)| column.push(*seen));
            if !own[i] {
                *row = root.solve(g, &seen);
            }
        }
        let excess = excess(g, &weights, &parts, &moved);
        let moved = vec![g.constant(0.0); fixed.len()];
        let (excess, columns, positive) = (Some(excess), Some(columns), root.positive);
        Ok(Moments { fixed, moved, linear: value, jacobian, excess, columns, positive })
    }
}

/// Even and odd parts of the rows that are not exact, 0 for the others, in the filter's units.
fn parts(
    t: &mut Tracer<'_>,
    (formulas, map): (&MapNodes, Map),
    exact: &[bool],
    (root, centre): (&Root, &Centre),
    weights: &Weights,
) -> Parts {
    let curved: Vec<usize> = (0..exact.len()).filter(|i| !exact[*i]).collect();
    let values: Vec<Id> = curved.iter().map(|i| formulas.values[*i]).collect();
    let zero = t.g.constant(0.0);
    let mut parts = Parts { even: vec![], odd: vec![] };
    for j in 0..root.n() {
        let (mut forth, mut back) = (HashMap::new(), HashMap::new());
        for (i, (entry, unit)) in root.column(j).into_iter().zip(&t.units.states).enumerate() {
            let step = t.g.mul(weights.reach, entry);
            let step = t.g.scale(step, *unit);
            forth.insert(Leaf::Variable(narrow(i)), step);
            back.insert(Leaf::Variable(narrow(i)), t.g.neg(step));
        }
        let mut rows = |steps: &HashMap<Leaf, Id>| {
            let moved = t.g.difference_from(&values, centre, steps);
            let mut all = vec![zero; exact.len()];
            curved.iter().zip(moved).for_each(|(i, moved)| all[*i] = moved);
            scaled(&mut t.g, &all, map.units(t.units))
        };
        let (forth, back) = (rows(&forth), rows(&back));
        let pairs = || forth.iter().zip(&back);
        parts.even.push(pairs().map(|(forth, back)| t.g.add(*forth, *back)).collect());
        parts.odd.push(pairs().map(|(forth, back)| t.g.sub(*forth, *back)).collect());
    }
    parts
}

/// w / 2 sum e e' + (beta - alpha^2) d d', with d = w sum e.
fn excess(g: &mut Graph, weights: &Weights, parts: &Parts, d: &[Id]) -> Symmetric {
    let half = g.constant(0.5);
    let half = g.mul(half, weights.w);
    let scaled: Vec<Id> = d.iter().map(|d| g.mul(weights.centre, *d)).collect();
    Symmetric::from_fn(d.len(), |i, j| {
        let squares = g.dot(parts.even.iter().map(|even| (even[i], even[j])));
        let squares = g.mul(half, squares);
        let centre = g.mul(scaled[i], d[j]);
        g.add(squares, centre)
    })
}

/// The same as squares of columns: sqrt(w / 2) (e_j - 2 t d) with t = (1 - sqrt(1 + 2 k n w)) / (2 n w), k = beta - alpha^2,
/// whatever the sign of k.
fn excess_columns(g: &mut Graph, weights: &Weights, parts: &Parts, d: &[Id]) -> Vec<Vec<Id>> {
    let (half, one, two) = (g.constant(0.5), g.constant(1.0), g.constant(2.0));
    let n = g.constant(u32::try_from(parts.even.len()).unwrap_or(u32::MAX).into());
    let (share, all) = (g.mul(half, weights.w), g.mul(n, weights.w));
    let size = g.unary(Unary::Sqrt, share);
    let twice = g.mul(two, all);
    let more = g.mul(twice, weights.centre);
    let more = g.add(one, more);
    let more = g.unary(Unary::Positive, more);
    let root = g.unary(Unary::Sqrt, more);
    let less = g.sub(one, root);
    // 2 t.
    let shift = g.div(less, all);
    let column = |even: &Vec<Id>| {
        let entries = even.iter().zip(d).map(|(even, d)| {
            let moved = g.mul(shift, *d);
            let entry = g.sub(*even, moved);
            g.mul(size, entry)
        });
        entries.collect()
    };
    parts.even.iter().map(column).collect()
}
