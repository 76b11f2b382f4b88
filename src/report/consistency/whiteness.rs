//! Whiteness of the innovations.

use std::fmt;

use nalgebra::Cholesky;
use serde::Serialize;

use super::portmanteau::Portmanteau;
use super::rows::number;
use super::{Test, TestKind};
use crate::number::significant;
use crate::reference::Update;

/// Most lags tested.
const LAGS: usize = 20;
/// Fewest pairs that a lag is estimated from.
const PAIRS: usize = 5;
/// Autocorrelation below which a significant one changes no decision: it costs about its square, 1 %, in variance.
const PRACTICAL: f64 = 0.1;

/// Autocorrelation of one measurement's normalised innovations.
///
/// A row's innovations nu are normalised **jointly**: L^-1 nu with S = L L' (Cholesky, over the present components, in
/// the order of the measurements), which has unit covariance when the filter is right. Lags count the present values
/// of this measurement; pairs never cross trajectories. The mean is not subtracted, so a bias shows as correlation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Whiteness {
    /// Name of the measurement.
    pub measurement: String,
    /// Number N of its present values.
    pub count: usize,
    /// Autocorrelation at lag 1, 2, ... min(20, N / 5); shorter where trajectories are too short for it.
    pub autocorrelation: Vec<f64>,
    /// 95 % of autocorrelations of white innovations lie within plus or minus this, 1.96 / sqrt(N).
    pub band: f64,
    /// Ljung-Box statistic over those lags (doi:10.1093/biomet/65.2.297).
    pub ljung_box: f64,
    /// Probability of a larger one if the innovations are white; NaN when there is no lag to test. It is of the statistic's
    /// exact mean and variance, by an F distribution that has both: chi-square itself has too short a tail on short logs.
    pub p_value: f64,
    /// Whether they count as correlated: p below 0.01 / m, **and** an autocorrelation of at least 0.1 in magnitude.
    pub correlated: bool,
}

impl Whiteness {
    /// One entry per measurement that has any value; `series` is by measurement and trajectory.
    pub(super) fn of(measurements: &[String], series: &[Vec<&[f64]>]) -> Vec<Self> {
        let named = measurements.iter().zip(series);
        named.filter_map(|(name, series)| Self::of_series(name, series, measurements.len())).collect()
    }

    /// One test per measurement that has a lag; the log has `measurements` of them, which share the level.
    pub(super) fn tests(all: &[Self], measurements: usize) -> impl Iterator<Item = Test> {
        all.iter().filter(|w| w.is_tested()).map(move |w| {
            let name = format!("largest autocorrelation of {}", w.measurement);
            let measured = (name.as_str(), w.largest());
            let matters = (w.largest() >= PRACTICAL, "below 0.1");
            Test::among(number(measurements), TestKind::Whiteness, measured, w.p_value, matters)
        })
    }

    fn of_series(name: &str, series: &[&[f64]], tests: usize) -> Option<Self> {
        let n: usize = series.iter().map(|s| s.len()).sum();
        let power: f64 = series.iter().copied().flatten().map(|v| v * v).sum();
        if n == 0 {
            return None;
        }
        let (count, mut autocorrelation, mut ljung_box) = (number(n), Vec::new(), 0.0);
        for lag in 1..=LAGS.min(n / 5) {
            let pairs = || series.iter().flat_map(|s| s.iter().zip(s.iter().skip(lag)));
            let number_of_pairs = pairs().count();
            if number_of_pairs < PAIRS {
                break;
            }
            // For one trajectory N_l = N - l, and the sum is N (N + 2) sum r_l^2 / (N - l) of the biased r_l.
            let available = number(number_of_pairs);
            let r = pairs().map(|(a, b)| a * b).sum::<f64>() / available / (power / count);
            ljung_box += available * (count + 2.0) / count * r * r;
            autocorrelation.push(r);
        }
        let p_value = Portmanteau::of(series, autocorrelation.len()).exceedance(ljung_box);
        let band = 1.96 / count.sqrt();
        let white =
            Self { measurement: name.into(), count: n, autocorrelation, band, ljung_box, p_value, correlated: false };
        let correlated = p_value < TestKind::Whiteness.level() / number(tests) && white.largest() >= PRACTICAL;
        Some(Self { correlated, ..white })
    }

    /// The largest autocorrelation in magnitude; 0 when there are too few values.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.autocorrelation.iter().fold(0.0, |max, r| max.max(r.abs()))
    }

    /// Whether there were values enough for at least one lag.
    #[must_use]
    pub const fn is_tested(&self) -> bool {
        !self.autocorrelation.is_empty()
    }

    /// Autocorrelation at lag 1; NaN when there are too few values.
    #[must_use]
    pub fn lag_1(&self) -> f64 {
        self.autocorrelation.first().copied().unwrap_or(f64::NAN)
    }
}

/// L^-1 nu with S = L L'; empty when S has no factor, which a finished run rules out.
pub(in crate::report) fn normalised(update: &Update) -> Vec<f64> {
    if let ([nu], [s]) = (update.nu.as_slice(), update.s.as_slice()) {
        return vec![nu / s.sqrt()];
    }
    let factor = Cholesky::new(update.s.clone());
    let white = factor.and_then(|c| c.l_dirty().solve_lower_triangular(&update.nu));
    white.map_or_else(Vec::new, |v| v.as_slice().to_vec())
}

impl fmt::Display for Whiteness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { measurement, band, p_value, autocorrelation, .. } = self;
        if !self.is_tested() {
            return write!(f, "{measurement}: too few innovations to tell");
        }
        let (lag, lags) = (self.lag_1(), autocorrelation.len());
        write!(f, "{measurement}: lag 1 {lag:+.3} (band {band:.3}), Ljung-Box over {lags} lags p ")?;
        // Below the smallest number of double precision it comes out as 0, which no probability of a test is.
        if *p_value > 0.0 { write!(f, "= {}", significant(*p_value, 3)) } else { f.write_str("< 1e-300") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};
    use rand_distr::{Distribution, StandardNormal};

    fn noise(index: u64, n: usize) -> Vec<f64> {
        let mut stream = Stream::new(5, Purpose::Workload, 0, index);
        (0..n).map(|_| StandardNormal.sample(&mut stream)).collect()
    }

    /// v_k = a v_{k-1} + w_k.
    fn autoregressive(a: f64, n: usize) -> Vec<f64> {
        noise(1, n)
            .into_iter()
            .scan(0.0, |v, w| {
                *v = a * *v + w;
                Some(*v)
            })
            .collect()
    }

    fn whiteness(series: &[Vec<f64>]) -> Whiteness {
        let series: Vec<&[f64]> = series.iter().map(Vec::as_slice).collect();
        Whiteness::of_series("z", &series, 1).expect("there are values")
    }

    /// By hand: 1, 2, 2, -1, 1, ... repeated, lag 1, against the textbook formula N (N + 2) r^2 / (N - 1).
    #[test]
    fn ljung_box_of_a_short_series() {
        let found = whiteness(&[vec![1.0, 2.0, 2.0, -1.0, 1.0, 0.0]]);
        let biased: f64 = (2.0 + 4.0 - 2.0 - 1.0 + 0.0) / 11.0;
        assert_eq!(found.autocorrelation.len(), 1, "6 / 5 = 1 lag");
        assert!((found.lag_1() - biased * 6.0 / 5.0).abs() < 1e-15, "lag 1 is {}", found.lag_1());
        assert!((found.ljung_box - 6.0 * 8.0 * biased.powi(2) / 5.0).abs() < 1e-14, "Q is {}", found.ljung_box);
    }

    #[test]
    fn white_noise_passes_about_as_often_as_it_should() {
        let failures = (0..400).filter(|i| whiteness(&[noise(*i, 200)]).p_value < 0.05).count();
        assert!((5..=40).contains(&failures), "{failures} of 400 white logs rejected at 5 %");
    }

    #[test]
    fn correlation_is_found_but_not_across_trajectories() {
        let found = whiteness(&[autoregressive(0.74, 300)]);
        assert!(found.correlated && (found.lag_1() - 0.74).abs() < 0.15, "lag 1 is {}", found.lag_1());
        // 150 trajectories of two equal and opposite values, every pair within one: strong at lag 1, which is all there is.
        let pairs: Vec<_> = noise(2, 150).into_iter().map(|v| vec![v, -v]).collect();
        let found = whiteness(&pairs);
        assert_eq!(found.autocorrelation.len(), 1, "no trajectory has a pair at lag 2");
        assert!((found.lag_1() + 1.0).abs() < 1e-12, "lag 1 is {}", found.lag_1());
    }

    #[test]
    fn a_tiny_correlation_of_very_many_rows_does_not_count() {
        let found = whiteness(&[autoregressive(0.04, 100_000)]);
        assert!(found.p_value < 1e-6, "it is significant, p = {}", found.p_value);
        assert!(!found.correlated, "but too small to matter: {:?}", found.autocorrelation);
    }
}
