//! Functions of one objective with a known minimum.

/// Functions with one known minimum of value 0, at [`Landscape::optimum`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Landscape {
    /// sum z_d^2, where z is the offset from the optimum.
    Sphere,
    /// sum 10^(6 d/(n-1)) z_d^2: condition number 1e6.
    Ellipsoid,
    /// sum 100 (y_(d+1) - y_d^2)^2 + (1 - y_d)^2 with y = z + 1: a curved valley, from two coordinates on.
    Rosenbrock,
    /// 10 n + sum z_d^2 - 10 cos(2 pi z_d): about 10^n local minima.
    Rastrigin,
}

/// Half the width of the box that [`super::Mock::bounds`] gives.
pub(super) const HALF_WIDTH: f64 = 5.0;

impl Landscape {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Sphere, Self::Ellipsoid, Self::Rosenbrock, Self::Rastrigin];

    /// Where the minimum of coordinate `d` lies: off the origin, and off the centre of the box (which is the origin), at
    /// 1.3, -1.67, 2.04, 1.3, ... with alternating signs.
    #[must_use]
    pub fn optimum(d: usize) -> f64 {
        let sign = if d.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * (1.3 + 0.37 * (d % 3) as f64)
    }

    /// The value at `x`.
    #[must_use]
    pub fn value(self, x: &[f64]) -> f64 {
        let n = x.len();
        let z: Vec<f64> = x.iter().enumerate().map(|(d, x)| x - Self::optimum(d)).collect();
        match self {
            Self::Sphere => z.iter().map(|z| z * z).sum(),
            Self::Ellipsoid => {
                let exponent = |d: usize| 6.0 * d as f64 / n.saturating_sub(1).max(1) as f64;
                z.iter().enumerate().map(|(d, z)| 10.0_f64.powf(exponent(d)) * z * z).sum()
            }
            Self::Rosenbrock => {
                let valley = |z: &[f64]| {
                    let (a, b) = (z[0] + 1.0, z[1] + 1.0);
                    100.0 * (b - a * a).powi(2) + (1.0 - a).powi(2)
                };
                z.windows(2).map(valley).sum()
            }
            Self::Rastrigin => z.iter().map(|z| 10.0 + z * z - 10.0 * (std::f64::consts::TAU * z).cos()).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minima_are_zero_and_elsewhere_is_higher() {
        for (landscape, n) in Landscape::ALL.into_iter().flat_map(|l| [2, 5].map(|n| (l, n))) {
            let optimum: Vec<f64> = (0..n).map(Landscape::optimum).collect();
            assert!(landscape.value(&optimum).abs() < 1e-12, "{landscape:?} at its optimum");
            for d in 0..n {
                let mut near = optimum.clone();
                near[d] += 1e-3;
                assert!(landscape.value(&near) > 9e-7, "{landscape:?} beside its optimum");
            }
        }
    }

    /// Values worked out by hand at z = (1, 2).
    #[test]
    fn values_off_the_optimum() {
        let x = [Landscape::optimum(0) + 1.0, Landscape::optimum(1) + 2.0];
        let expected = [5.0, 1.0 + 4e6, 100.0 + 1.0, 5.0];
        for (landscape, expected) in Landscape::ALL.into_iter().zip(expected) {
            assert!((landscape.value(&x) - expected).abs() < 1e-8 * expected, "{landscape:?}: {}", landscape.value(&x));
        }
    }
}
