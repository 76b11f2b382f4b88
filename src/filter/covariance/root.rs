//! The lower triangular root of a covariance.
#![expect(non_snake_case, reason = "Kalman notation: P, H, G")]

use super::factored::Factored;
use super::symmetric::Symmetric;
use crate::tape::{Graph, Id, Unary};

/// L with P = L L', lower triangular. Where P is singular a column of L is 0.
pub(in crate::filter) struct Root {
    /// Rows of L.
    l: Vec<Vec<Id>>,
    /// 1 / L_jj, 0 where a column is 0.
    inverse: Vec<Id>,
    /// Positive where P has such a root.
    pub(in crate::filter) positive: Vec<Id>,
}

/// A pivot up to this share of its diagonal entry is the rounding of f64.
const ROUNDING: f64 = 1e-12;

impl Root {
    /// By Cholesky.
    pub(super) fn of(g: &mut Graph, P: &Symmetric) -> Self {
        let n = P.n();
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let mut root = Self { l: vec![vec![zero; n]; n], inverse: vec![], positive: vec![] };
        for j in 0..n {
            let pivot = root.remainder(g, P, j, j);
            if pivot == P.at(j, j) {
                root.positive.push(root.not_negative(g, pivot));
            }
            let resolved = if pivot == P.at(j, j) { pivot } else { root.resolved(g, pivot, P.at(j, j)) };
            let positive = g.select(resolved, pivot, zero);
            let size = g.unary(Unary::Sqrt, positive);
            let divisor = g.select(resolved, size, one);
            let quotient = g.div(one, divisor);
            let inverse = g.select(resolved, quotient, zero);
            root.l[j][j] = size;
            for i in j + 1..n {
                let rest = root.remainder(g, P, i, j);
                root.l[i][j] = g.mul(rest, inverse);
            }
            root.inverse.push(inverse);
        }
        root
    }

    /// From P = L D L', given as the factors of the states in reverse order. D is never negative.
    pub(super) fn of_factors(g: &mut Graph, factors: &Factored) -> Self {
        let (d, u) = factors.parts();
        let n = d.len();
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let mut root = Self { l: vec![vec![zero; n]; n], inverse: vec![], positive: vec![] };
        for j in 0..n {
            let pivot = d[n - 1 - j];
            let size = g.unary(Unary::Sqrt, pivot);
            let divisor = g.select(size, size, one);
            let quotient = g.div(one, divisor);
            root.inverse.push(g.select(size, quotient, zero));
            root.positive.push(root.not_negative(g, pivot));
            for i in j..n {
                root.l[i][j] = g.mul(u[n - 1 - i][n - 1 - j], size);
            }
        }
        root
    }

    /// P_ij - sum_(k < j) L_ik L_jk.
    fn remainder(&self, g: &mut Graph, P: &Symmetric, i: usize, j: usize) -> Id {
        let known = g.dot((0..j).map(|k| (self.l[i][k], self.l[j][k])));
        g.sub(P.at(i, j), known)
    }

    /// Positive where a pivot is more than rounding; whether it is far below 0 is noted.
    fn resolved(&mut self, g: &mut Graph, pivot: Id, diagonal: Id) -> Id {
        let (share, one) = (g.constant(ROUNDING), g.constant(1.0));
        let bound = g.mul(share, diagonal);
        let least = g.add(pivot, bound);
        self.positive.push(g.select(diagonal, least, one));
        g.sub(pivot, bound)
    }

    /// Positive where a variance is not below 0.
    #[expect(clippy::unused_self, reason = "reads as a question to the root")]
    fn not_negative(&self, g: &mut Graph, variance: Id) -> Id {
        let (no, one, below) = (g.constant(-1.0), g.constant(1.0), g.neg(variance));
        g.select(below, no, one)
    }

    /// Number of columns, n.
    pub(in crate::filter) const fn n(&self) -> usize {
        self.inverse.len()
    }

    /// Column `j` of L.
    pub(in crate::filter) fn column(&self, j: usize) -> Vec<Id> {
        self.l.iter().map(|row| row[j]).collect()
    }

    /// h = g L^-1: a row of a Jacobian from what it makes of the columns of L.
    pub(in crate::filter) fn solve(&self, g: &mut Graph, row: &[Id]) -> Vec<Id> {
        let mut h = row.to_vec();
        for j in (0..h.len()).rev() {
            let known = g.dot((j + 1..h.len()).map(|k| (h[k], self.l[k][j])));
            let rest = g.sub(h[j], known);
            h[j] = g.mul(rest, self.inverse[j]);
        }
        h
    }
}
