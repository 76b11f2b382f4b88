//! Covariances by their roots: P = U' U. Stacked roots are made triangular by orthogonal transformations, so no covariance
//! is ever taken away from another, and what a diffuse start or a long gap makes of P costs no digits (Kailath, Sayed and
//! Hassibi 2000, *Linear Estimation*, chapter 12).

use nalgebra::{DMatrix, DVector};

/// Turns `a` (at least as many rows as columns) into an upper triangle R above zeros, with R' R = A' A.
///
/// Householder reflections. Rows may differ in size by any factor (R = 1e-6 below P = 1e20), so each step begins with the
/// row that has the largest entry of its column: rounding then stays small beside each row, not only beside the largest
/// one (Cox and Higham 1998, *Stability of Householder QR factorization for weighted least squares problems*).
pub(super) fn triangularise(a: &mut DMatrix<f64>) {
    let (rows, columns) = a.shape();
    for j in 0..columns.min(rows) {
        let largest = (j..rows).max_by(|i, k| a[(*i, j)].abs().total_cmp(&a[(*k, j)].abs())).unwrap_or(j);
        a.swap_rows(j, largest);
        let scale = a[(j, j)].abs();
        if scale <= 0.0 {
            continue;
        }
        let norm = scale * (j..rows).map(|i| (a[(i, j)] / scale).powi(2)).sum::<f64>().sqrt();
        let corner = if a[(j, j)] > 0.0 { -norm } else { norm };
        // v = column - corner e_j, with v' v / 2 = norm |v_j|; both scaled by v_j.
        let lead = a[(j, j)] - corner;
        for k in j + 1..columns {
            let along = a[(j, k)] + (j + 1..rows).map(|i| a[(i, j)] / lead * a[(i, k)]).sum::<f64>();
            let along = along * (lead.abs() / norm);
            a[(j, k)] -= along;
            for i in j + 1..rows {
                let part = a[(i, j)] / lead * along;
                a[(i, k)] -= part;
            }
        }
        a[(j, j)] = corner;
        (j + 1..rows).for_each(|i| a[(i, j)] = 0.0);
    }
}

/// B with B' B = A for a positive semidefinite A, as many rows as columns: Cholesky's factor with the largest pivot first,
/// of A scaled to a unit diagonal, so that units do not decide what is rounding. `None` where A is indefinite by more.
pub(super) fn root(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    /// Pivots of the scaled matrix that rounding leaves.
    const ROUNDING: f64 = 1e-15;
    let n = a.nrows();
    let scale = a.diagonal().map(f64::sqrt);
    let share = |i: usize, j: usize| {
        let size = scale[i] * scale[j];
        if size > 0.0 { a[(i, j)] / scale[i] / scale[j] } else { a[(i, j)] }
    };
    let mut rest = DMatrix::from_fn(n, n, share);
    let mut root = DMatrix::zeros(n, n);
    let mut open: Vec<usize> = (0..n).collect();
    while let Some(at) =
        (0..open.len()).max_by(|i, k| rest[(open[*i], open[*i])].total_cmp(&rest[(open[*k], open[*k])]))
    {
        let (j, row) = (open[at], n - open.len());
        let pivot = rest[(j, j)];
        if pivot <= ROUNDING {
            break;
        }
        open.swap_remove(at);
        root[(row, j)] = pivot.sqrt();
        open.iter().for_each(|k| root[(row, *k)] = rest[(*k, j)] / pivot.sqrt());
        for &i in &open {
            open.iter().for_each(|k| rest[(i, *k)] -= root[(row, i)] * root[(row, *k)]);
        }
    }
    // The rule of `is_covariance` is stricter; here only what has no root at all is refused.
    let left = |i: &usize| open.iter().all(|k| rest[(*i, *k)].abs() <= 1e-6) && rest[(*i, *i)] >= -1e-11;
    let sound = open.iter().all(left) && scale.iter().all(|s| s.is_finite());
    root.column_iter_mut().zip(&scale).for_each(|(mut column, scale)| column *= *scale);
    sound.then_some(root)
}

/// B' B.
pub(super) fn square(root: &DMatrix<f64>, out: &mut DMatrix<f64>) {
    for j in 0..root.ncols() {
        for i in 0..=j {
            let product = root.column(i).dot(&root.column(j));
            (out[(i, j)], out[(j, i)]) = (product, product);
        }
    }
}

/// y with R' y = b, for an upper triangular R.
pub(super) fn solve_transposed(r: &DMatrix<f64>, b: &DVector<f64>, y: &mut DVector<f64>) {
    for i in 0..b.len() {
        let known: f64 = (0..i).map(|k| r[(k, i)] * y[k]).sum();
        y[i] = (b[i] - known) / r[(i, i)];
    }
}

/// The least-norm solution of the least-squares problem H x = y, as pinv(H) y, for an H of any rank: H = C Q with rows of Q
/// orthonormal (Gram and Schmidt on the rows of H, twice each), C = B T likewise by its columns, x = Q' T^-1 B' y.
pub(super) fn least_norm(h: &DMatrix<f64>, y: &DVector<f64>) -> DVector<f64> {
    /// What is left of a row beside all of it, and still a direction of its own, whatever the unit of the row.
    const RANK: f64 = 1e-12;
    let q = orthonormal(h.row_iter().map(|row| row.transpose()).collect(), RANK);
    let c = DMatrix::from_fn(h.nrows(), q.len(), |i, k| h.row(i).transpose().dot(&q[k]));
    let b = orthonormal(c.column_iter().map(|column| column.into_owned()).collect(), 0.0);
    let t = DMatrix::from_fn(b.len(), q.len(), |i, k| if i <= k { b[i].dot(&c.column(k)) } else { 0.0 });
    let mut weights = DVector::from_iterator(b.len(), b.iter().map(|b| b.dot(y)));
    for i in (0..weights.len()).rev() {
        let known: f64 = (i + 1..weights.len()).map(|k| t[(i, k)] * weights[k]).sum();
        weights[i] = (weights[i] - known) / t[(i, i)];
    }
    q.iter().zip(&weights).fold(DVector::zeros(h.ncols()), |x, (q, weight)| x + q * *weight)
}

/// An orthonormal basis of some vectors; one of which no more than the share `least` is left adds none.
fn orthonormal(vectors: Vec<DVector<f64>>, least: f64) -> Vec<DVector<f64>> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for mut v in vectors {
        let whole = v.norm();
        for _ in 0..2 {
            basis.iter().for_each(|q| v -= q * q.dot(&v));
        }
        let norm = v.norm();
        if norm > least * whole {
            basis.push(v / norm);
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn matrix(rows: usize, values: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(rows, values.len() / rows, values)
    }

    #[test]
    fn rows_of_any_size_keep_their_digits() {
        // R = 1e-12 beside P = 1e16: what is left of P is R, to the last digits. P = diag(1e16, 1), H = (1, 0).
        let mut stacked = matrix(3, &[1e-6, 0.0, 0.0, 1e8, 1e8, 0.0, 0.0, 0.0, 1.0]);
        triangularise(&mut stacked);
        let left = stacked[(1, 1)].powi(2);
        assert!((left / 1e-12 - 1.0).abs() < 1e-14, "P after the update is {left:e}");
    }

    proptest! {
        #[test]
        fn triangles_keep_the_product(values in prop::collection::vec(-2.0..2.0f64, 15), zero in 0usize..5) {
            let mut a = matrix(5, &values);
            a.row_mut(zero).fill(0.0);
            let product = a.tr_mul(&a);
            triangularise(&mut a);
            prop_assert!((0..3).all(|j| (j + 1..5).all(|i| a[(i, j)] == 0.0)), "upper triangular: {a}");
            prop_assert!((a.tr_mul(&a) - product).amax() < 1e-13);
        }

        #[test]
        fn roots_of_any_rank_and_units(values in prop::collection::vec(-2.0..2.0f64, 9), rank in 0usize..=3, unit in -60i32..60) {
            let mut factor = matrix(3, &values);
            factor.rows_mut(rank, 3 - rank).fill(0.0);
            factor.column_mut(1).apply(|v| *v *= 10f64.powi(unit));
            let a = factor.tr_mul(&factor);
            let root = root(&a).unwrap();
            let mut found = DMatrix::zeros(3, 3);
            square(&root, &mut found);
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let size = (a[(i, i)] * a[(j, j)]).sqrt();
                prop_assert!((found[(i, j)] - a[(i, j)]).abs() <= 1e-14 * size, "{found} is not {a}");
            }
        }

        /// The four conditions on a pseudoinverse, by way of its columns (Penrose 1955).
        #[test]
        fn least_norm_is_the_pseudoinverse(values in prop::collection::vec(-2.0..2.0f64, 12), rank in 0usize..=3, unit in -20i32..20) {
            let (left, right) = (matrix(4, &values), matrix(3, &values[3..]));
            let h = left.columns(0, rank) * right.rows(0, rank) * 10f64.powi(unit);
            let columns: Vec<DVector<f64>> =
                (0..4).map(|i| least_norm(&h, &DVector::from_fn(4, |k, _| f64::from(u8::from(k == i))))).collect();
            let inverse = DMatrix::from_columns(&columns);
            let (hi, ih) = (&h * &inverse, &inverse * &h);
            let size = 1.0 + h.norm() * inverse.norm();
            prop_assert!((&hi * &h - &h).norm() <= 1e-11 * size * h.norm());
            prop_assert!((&ih * &inverse - &inverse).norm() <= 1e-11 * size * inverse.norm());
            prop_assert!((&hi - hi.transpose()).norm() <= 1e-11 * size && (&ih - ih.transpose()).norm() <= 1e-11 * size);
        }
    }

    #[test]
    fn what_is_indefinite_has_no_root() {
        assert!(root(&matrix(2, &[1.0, 2.0, 2.0, 1.0])).is_none());
        assert!(root(&matrix(1, &[-1e-30])).is_none());
        assert!(root(&matrix(2, &[0.0, 0.5, 0.5, 1.0])).is_none(), "nothing correlates with what is known");
        assert!(root(&matrix(1, &[f64::NAN])).is_none());
    }
}
