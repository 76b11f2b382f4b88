//! Symmetric matrices of graph nodes: only the upper triangle exists, so symmetry cannot be lost.

use crate::tape::{Graph, Id, Unary};

/// A symmetric n x n matrix of nodes, upper triangle by rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::filter) struct Symmetric {
    n: usize,
    upper: Vec<Id>,
}

impl Symmetric {
    /// From a function of (i, j) with i <= j.
    pub(in crate::filter) fn from_fn(n: usize, mut entry: impl FnMut(usize, usize) -> Id) -> Self {
        let upper = Self::places(n).map(|(i, j)| entry(i, j)).collect();
        Self { n, upper }
    }

    /// (i, j) of the upper triangle, in storage order.
    pub(in crate::filter) fn places(n: usize) -> impl Iterator<Item = (usize, usize)> {
        (0..n).flat_map(move |i| (i..n).map(move |j| (i, j)))
    }

    /// Entry (i, j) = (j, i).
    pub(in crate::filter) fn at(&self, i: usize, j: usize) -> Id {
        let (i, j) = if i <= j { (i, j) } else { (j, i) };
        self.upper[i * self.n - i * (i + 1) / 2 + j]
    }

    /// The upper triangle, in storage order.
    pub(in crate::filter) fn upper(&self) -> &[Id] {
        &self.upper
    }

    /// The diagonal, n.
    pub(in crate::filter) fn diagonal(&self) -> Vec<Id> {
        (0..self.n).map(|i| self.at(i, i)).collect()
    }

    pub(in crate::filter) const fn n(&self) -> usize {
        self.n
    }

    /// The same with rows and columns in reverse order.
    pub(in crate::filter) fn reversed(&self) -> Self {
        let last = self.n.saturating_sub(1);
        Self::from_fn(self.n, |i, j| self.at(last - i, last - j))
    }

    /// The sum with another of its size.
    pub(in crate::filter) fn plus(&self, g: &mut Graph, other: &Self) -> Self {
        Self::from_fn(self.n, |i, j| g.add(self.at(i, j), other.at(i, j)))
    }

    /// Factors A = L D L', L unit lower triangular: (rows of L, D). Structural zeros stay zeros. A must be definite.
    pub(in crate::filter) fn ldl(&self, g: &mut Graph) -> (Vec<Vec<Id>>, Vec<Id>) {
        self.ldl_over(g, |_, pivot| pivot)
    }

    /// The same for a semidefinite A: below a pivot of 0 everything is 0, and so is its column of L.
    pub(in crate::filter) fn ldl_semidefinite(&self, g: &mut Graph) -> (Vec<Vec<Id>>, Vec<Id>) {
        /// Far below any covariance, and normal in f32; what is not 0 over it makes a later pivot hugely negative.
        const TINY: f64 = 1e-30;
        self.ldl_over(g, |g, pivot| {
            let (size, tiny) = (g.unary(Unary::Abs, pivot), g.constant(TINY));
            g.select(size, pivot, tiny)
        })
    }

    /// With what `divisor` makes of a pivot in its place as a divisor.
    fn ldl_over(&self, g: &mut Graph, divisor: impl Fn(&mut Graph, Id) -> Id) -> (Vec<Vec<Id>>, Vec<Id>) {
        let n = self.n;
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let mut l = vec![vec![zero; n]; n];
        let mut d = Vec::with_capacity(n);
        for i in 0..n {
            l[i][i] = one;
            for j in 0..i {
                // l_ij d_j = a_ij - sum_k l_ik l_jk d_k
                let mut rest = self.at(i, j);
                for k in 0..j {
                    let scaled = g.mul(l[j][k], d[k]);
                    let product = g.mul(l[i][k], scaled);
                    rest = g.sub(rest, product);
                }
                let pivot = divisor(g, d[j]);
                l[i][j] = g.div(rest, pivot);
            }
            let mut pivot = self.at(i, i);
            for j in 0..i {
                let scaled = g.mul(l[i][j], d[j]);
                let product = g.mul(l[i][j], scaled);
                pivot = g.sub(pivot, product);
            }
            d.push(pivot);
        }
        (l, d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tape::Leaf;

    #[test]
    fn storage_order_is_the_upper_triangle() {
        let mut g = Graph::default();
        let s = Symmetric::from_fn(4, |i, j| g.constant((10 * i + j) as f64));
        for (k, (i, j)) in Symmetric::places(4).enumerate() {
            assert_eq!(s.at(i, j), s.upper()[k], "({i}, {j})");
            assert_eq!(s.at(j, i), s.at(i, j), "symmetric");
        }
    }

    #[test]
    fn ldl_rebuilds_the_matrix() {
        let mut g = Graph::default();
        let values = [[4.0, 2.0, 0.6], [2.0, 3.0, 0.4], [0.6, 0.4, 2.0]];
        let a = Symmetric::from_fn(3, |i, j| g.constant(values[i][j]));
        let (l, d) = a.ldl(&mut g);
        for i in 0..3 {
            for j in 0..3 {
                let value: f64 = (0..3)
                    .map(|k| g.value(l[i][k]).unwrap() * g.value(d[k]).unwrap() * g.value(l[j][k]).unwrap())
                    .sum();
                assert!((value - values[i][j]).abs() < 1e-15, "({i}, {j}): {value}");
            }
        }
    }

    #[test]
    fn ldl_of_a_singular_matrix_is_finite() {
        let mut g = Graph::default();
        let values = [[0.0, 0.0, 0.0], [0.0, 3.0, 0.6], [0.0, 0.6, 2.0]];
        let a = Symmetric::from_fn(3, |i, j| g.constant(values[i][j]));
        let (l, d) = a.ldl_semidefinite(&mut g);
        for zero in [l[1][0], l[2][0], d[0]] {
            assert!(g.is(zero, 0.0), "nothing stands below a zero pivot");
        }
        assert!(g.is(l[2][1], 0.6 / 3.0), "and the rest is factored as ever");
    }

    #[test]
    fn a_diagonal_matrix_costs_nothing() {
        let mut g = Graph::default();
        let zero = g.constant(0.0);
        let r: Vec<Id> = (0..3).map(|i| g.leaf(Leaf::Parameter(i))).collect();
        let a = Symmetric::from_fn(3, |i, j| if i == j { r[i] } else { zero });
        assert_eq!(a.ldl(&mut g).1, r, "D is the diagonal itself");
    }
}
