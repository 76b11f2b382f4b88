//! Moments of a mixture of gaussians.

use nalgebra::{DMatrix, DVector};

use super::estimate::{Estimate, symmetrise};

/// Gaussians of one size.
pub(super) struct Mixture<'a> {
    pub(super) estimates: &'a [Estimate],
    /// What a difference of two means of a component is: of angles the short way round.
    pub(super) between: &'a dyn Fn(usize, f64) -> f64,
}

impl Mixture<'_> {
    /// x = x_1 + sum_i w_i (x_i - x_1), P = sum_i w_i (P_i + (x_i - x)(x_i - x)'). Weights need not add up to one.
    pub(super) fn moments(&self, weights: &[f64]) -> Estimate {
        let first = &self.estimates[0];
        let n = first.x.len();
        let apart: Vec<DVector<f64>> = self.estimates.iter().map(|own| self.apart(&own.x, &first.x)).collect();
        let moved = apart.iter().zip(weights).fold(DVector::zeros(n), |sum, (d, w)| sum + d * *w);
        let mut p = DMatrix::zeros(n, n);
        for ((own, d), weight) in self.estimates.iter().zip(&apart).zip(weights) {
            let d = d - &moved;
            p += (&own.p + &d * d.transpose()) * *weight;
        }
        symmetrise(&mut p);
        Estimate { x: &first.x + moved, p }
    }

    fn apart(&self, x: &DVector<f64>, first: &DVector<f64>) -> DVector<f64> {
        let mut d = x - first;
        d.iter_mut().enumerate().for_each(|(i, d)| *d = (self.between)(i, *d));
        d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 0 +- 1 and 4 +- 2 (standard deviations), 3 to 1: mean 1, variance 3/4 (1 + 1) + 1/4 (4 + 9).
    #[test]
    fn two_gaussians_by_hand() {
        let of = |x: f64, p: f64| Estimate { x: DVector::from_element(1, x), p: DMatrix::from_element(1, 1, p) };
        let estimates = [of(0.0, 1.0), of(4.0, 4.0)];
        let found = Mixture { estimates: &estimates, between: &|_, d| d }.moments(&[0.75, 0.25]);
        assert!((found.x[0] - 1.0).abs() < 1e-15 && (found.p[(0, 0)] - 4.75).abs() < 1e-15, "{found:?}");
        let turned = [of(3.0, 1.0), of(-3.0, 1.0)];
        let found = Mixture { estimates: &turned, between: &|_, d: f64| d.sin().atan2(d.cos()) }.moments(&[0.5, 0.5]);
        assert!((found.x[0] - std::f64::consts::PI).abs() < 1e-12, "half way over the cut: {found:?}");
    }
}
