//! The factors of a covariance, P = U D U', and the recursion on them: no difference of large numbers ever enters D, so a
//! diffuse P0 costs no digits, and P cannot become indefinite.
//!
//! Measurement update: Bierman, *Factorization Methods for Discrete Sequential Estimation* (1977), section V.3.
//! Time update: F P F' + Q is a weighted sum of squares of the columns of F U and of the factor of Q, put together one
//! column at a time by square-root-free Givens rotations (Gentleman 1973, doi 10.1093/imamat/12.3.329). Thornton's weighted
//! Gram-Schmidt (Bierman, section VI.4) yields the same factors with more operations, and subtracts projections that must
//! cancel to the last bit under a diffuse prior: it needs correctly rounded divisions, which GPUs do not promise (by
//! reciprocals, at P0/R = 1e12, it loses 4e-3 of the summed ln S of a constant-acceleration filter; rotations 5e-6).

use super::scalar::{Gain, Scalar};
use super::symmetric::Symmetric;
use crate::tape::{Graph, Id, Unary};

/// P = U D U': U unit upper triangular, D diagonal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::filter) struct Factored {
    /// Rows of U.
    u: Vec<Vec<Id>>,
    d: Vec<Id>,
}

impl Factored {
    /// A pivot up to this share of its diagonal entry is rounding, where pivots are computed in f64.
    const ROUNDING_F64: f64 = 1e-12;
    /// The same where they may be computed in f32 (which leaves about 2e-7): parameters mixed with dt or inputs.
    const ROUNDING_F32: f64 = 1e-6;

    /// D = 0.
    fn zero(g: &mut Graph, n: usize) -> Self {
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let row = |i| (0..n).map(|j| if i == j { one } else { zero }).collect();
        Self { u: (0..n).map(row).collect(), d: vec![zero; n] }
    }

    /// The factors of a positive semidefinite matrix: where a pivot is 0 but for rounding, it and its column of U are 0.
    /// A negative one stays: the matrix is no covariance, and its innovation variances are to show it.
    pub(in crate::filter) fn of(g: &mut Graph, a: &Symmetric) -> Self {
        let mut factors = Self::zero(g, a.n());
        for j in (0..a.n()).rev() {
            let pivot = factors.remainder(g, a, j, j);
            let resolved = Self::resolved(g, pivot, a.at(j, j));
            let (zero, one) = (g.constant(0.0), g.constant(1.0));
            factors.d[j] = if pivot == a.at(j, j) { pivot } else { g.select(resolved, pivot, zero) };
            let divisor = g.select(resolved, pivot, one);
            for i in 0..j {
                let rest = factors.remainder(g, a, i, j);
                let quotient = g.div(rest, divisor);
                factors.u[i][j] = g.select(resolved, quotient, zero);
            }
        }
        factors
    }

    /// a_ij - sum_(k > j) u_ik d_k u_jk.
    fn remainder(&self, g: &mut Graph, a: &Symmetric, i: usize, j: usize) -> Id {
        let mut rest = a.at(i, j);
        for k in j + 1..a.n() {
            let scaled = g.mul(self.u[j][k], self.d[k]);
            let product = g.mul(self.u[i][k], scaled);
            rest = g.sub(rest, product);
        }
        rest
    }

    /// Positive where a pivot is more than rounding.
    fn resolved(g: &mut Graph, pivot: Id, diagonal: Id) -> Id {
        let size = g.unary(Unary::Abs, pivot);
        if pivot == diagonal {
            return size;
        }
        let depends = g.depends(pivot);
        let in_f64 = depends.is_uniform() || depends.is_invariant();
        let share = g.constant(if in_f64 { Self::ROUNDING_F64 } else { Self::ROUNDING_F32 });
        let scale = g.unary(Unary::Abs, diagonal);
        let bound = g.mul(share, scale);
        g.sub(size, bound)
    }

    /// From D on the diagonal and U above it.
    pub(in crate::filter) fn from_entries(g: &mut Graph, upper: &Symmetric) -> Self {
        let mut factors = Self::zero(g, upper.n());
        for (i, j) in Symmetric::places(upper.n()) {
            let place = if i == j { &mut factors.d[i] } else { &mut factors.u[i][j] };
            *place = upper.at(i, j);
        }
        factors
    }

    /// D on the diagonal and U above it, in the storage order of [`Symmetric`].
    pub(in crate::filter) fn entries(&self) -> Vec<Id> {
        self.upper().upper().to_vec()
    }

    /// The same as a matrix of which only the upper triangle is meant.
    pub(super) fn upper(&self) -> Symmetric {
        Symmetric::from_fn(self.d.len(), |i, j| if i == j { self.d[i] } else { self.u[i][j] })
    }

    /// The sum of the squares of columns and Q.
    pub(super) fn gathered(g: &mut Graph, columns: Vec<Vec<Id>>, q: &Symmetric) -> Self {
        let (n, one) = (q.n(), g.constant(1.0));
        let mut sum = Self::zero(g, n);
        columns.into_iter().for_each(|column| sum.add(g, column, one));
        let noise = Self::of(g, q);
        sum.add_factors(g, &noise);
        sum
    }

    /// D, and the rows of U.
    pub(super) fn parts(&self) -> (&[Id], &[Vec<Id>]) {
        (&self.d, &self.u)
    }

    /// Number of states.
    pub(super) const fn n(&self) -> usize {
        self.d.len()
    }

    /// f = U' H'.
    fn seen(&self, g: &mut Graph, h: &[Id]) -> Vec<Id> {
        (0..h.len()).map(|j| g.dot((0..=j).map(|i| (self.u[i][j], h[i])))).collect()
    }

    /// R + sum_j d_j f_j^2, in the order of the update, which shares these nodes.
    pub(in crate::filter) fn variance(&self, g: &mut Graph, h: &[Id], r: Id) -> Id {
        let f = self.seen(g, h);
        f.iter().zip(&self.d).fold(r, |alpha, (f, d)| {
            let v = g.mul(*d, *f);
            let part = g.mul(v, *f);
            g.add(alpha, part)
        })
    }

    /// Bierman's update: alpha_j = alpha_(j-1) + d_j f_j^2 from alpha = D of the measurement up to S, and
    /// d_j' = d_j alpha_(j-1) / alpha_j.
    pub(in crate::filter) fn update(&mut self, g: &mut Graph, scalar: &Scalar<'_>) -> Gain {
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let f = self.seen(g, scalar.H);
        let v: Vec<Id> = f.iter().zip(&self.d).map(|(f, d)| g.mul(*d, *f)).collect();
        let involved: Vec<usize> = (0..v.len()).filter(|j| !g.is(v[*j], 0.0)).collect();
        let alone = scalar.only_state(g);
        let mut b = v.clone();
        let (mut alpha, mut inverse, mut shrink) = (scalar.D, zero, one);
        for &j in &involved {
            let lambda = g.mul(f[j], inverse);
            for (i, (row, b)) in self.u.iter_mut().zip(&mut b).take(j).enumerate() {
                let u = row[j];
                row[j] = if alone == Some(i) {
                    // Where H sees state i alone, b_i f_j = u_ij (alpha_(j-1) - D): no cancellation under a diffuse prior.
                    g.mul(u, shrink)
                } else {
                    let part = g.mul(*b, lambda);
                    g.sub(u, part)
                };
                let more = g.mul(u, v[j]);
                *b = g.add(*b, more);
            }
            let part = g.mul(v[j], f[j]);
            let next = g.add(alpha, part);
            let last = involved.last() == Some(&j);
            // Only S, the last alpha, may not be 0 (else the candidate fails); b is 0 as long as alpha is.
            let divisor = if last { scalar.gated(g, next) } else { g.select(next, next, one) };
            let open = if last { scalar.gate } else { g.mul(scalar.gate, next) };
            inverse = g.div(scalar.gate, divisor);
            let ratio = |g: &mut Graph, a: Id| {
                let ratio = g.mul(a, inverse);
                g.select(open, ratio, one)
            };
            let kept = ratio(g, alpha);
            self.d[j] = g.mul(self.d[j], kept);
            shrink = ratio(g, scalar.D);
            alpha = next;
        }
        let s = scalar.gated(g, alpha);
        let inverse = g.div(scalar.gate, s);
        let gains = b.iter().map(|b| g.mul(*b, inverse)).collect();
        Gain { K: gains, S: s, inverse }
    }

    /// F P F' + Q.
    pub(in crate::filter) fn propagate(&self, g: &mut Graph, f: &[Vec<Id>], noise: &Self) -> Self {
        let n = self.d.len();
        let mut next = Self::zero(g, n);
        for k in 0..n {
            let column = f.iter().map(|row| g.dot((0..=k).map(|j| (row[j], self.u[j][k])))).collect();
            next.add(g, column, self.d[k]);
        }
        next.add_factors(g, noise);
        next
    }

    /// What it is and another.
    fn add_factors(&mut self, g: &mut Graph, noise: &Self) {
        for k in 0..noise.d.len() {
            self.add(g, noise.u.iter().map(|row| row[k]).collect(), noise.d[k]);
        }
    }

    /// U D U'.
    pub(in crate::filter) fn product(&self, g: &mut Graph) -> Symmetric {
        Symmetric::from_fn(self.d.len(), |i, j| {
            let scaled: Vec<Id> = (j..self.d.len()).map(|k| g.mul(self.u[j][k], self.d[k])).collect();
            g.dot((j..self.d.len()).map(|k| self.u[i][k]).zip(scaled))
        })
    }

    /// kept U D U' + weight x x', both factors >= 0.
    pub(in crate::filter) fn fade(&mut self, g: &mut Graph, kept: Id, x: Vec<Id>, weight: Id) {
        for d in &mut self.d {
            *d = g.mul(kept, *d);
        }
        self.add(g, x, weight);
    }

    /// U D U' + weight x x', weight >= 0: one rotation a row, from the last one up.
    pub(super) fn add(&mut self, g: &mut Graph, mut x: Vec<Id>, mut weight: Id) {
        for j in (0..x.len()).rev() {
            let w = x[j];
            if g.is(weight, 0.0) {
                return;
            }
            if g.is(w, 0.0) {
                continue;
            }
            let scaled = g.mul(weight, w);
            let part = g.mul(scaled, w);
            let rotation = Rotation::new(g, self.d[j], part, scaled, w);
            self.d[j] = g.add(self.d[j], part);
            for (row, x) in self.u.iter_mut().zip(&mut x).take(j) {
                let u = row[j];
                row[j] = g.dot([(rotation.keep, u), (rotation.gain, *x)]);
                let projected = g.mul(w, u);
                *x = g.sub(*x, projected);
            }
            weight = g.mul(weight, rotation.keep);
        }
    }

    /// e' P^-1 e = sum_j y_j^2 / d_j with U y = e.
    pub(in crate::filter) fn normalised_square(&self, g: &mut Graph, e: &[Id]) -> (Id, Vec<Id>) {
        let mut y = e.to_vec();
        let mut sum = g.constant(0.0);
        for j in (0..y.len()).rev() {
            for i in 0..j {
                let part = g.mul(self.u[i][j], y[j]);
                y[i] = g.sub(y[i], part);
            }
            let square = g.mul(y[j], y[j]);
            let term = g.div(square, self.d[j]);
            sum = g.add(sum, term);
        }
        (sum, self.d.clone())
    }
}

/// The weights of a rotation that takes entry w of a column with weight delta into d: d' = d + delta w^2.
struct Rotation {
    /// d / d': of the old column of U, and of delta. 1 where d' is 0 because w is.
    keep: Id,
    /// delta w / d': of the new column. 0 where d' is 0.
    gain: Id,
}

impl Rotation {
    fn new(g: &mut Graph, d: Id, part: Id, scaled: Id, w: Id) -> Self {
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let surely = g.value(w).is_some();
        if g.is(d, 0.0) && surely {
            // The place was empty: it takes the whole column, and nothing is left of it.
            return Self { keep: zero, gain: g.div(one, w) };
        }
        let sum = g.add(d, part);
        let divisor = g.select(sum, sum, one);
        let keep = g.div(d, divisor);
        // With w != 0 a sum of 0 means that delta is 0 too, and nothing is to be kept for the rows above.
        let keep = if surely { keep } else { g.select(sum, keep, one) };
        // Two divisions, not one reciprocal: that of a variance that is decaying to 0 would overflow.
        Self { keep, gain: g.div(scaled, divisor) }
    }
}

#[cfg(test)]
mod tests;
