//! An exact second way to J. P_1, Q and H are identities, so in the eigenvectors of R the planar filter is two scalar
//! Kalman filters whose R are the eigenvalues, and Euclidean errors do not see the rotation. It shares nothing with the
//! tape nor with the reference filter.

use crate::data::Trajectory;

/// Noise of a track, n_i sigma: all that J depends on, because the filter's model of the tanker is exact.
#[derive(Debug, Clone)]
pub(super) struct Noise(Vec<[f64; 2]>);

/// R by its eigenvalues and the direction of the first \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spectrum {
    /// Larger first.
    pub(super) eigenvalues: [f64; 2],
    pub(super) direction: f64,
}

impl Spectrum {
    /// Of R = M M', M = [m0 m1; m2 m3]. The smaller eigenvalue is det(M)^2 over the larger one, without cancellation.
    #[must_use]
    pub(super) fn of_factor(m: &[f64]) -> Self {
        let (a, b, c) = (m[0] * m[0] + m[1] * m[1], m[0] * m[2] + m[1] * m[3], m[2] * m[2] + m[3] * m[3]);
        let largest = 0.5 * (a + c) + (0.5 * (a - c)).hypot(b);
        let determinant = m[0] * m[3] - m[1] * m[2];
        let least = if largest > 0.0 { determinant * determinant / largest } else { 0.0 };
        Self { eigenvalues: [largest, least], direction: 0.5 * (2.0 * b).atan2(a - c) }
    }
}

impl Noise {
    /// Measurements minus truth.
    #[must_use]
    pub(super) fn of(track: &Trajectory) -> Self {
        let error = |k: usize| [0, 1].map(|d| track.z.row(k)[d] - track.truth.row(k)[d]);
        Self((0..track.len()).map(error).collect())
    }

    /// J = sum over rows of |estimate - truth|; the first row, which is the start, counts.
    #[must_use]
    pub(super) fn score(&self, r: &Spectrum) -> f64 {
        let (sin, cos) = r.direction.sin_cos();
        let rotated = self.0.iter().map(|n| [cos * n[0] + sin * n[1], cos * n[1] - sin * n[0]]);
        let (mut error, mut p, mut total) = ([0.0; 2], [1.0; 2], 0.0);
        for (i, n) in rotated.enumerate() {
            if i == 0 {
                error = n;
            } else {
                for d in 0..2 {
                    let predicted = p[d] + 1.0;
                    let gain = predicted / (predicted + r.eigenvalues[d]);
                    error[d] += gain * (n[d] - error[d]);
                    p[d] = (1.0 - gain) * predicted;
                }
            }
            total += error[0].hypot(error[1]);
        }
        total
    }
}

/// E J at R = I over a track of `rows`: sigma sqrt(pi/2) sum of sqrt(v_i), v_1 = 1,
/// v_i = (1 - K_i)^2 v_(i-1) + K_i^2, the error of a row being Rayleigh with variance v_i sigma^2 per axis.
#[must_use]
pub(super) fn expected_untuned(rows: usize) -> f64 {
    let (mut v, mut p, mut sum) = (1.0_f64, 1.0_f64, 0.0);
    for i in 0..rows {
        if i > 0 {
            let gain = (p + 1.0) / (p + 2.0);
            v = (1.0 - gain).powi(2) * v + gain * gain;
            p = (1.0 - gain) * (p + 1.0);
        }
        sum += v.sqrt();
    }
    super::scenario::sigma(rows) * std::f64::consts::FRAC_PI_2.sqrt() * sum
}

#[cfg(test)]
mod tests {
    use super::super::scenario;
    use super::*;
    use crate::reference;

    #[test]
    fn the_closed_form_has_the_stated_values() {
        for (rows, expected) in [(20, 72.69), (50, 71.34), (100, 70.89)] {
            assert!((expected_untuned(rows) - expected).abs() < 0.005, "{rows}: {}", expected_untuned(rows));
        }
    }

    #[test]
    fn two_scalar_filters_are_the_planar_filter() {
        let problem = scenario::problem(scenario::Bounds::Free).unwrap();
        let log = scenario::log(5, 0);
        let noise = Noise::of(&log.trajectories[0]);
        for m in [[1.0, 0.0, 0.0, 1.0], [3.0, 1.0, -2.0, 0.5], [0.0, 2.0, 0.0, 0.0], [0.0; 4], [30.0, 31.0, 29.0, 30.0]]
        {
            let planar = reference::costs(&problem, &log, &m).unwrap()[0];
            let scalar = noise.score(&Spectrum::of_factor(&m));
            assert!((scalar / planar - 1.0).abs() < 1e-11, "{m:?}: {scalar} against {planar}");
        }
    }
}
