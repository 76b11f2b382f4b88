//! `nis_distribution`: whether the NIS has its chi-square distribution.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::estimate::{Update, count};

/// Neyman's smooth test of four components, row by row.
#[derive(Debug, Default)]
pub(super) struct Uniformity {
    sums: [f64; 4],
    rows: usize,
}

impl Uniformity {
    pub(super) fn add(&mut self, update: &Update) {
        self.sums.iter_mut().zip(smooth_components(update)).for_each(|(sum, phi)| *sum += phi);
        self.rows += 1;
    }

    /// The sum of the squared means; NaN over no rows.
    pub(super) fn cost(&self) -> f64 {
        self.sums.iter().map(|sum| (sum / count(self.rows)).powi(2)).sum()
    }
}

/// The normalised shifted Legendre polynomials, degree 1 to 4, of the distribution function at the NIS of a row; NaN where that is
/// no number.
pub(crate) fn smooth_components(update: &Update) -> [f64; 4] {
    let chi_square = ChiSquared::new(count(update.present.len())).ok().filter(|_| update.nis.is_finite());
    let u = chi_square.map_or(f64::NAN, |chi_square| chi_square.cdf(update.nis));
    [
        3f64.sqrt() * (2.0 * u - 1.0),
        5f64.sqrt() * (6.0 * u.powi(2) - 6.0 * u + 1.0),
        7f64.sqrt() * (20.0 * u.powi(3) - 30.0 * u.powi(2) + 12.0 * u - 1.0),
        3.0 * (70.0 * u.powi(4) - 140.0 * u.powi(3) + 90.0 * u.powi(2) - 20.0 * u + 1.0),
    ]
}
