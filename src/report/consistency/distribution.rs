//! How NIS is distributed over the rows, beyond its mean.

use serde::Serialize;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

use super::band::exceedance;
use super::rows::{RowNis, number};
use super::{Test, TestKind};

/// Bins of the probability integral transform.
const BINS: usize = 10;
/// Fewest rows for a test of uniformity: 5 expected in a bin.
const ROWS: usize = 5 * BINS;
/// Share of rows above the 99 % quantile from which tails count as heavy, if it is significant too: twice what there
/// should be. Farther in, outliers leave hardly a trace once the tuned noise has grown with them.
const HEAVY: f64 = 0.02;
/// Share of rows above the 95 % quantile up to which tails count as light: half of what there should be.
const LIGHT: f64 = 0.025;
/// Distance of two distribution functions from which it matters: a band meant for half of the rows holds 45 or 55 %.
const PRACTICAL: f64 = 0.05;

/// The NIS of single rows against the chi-square distribution of their own number of components.
///
/// With the right filter, NIS of different rows are independent, and the probability integral transform
/// u = CDF(NIS; components of the row) is uniform on 0 to 1 (Diebold, Gunther and Tay 1998, doi:10.2307/2527342).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NisDistribution {
    /// Rows with a measurement.
    pub rows: usize,
    /// Share of rows whose NIS is above the 95 % quantile of its chi-square distribution: 0.05 when consistent.
    pub above_95: f64,
    /// Lower end of the band that holds that share, by the binomial distribution, in at least 95 % of consistent logs.
    pub above_95_low: f64,
    /// Upper end.
    pub above_95_high: f64,
    /// Share above the 99 % quantile: 0.01 when consistent.
    pub above_99: f64,
    /// Upper end of its band.
    pub above_99_high: f64,
    /// Probability of shares as far out if the filter is right, by the binomial distribution: twice the smaller of that
    /// of `above_95`, on both sides, and that of `above_99`, above.
    pub tails_p_value: f64,
    /// Rows by u, in ten bins of equal width from 0 to 1.
    pub histogram: Vec<usize>,
    /// Probability of a less even histogram if the filter is right (Pearson's chi-square test with 9 degrees of
    /// freedom); NaN below 50 rows.
    pub p_value: f64,
}

impl NisDistribution {
    /// Of measured rows with up to `measurements` components; `None` without rows.
    pub(super) fn of(rows: &[&RowNis], measurements: usize) -> Option<Self> {
        let mut counts = Counts::new(measurements);
        rows.iter().for_each(|row| counts.add(row.nis, row.components as usize));
        counts.judge()
    }

    /// Whether large NIS is clearly more frequent than it should be.
    #[must_use]
    pub fn has_heavy_tails(&self) -> bool {
        self.tails_p_value < TestKind::Tails.level() && self.above_99 >= HEAVY
    }

    /// Whether it is clearly less frequent.
    #[must_use]
    pub fn has_light_tails(&self) -> bool {
        self.tails_p_value < TestKind::Tails.level() && self.above_95 <= LIGHT
    }

    /// The largest distance of the distribution of u from the even one, at the ends of the bins.
    #[must_use]
    pub fn distance(&self) -> f64 {
        let mut below = 0;
        let distance = |(i, count): (usize, &usize)| {
            below += count;
            (number(below) / number(self.rows) - number(i + 1) / number(BINS)).abs()
        };
        self.histogram.iter().enumerate().map(distance).fold(0.0, f64::max)
    }

    /// Of the tails, and of the distribution where there are rows enough.
    pub(super) fn tests(&self) -> impl Iterator<Item = Test> {
        let matters = self.above_99 >= HEAVY || self.above_95 <= LIGHT;
        let limit = "above 0.025, with less than 0.02 above the 99 % one";
        let tails = ("share of rows above the 95 % quantile of NIS", self.above_95);
        let tails = Test::of(TestKind::Tails, tails, self.tails_p_value, (matters, limit));
        let even = ("distance of NIS from its chi-square distribution", self.distance());
        let even =
            Test::of(TestKind::NisDistribution, even, self.p_value, (self.distance() >= PRACTICAL, "below 0.05"));
        [Some(tails), self.p_value.is_finite().then_some(even)].into_iter().flatten()
    }
}

/// Counts of the rows so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Counts {
    bins: [usize; BINS],
    above_95: usize,
    above_99: usize,
    rows: usize,
    /// By number of components less one.
    chi_square: Vec<Option<ChiSquared>>,
}

impl Counts {
    /// Of rows with up to `measurements` components.
    pub(super) fn new(measurements: usize) -> Self {
        let chi_square = (1..=measurements).map(|degrees| ChiSquared::new(number(degrees)).ok()).collect();
        Self { chi_square, ..Self::default() }
    }

    pub(super) fn add(&mut self, nis: f64, components: usize) {
        let chi_square = components.checked_sub(1).and_then(|i| self.chi_square.get(i)).and_then(Option::as_ref);
        let Some(chi_square) = chi_square else { return };
        let u = chi_square.cdf(nis);
        self.rows += 1;
        self.above_95 += usize::from(u > 0.95);
        self.above_99 += usize::from(u > 0.99);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "u is from 0 to 1, and NaN goes to 0"
        )]
        let bin = (u * number(BINS)) as usize;
        self.bins[bin.min(BINS - 1)] += 1;
    }

    /// `None` without rows.
    pub(super) fn judge(&self) -> Option<NisDistribution> {
        let rows = number(self.rows);
        if self.rows == 0 {
            return None;
        }
        let [of_95, of_99] = [0.05, 0.01].map(|share| Binomial::new(share, self.rows as u64));
        let (of_95, of_99) = (of_95.ok()?, of_99.ok()?);
        let band = |binomial: &Binomial| [0.025, 0.975].map(|p| binomial.inverse_cdf(p) as f64 / rows);
        let ([above_95_low, above_95_high], [_, above_99_high]) = (band(&of_95), band(&of_99));
        let upper = at_least(&of_99, self.above_99);
        let both = 2.0 * of_95.cdf(self.above_95 as u64).min(at_least(&of_95, self.above_95));
        let expected = rows / number(BINS);
        let pearson: f64 = self.bins.iter().map(|count| (number(*count) - expected).powi(2) / expected).sum();
        Some(NisDistribution {
            rows: self.rows,
            above_95: number(self.above_95) / rows,
            above_95_low,
            above_95_high,
            above_99: number(self.above_99) / rows,
            above_99_high,
            tails_p_value: (2.0 * both.min(upper)).min(1.0),
            histogram: self.bins.to_vec(),
            p_value: if self.rows < ROWS { f64::NAN } else { exceedance(pearson, number(BINS - 1)) },
        })
    }
}

/// Probability of so many or more.
fn at_least(binomial: &Binomial, count: usize) -> f64 {
    count.checked_sub(1).map_or(1.0, |below| binomial.sf(below as u64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};
    use rand_distr::{Distribution, StandardNormal};

    /// NIS of rows with 1, 2, 3, 1, ... unit normal components, the first times `factor`.
    fn judged(index: u64, rows: usize, factor: impl Fn(usize) -> f64) -> NisDistribution {
        let mut stream = Stream::new(8, Purpose::Workload, 0, index);
        let mut counts = Counts::new(3);
        for row in 0..rows {
            let components = 1 + row % 3;
            let draws = (0..components).map(|_| StandardNormal.sample(&mut stream));
            let nis: f64 = draws.map(|v: f64| (factor(row) * v).powi(2)).sum();
            counts.add(nis, components);
        }
        counts.judge().expect("there are rows")
    }

    /// scipy 1.16: `scipy.stats.binom.ppf([0.025, 0.975], 100, 0.05)` is 1 and 10.
    #[test]
    fn shares_and_their_band() {
        let mut counts = Counts::new(2);
        // 95 % quantiles of one and of two components: 3.841 and 5.991.
        for (nis, components) in [(3.84, 1), (3.85, 1), (5.99, 2), (6.0, 2)] {
            counts.add(nis, components);
        }
        let found = counts.judge().expect("four rows");
        assert!((found.above_95 - 0.5).abs() < 1e-15, "{found:?}");
        assert_eq!(found.histogram[9], 4, "all above 0.9: {found:?}");
        assert!(found.p_value.is_nan(), "four rows are too few to test");
        (0..96).for_each(|_| counts.add(0.1, 1));
        let found = counts.judge().expect("a hundred rows");
        assert!((found.above_95_low - 0.01).abs() < 1e-12 && (found.above_95_high - 0.10).abs() < 1e-12, "{found:?}");
        // 96 rows at u = 0.248 and 4 at the top: (96 - 10)^2 / 10 + (4 - 10)^2 / 10 + 8 x 10 = 823.2.
        assert_eq!((found.histogram[2], found.histogram[9]), (96, 4), "{found:?}");
        assert!((found.p_value - exceedance(823.2, 9.0)).abs() < 1e-12, "{found:?}");
        assert_eq!(Counts::new(2).judge(), None, "no rows");
    }

    #[test]
    fn right_filters_are_rejected_as_often_as_they_should_and_heavy_tails_are_seen() {
        let all: Vec<_> = (0..400).map(|index| judged(index, 300, |_| 1.0)).collect();
        let uneven = all.iter().filter(|d| d.p_value < 0.05).count();
        let outside = all.iter().filter(|d| d.above_95 < d.above_95_low || d.above_95 > d.above_95_high).count();
        println!("{uneven} uneven and {outside} outside their band of 400 right filters");
        assert!((8..=36).contains(&uneven), "{uneven} of 400 rejected at 5 %");
        assert!((2..=28).contains(&outside), "{outside} of 400 outside a band of at least 95 %");
        // One row in ten three times as large, mean NIS brought back to 1: 0.9 + 0.1 x 9 = 1.8.
        let heavy = judged(1, 3_000, |row| if row % 10 == 0 { 3.0 } else { 1.0 } / 1.8f64.sqrt());
        assert!(heavy.has_heavy_tails() && heavy.p_value < 1e-6, "{heavy:?}");
        assert!(!judged(2, 3_000, |_| 1.0).has_heavy_tails(), "a right filter has none");
    }
}
