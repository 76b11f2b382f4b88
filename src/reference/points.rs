//! Sigma points, and the moments of a function from its values there.
//!
//! Julier and Uhlmann (2004), *Unscented filtering and nonlinear estimation*, doi 10.1109/JPROC.2003.823141; Arasaratnam and
//! Haykin (2009) for the cubature rule, which is alpha = 1, beta = kappa = 0.

use nalgebra::{DMatrix, DVector};

use super::estimate::{count, symmetrise};

/// Where the points are, and their weights: 1 / 2c each but for the centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rule {
    /// c = alpha^2 (n + kappa): points are x +- sqrt(c) L_j.
    spread: f64,
    /// The weight of the centre in a covariance: 1 - n / c + 1 - alpha^2 + beta.
    centre: f64,
    /// beta - alpha^2.
    skew: f64,
}

/// Moments of y = g(x).
#[derive(Debug)]
pub(super) struct Moments {
    pub(super) mean: DVector<f64>,
    /// Of y.
    pub(super) covariance: DMatrix<f64>,
    /// G with Cov(x, y) = L G, one row a column of L.
    pub(super) cross: DMatrix<f64>,
    /// What `covariance` has beyond that of the best affine g: Cov(y) - A P A' with A P = Cov(y, x).
    pub(super) excess: DMatrix<f64>,
}

impl Rule {
    /// For n states.
    pub(super) fn new(n: usize, [alpha, beta, kappa]: [f64; 3]) -> Self {
        let (n, square) = (count(n), alpha * alpha);
        let spread = square * (n + kappa);
        Self { spread, centre: 1.0 - n / spread + 1.0 - square + beta, skew: beta - square }
    }

    /// x, then x + sqrt(c) L_j and x - sqrt(c) L_j for each column of L, in their order.
    pub(super) fn points(&self, x: &DVector<f64>, root: &DMatrix<f64>) -> Vec<DVector<f64>> {
        let step = self.spread.sqrt();
        let around = root.column_iter().flat_map(|column| [x + step * column, x - step * column]);
        std::iter::once(x.clone()).chain(around).collect()
    }

    /// From the values at the points, in their order; `difference` is y - y0, which of angles is in [-pi, pi). The mean is
    /// y0 + sum W (y - y0), which is sum W y where nothing is an angle.
    pub(super) fn moments(
        &self,
        values: &[DVector<f64>],
        difference: impl Fn(&DVector<f64>, &DVector<f64>) -> DVector<f64>,
    ) -> Moments {
        let (weight, step) = (0.5 / self.spread, self.spread.sqrt());
        let (centre, around) = (&values[0], &values[1..]);
        let away: Vec<DVector<f64>> = around.iter().map(|y| difference(y, centre)).collect();
        let size = centre.len();
        let shift = away.iter().fold(DVector::zeros(size), |sum, d| sum + weight * d);
        let square = |d: &DVector<f64>| d * d.transpose();
        let mut covariance = self.centre * square(&shift);
        let mut excess = self.skew * square(&shift);
        let mut cross = DMatrix::zeros(away.len() / 2, size);
        for (j, pair) in away.chunks(2).enumerate() {
            let (even, odd) = (&pair[0] + &pair[1], &pair[0] - &pair[1]);
            pair.iter().for_each(|d| covariance += weight * square(&(d - &shift)));
            excess += 0.5 * weight * square(&even);
            cross.row_mut(j).copy_from(&(weight * step * odd.transpose()));
        }
        symmetrise(&mut covariance);
        Moments { mean: centre + shift, covariance, cross, excess }
    }
}

/// Lower triangular L with L L' = P, states in their order; where a pivot is 0 so is its column. `None` where P is not
/// positive semidefinite.
pub(super) fn lower(p: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    /// What rounding leaves of a pivot that is 0, and of what stands beside it.
    const ROUNDING: f64 = 1e-14;
    let n = p.nrows();
    let mut l = DMatrix::zeros(n, n);
    for j in 0..n {
        let rest = |i: usize, l: &DMatrix<f64>| p[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
        let pivot: f64 = rest(j, &l);
        let zero = pivot.abs() <= ROUNDING * p[(j, j)];
        let sound = zero || (pivot > 0.0 && pivot.is_finite());
        if !sound {
            return None;
        }
        for i in j..n {
            let entry = rest(i, &l);
            if !zero {
                l[(i, j)] = entry / pivot.sqrt();
            } else if entry.abs() > ROUNDING.sqrt() * (p[(i, i)] * p[(j, j)]).sqrt() {
                return None;
            }
        }
    }
    Some(l)
}

/// A with A P = Cov(y, x), from Cov(x, y) = L G and P = L L': A = G' L^-1, 0 in the directions that L lacks.
pub(super) fn slope(cross: &DMatrix<f64>, root: &DMatrix<f64>) -> DMatrix<f64> {
    let n = root.nrows();
    let mut slope = DMatrix::zeros(cross.ncols(), n);
    // A L = G', column by column from the last.
    for j in (0..n).rev() {
        let mut column = cross.row(j).transpose();
        for i in j + 1..n {
            column -= root[(i, j)] * slope.column(i);
        }
        if root[(j, j)] > 0.0 {
            slope.column_mut(j).copy_from(&(column / root[(j, j)]));
        }
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_map_has_its_own_moments() {
        let p = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 3.0]);
        let a = DMatrix::from_row_slice(1, 2, &[2.0, -3.0]);
        let root = lower(&p).expect("positive");
        for settings in [[1.0, 2.0, 1.0], [0.1, 2.0, 0.0], [1.0, 0.0, 0.0]] {
            let rule = Rule::new(2, settings);
            let values: Vec<_> =
                rule.points(&DVector::from_vec(vec![5.0, 7.0]), &root).iter().map(|x| &a * x).collect();
            let Moments { mean, covariance, cross, excess } = rule.moments(&values, |y, centre| y - centre);
            assert!((mean[0] + 11.0).abs() < 1e-11, "{settings:?}: mean {mean}");
            assert!((covariance[0] - 31.0).abs() < 1e-9, "{settings:?}: 16 - 12 + 27, found {covariance}");
            assert!((slope(&cross, &root) - &a).amax() < 1e-11 && excess.amax() < 1e-9, "{settings:?}");
        }
    }

    /// y = x^2 of N(0, 1) by points at 0 and +-1.5: mean 1, variance w0 + 2 w (1.5^2 - 1)^2, no slope, all of it excess.
    #[test]
    fn a_square_is_excess_alone() {
        let rule = Rule::new(1, [1.0, 2.0, 1.25]);
        let root = DMatrix::identity(1, 1);
        let values: Vec<_> = rule.points(&DVector::zeros(1), &root).iter().map(|x| x.component_mul(x)).collect();
        let Moments { mean, covariance, cross, excess } = rule.moments(&values, |y, centre| y - centre);
        let expected = (1.0 - 1.0 / 2.25 + 2.0) + 2.0 * (0.5 / 2.25) * 1.25f64.powi(2);
        assert!((mean[0] - 1.0).abs() < 1e-15 && cross.amax() < 1e-15);
        assert!((covariance[0] - expected).abs() < 1e-14, "{covariance}");
        assert!((excess[0] - expected).abs() < 1e-14, "{excess}");
    }

    #[test]
    fn a_singular_covariance_has_a_root_and_an_indefinite_one_none() {
        let flat = DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0, 1.0]);
        let root = lower(&flat).expect("semidefinite");
        assert!((&root * root.transpose() - flat).amax() < 1e-15);
        assert!(lower(&DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0])).is_none());
        assert!(lower(&DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 1.0, 1.0])).is_none());
        assert!(lower(&DMatrix::from_element(1, 1, f64::NAN)).is_none());
    }
}
