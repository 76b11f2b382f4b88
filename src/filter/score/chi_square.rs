//! The chi-square distribution on the graph, and the polynomials that tell a uniform number from others.

use crate::tape::{Binary, Function, Graph, Id, Unary};
use std::f64::consts::FRAC_2_SQRT_PI;

/// Half of what x is cut down to: the distribution function is 1 there, and infinity is not multiplied by an exp(-y) of 0.
const MOST: f64 = 1e4;

/// F(x) of chi-square with m degrees of freedom, m >= 1, in closed form (Abramowitz and Stegun 26.4.4 and 26.4.5). With y = x / 2:
///
/// - m even: 1 - exp(-y) (1 + y + y^2/2! + ... to y^(m/2 - 1)),
/// - m odd: erf(sqrt y) - exp(-y) sqrt(y) 2/sqrt(pi) (1 + y / 1.5 + y^2 / (1.5 x 2.5) + ... to y^((m - 3)/2)).
///
/// Single precision holds neither exp(-y) nor the sum where m is large. So the sum is of multiples of q = exp(-y/2), and the other
/// half comes behind it: both fit up to some 200 degrees of freedom.
pub(super) fn probability(g: &mut Graph, x: Id, m: usize) -> Id {
    let [zero, half, one, most] = [0.0, 0.5, 1.0, MOST].map(|value| g.constant(value));
    let y = g.mul(half, x);
    let y = g.binary(Binary::Max, y, zero);
    let y = g.binary(Binary::Min, y, most);
    let (odd, terms) = (m % 2 == 1, u32::try_from(m / 2).unwrap_or(u32::MAX));
    let exponent = g.mul(half, y);
    let exponent = g.neg(exponent);
    let q = g.unary(Unary::Exp, exponent);
    let ratio = |j: u32| 1.0 / (f64::from(j) + if odd { 0.5 } else { 0.0 });
    let sum = (1..terms).rev().fold(q, |sum, j| {
        let ratio = g.constant(ratio(j));
        let step = g.mul(y, ratio);
        let product = g.mul(sum, step);
        g.add(product, q)
    });
    let tail = g.mul(sum, q);
    if !odd {
        return g.sub(one, tail);
    }
    let root = g.unary(Unary::Sqrt, y);
    let erf = g.call(Function::Erf, &[root]);
    if terms == 0 {
        return erf;
    }
    let scale = g.constant(FRAC_2_SQRT_PI);
    let scale = g.mul(root, scale);
    let tail = g.mul(tail, scale);
    g.sub(erf, tail)
}

/// The normalised shifted Legendre polynomials of degree 1 to 4: of u uniform on 0 to 1 each has mean 0 and variance 1, and no two
/// are correlated.
pub(super) fn legendre(g: &mut Graph, u: Id) -> [Id; 4] {
    let [one, two] = [1.0, 2.0].map(|value| g.constant(value));
    let v = g.mul(two, u);
    let v = g.sub(v, one);
    let square = g.mul(v, v);
    // In v = 2 u - 1: v, (3 v^2 - 1) / 2, v (5 v^2 - 3) / 2 and (35 v^4 - 30 v^2 + 3) / 8, times sqrt(2 j + 1).
    let mut even = |coefficients: &[f64], scale: f64| {
        coefficients.iter().rev().fold(g.constant(0.0), |sum, c| {
            let (product, c) = (g.mul(sum, square), g.constant(scale * c));
            g.add(product, c)
        })
    };
    let [first, second] = [even(&[1.0], 3.0_f64.sqrt()), even(&[-0.5, 1.5], 5.0_f64.sqrt())];
    let [third, fourth] = [even(&[-1.5, 2.5], 7.0_f64.sqrt()), even(&[0.375, -3.75, 4.375], 3.0)];
    [g.mul(v, first), second, g.mul(v, third), fourth]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tape::{Calculator, Leaf};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    #[test]
    fn the_closed_form_is_the_distribution_function() {
        // The other one, by a continued fraction, is off by some 3e-14 at m = 31.
        for m in (1..=12).chain([31, 32, 63, 64, 127, 200]) {
            let mut g = Graph::default();
            let x = g.leaf(Leaf::Column(0));
            let f = probability(&mut g, x, m);
            let mut calculator = Calculator::new(&g, &[f]);
            let chi_square = ChiSquared::new(f64::from(u32::try_from(m).unwrap())).unwrap();
            let expected_mean = f64::from(u32::try_from(m).unwrap());
            for share in [0.0, 1e-9, 1e-3, 0.1, 0.5, 0.9, 1.0, 1.2, 2.0, 5.0, 40.0, 1e6] {
                let x = share * expected_mean;
                let found = calculator.evaluate(|_| x).next().unwrap();
                let expected = chi_square.cdf(x);
                assert!((found - expected).abs() < 1e-12, "F_{m}({x}) = {found}, expected {expected}");
            }
        }
    }

    /// By the midpoint rule, which is exact to 1e-9 for these.
    #[test]
    fn polynomials_of_a_uniform_number_are_orthonormal() {
        let mut g = Graph::default();
        let u = g.leaf(Leaf::Column(0));
        let phi = legendre(&mut g, u);
        let mut calculator = Calculator::new(&g, &phi);
        let n = 100_000;
        let (mut means, mut products) = ([0.0; 4], [[0.0; 4]; 4]);
        for k in 0..n {
            let u = (f64::from(k) + 0.5) / f64::from(n);
            let phi: Vec<f64> = calculator.evaluate(|_| u).collect();
            for (i, a) in phi.iter().enumerate() {
                means[i] += a / f64::from(n);
                phi.iter().enumerate().for_each(|(j, b)| products[i][j] += a * b / f64::from(n));
            }
        }
        for (i, (mean, row)) in means.iter().zip(&products).enumerate() {
            assert!(mean.abs() < 1e-8, "mean of {i}: {mean}");
            for (j, product) in row.iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                assert!((product - expected).abs() < 1e-8, "{i} {j}: {product}");
            }
        }
    }
}
