//! Chi-square bands.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// A mean of chi-square variables per degree of freedom, beside the band that holds 95 % of them.
///
/// The sum of `degrees` degrees of freedom is chi-square; all three numbers are divided by `degrees`. NaN without data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::report) struct Band {
    pub(in crate::report) mean: f64,
    pub(in crate::report) low: f64,
    pub(in crate::report) high: f64,
}

impl Band {
    /// Of a sum with `degrees` degrees of freedom.
    pub(in crate::report) fn of(sum: f64, degrees: f64) -> Self {
        Self::outside(sum, degrees, 0.05)
    }

    /// The band that all but a share of `level` of right filters are in.
    pub(super) fn outside(sum: f64, degrees: f64, level: f64) -> Self {
        let quantile = |p| ChiSquared::new(degrees).map_or(f64::NAN, |chi2| chi2.inverse_cdf(p) / degrees);
        Self { mean: sum / degrees, low: quantile(level / 2.0), high: quantile(1.0 - level / 2.0) }
    }
}

/// Probability of a sum with `degrees` degrees of freedom as far out as this one on either side; NaN without data.
pub(super) fn two_sided(sum: f64, degrees: f64) -> f64 {
    ChiSquared::new(degrees).map_or(f64::NAN, |chi2| (2.0 * chi2.cdf(sum).min(chi2.sf(sum))).min(1.0))
}

/// Probability that chi-square with `degrees` degrees of freedom exceeds `value`.
pub(super) fn exceedance(value: f64, degrees: f64) -> f64 {
    ChiSquared::new(degrees).map_or(f64::NAN, |chi2| chi2.sf(value))
}

/// Probability that F with `first` and `second` degrees of freedom exceeds `value`; NaN of what is no number.
pub(super) fn f_exceedance(value: f64, [first, second]: [f64; 2]) -> f64 {
    /// Beyond it nothing is left, and products of it would overflow.
    const LARGEST: f64 = 1e100;
    if value.is_nan() {
        return f64::NAN;
    }
    FisherSnedecor::new(first, second).map_or(f64::NAN, |f| f.sf(value.clamp(0.0, LARGEST)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy 1.16: `scipy.stats.chi2.ppf([0.025, 0.975], n) / n`; for n = 1e6 the normal limit 1 -+ 1.96 sqrt(2 / n).
    #[test]
    fn quantiles() {
        for (degrees, low, high, tolerance) in [
            (10.0, 0.324_697_3, 2.048_317_7, 1e-6),
            (100.0, 0.742_219_3, 1.295_612_0, 1e-6),
            (1e6, 0.997_229, 1.002_773, 5e-6),
        ] {
            let band = Band::of(degrees, degrees);
            assert!((band.low - low).abs() < tolerance, "{degrees}: low {}", band.low);
            assert!((band.high - high).abs() < tolerance, "{degrees}: high {}", band.high);
        }
        assert!((exceedance(31.410_433, 20.0) - 0.05).abs() < 1e-8, "the 95 % quantile of 20 degrees");
        assert!(Band::of(0.0, 0.0).low.is_nan(), "no data, no band");
        assert!((two_sided(129.561_200, 100.0) - 0.05).abs() < 1e-6, "the upper end of the band of 100 degrees");
        assert!((two_sided(74.221_930, 100.0) - 0.05).abs() < 1e-6, "the lower one");
        // F with 1 and 1 is the square of a Cauchy variable.
        assert!((f_exceedance(4.0, [1.0, 1.0]) - (1.0 - 2.0 / std::f64::consts::PI * 2.0_f64.atan())).abs() < 1e-12);
        assert!(f_exceedance(f64::NAN, [2.0, 9.0]).is_nan() && f_exceedance(f64::INFINITY, [2.0, 9.0]) < 1e-100);
        assert!((f_exceedance(-1.0, [2.0, 9.0]) - 1.0).abs() < 1e-15, "all of it is above 0");
        assert!(two_sided(0.0, 0.0).is_nan() && two_sided(f64::INFINITY, 3.0) < 1e-300, "nothing, and all too much");
    }
}
