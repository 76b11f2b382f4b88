//! The distribution of the Ljung-Box statistic of white noise on logs of any length.

use super::band::{exceedance, f_exceedance};
use super::rows::number;

/// Q = n (n + 2) sum over the lags k of c_k^2 / (N_k S^2), where c_k sums the N_k products of values k apart and S sums the
/// squares of all n values: of white normal noise, by its mean and variance.
///
/// The autocorrelations c_k / S do not depend on S, so the moments of Q are those of products of the quadratic forms c_k
/// over those of S, and exact. The mean is the number of lags; the variance is above twice that, the more the larger the
/// lags are beside n, which is why chi-square rejects too often (Davies, Triggs and Newbold 1977, doi:10.1093/biomet/64.3.517).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Portmanteau {
    lags: usize,
    variance: f64,
}

impl Portmanteau {
    /// Over the lags 1 to `lags` of series whose pairs are never across; each lag has a pair.
    pub(super) fn of(series: &[&[f64]], lags: usize) -> Self {
        let lengths: Vec<usize> = series.iter().map(|series| series.len()).collect();
        let n = number(lengths.iter().sum());
        let sum = |of: &dyn Fn(usize) -> usize| number(lengths.iter().map(|length| of(*length)).sum());
        let pairs: Vec<f64> = (1..=lags).map(|k| sum(&|length| length.saturating_sub(k))).collect();
        let mut second = 0.0;
        for j in 1..=lags {
            for k in 1..=j {
                // E c_j^2 c_k^2 = tr A tr B + 2 (tr AB)^2 ... over the pairings of four quadratic forms without a diagonal:
                // those within equal forms, and the closed walks of steps j, j, k, k that stay in a series.
                let both = sum(&|length| length.saturating_sub(j + k));
                let moment = if j == k {
                    3.0 * pairs[j - 1] * pairs[j - 1] + 6.0 * pairs[j - 1] + 12.0 * both
                } else {
                    pairs[j - 1] * pairs[k - 1] + 4.0 * pairs[j - 1] + 8.0 * both
                };
                second += if j == k { 1.0 } else { 2.0 } * moment / (pairs[j - 1] * pairs[k - 1]);
            }
        }
        let scale = n * (n + 2.0) / ((n + 4.0) * (n + 6.0));
        Self { lags, variance: scale * second - number(lags * lags) }
    }

    /// Probability of a larger Q: by the scaled F distribution of the same mean and variance, whose first degrees of freedom
    /// are the lags; chi-square where the variance is no larger than its own, NaN without a lag.
    pub(super) fn exceedance(self, q: f64) -> f64 {
        let lags = number(self.lags);
        let excess = self.variance / lags - 2.0;
        if excess <= 1e-6 {
            return exceedance(q, lags);
        }
        // Var F / (E F)^2 = 2 (lags + d - 2) / (lags (d - 4)).
        let d = 4.0 + 2.0 * (lags + 2.0) / excess;
        f_exceedance(q / lags * d / (d - 2.0), [lags, d])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};
    use crate::report::consistency::Whiteness;
    use rand_distr::{Distribution, StandardNormal};

    /// Two values a, b: Q = 8 (a b)^2 / (a^2 + b^2)^2 = 2 sin^2 of an angle that is even on the circle: variance 1/2.
    #[test]
    fn two_values_by_hand() {
        let two = Portmanteau::of(&[&[0.0, 0.0]], 1);
        assert!((two.variance - 0.5).abs() < 1e-12, "{two:?}");
    }

    /// Q of white noise in these series, drawn many times.
    fn drawn(lengths: &[usize], times: u64) -> (Portmanteau, Vec<f64>, Vec<f64>) {
        let names = ["z".to_owned()];
        let one = |index| {
            let mut stream = Stream::new(6, Purpose::Workload, lengths.len() as u64, index);
            let mut noise = |n: &usize| (0..*n).map(|_| StandardNormal.sample(&mut stream)).collect::<Vec<f64>>();
            let series: Vec<Vec<f64>> = lengths.iter().map(&mut noise).collect();
            let series: Vec<&[f64]> = series.iter().map(Vec::as_slice).collect();
            let white = Whiteness::of(&names, std::slice::from_ref(&series)).remove(0);
            (Portmanteau::of(&series, white.autocorrelation.len()), white.ljung_box, white.p_value)
        };
        let all: Vec<_> = (0..times).map(one).collect();
        (all[0].0, all.iter().map(|a| a.1).collect(), all.iter().map(|a| a.2).collect())
    }

    /// Variance and tail of drawn ones; with chi-square 2.2 % would be below 1 % on 60 rows.
    #[test]
    fn moments_and_tail_are_those_of_drawn_noise() {
        for lengths in [&[60][..], &[25], &[12; 5]] {
            let times = 20_000;
            let (expected, q, p) = drawn(lengths, times);
            let mean = q.iter().sum::<f64>() / q.len() as f64;
            let variance = q.iter().map(|q| (q - mean).powi(2)).sum::<f64>() / q.len() as f64;
            assert!((mean / expected.lags as f64 - 1.0).abs() < 0.02, "{lengths:?}: mean {mean} of {expected:?}");
            assert!(
                (variance / expected.variance - 1.0).abs() < 0.08,
                "{lengths:?}: variance {variance} of {expected:?}"
            );
            let below = 100.0 * p.iter().filter(|p| **p < 0.01).count() as f64 / q.len() as f64;
            println!("{lengths:?}: {below:.2} % below 1 %");
            assert!((0.7..1.45).contains(&below), "{lengths:?}: {below} % of p-values are below 1 %");
        }
    }
}
