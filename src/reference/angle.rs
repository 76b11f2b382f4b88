//! Angles, which are equal modulo 2 pi.

use std::f64::consts::PI;

/// The angle in [-pi, pi); what is there already keeps its bits.
#[must_use]
pub(crate) fn wrapped(angle: f64) -> f64 {
    if (-PI..PI).contains(&angle) {
        return angle;
    }
    let turned = angle.sin().atan2(angle.cos());
    if turned >= PI { -PI } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_is_in_the_half_open_interval() {
        for (angle, expected) in [(-PI, -PI), (PI, -PI), (3.0, 3.0), (4.0, 4.0 - 2.0 * PI), (-4.0, 2.0 * PI - 4.0)] {
            assert!((wrapped(angle) - expected).abs() < 1e-15, "{angle}: {}", wrapped(angle));
        }
        assert!(wrapped(f64::NAN).is_nan() && wrapped(f64::INFINITY).is_nan(), "no number stays none");
    }
}
