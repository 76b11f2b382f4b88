//! What counts as equal: how finely a cost is known, and in what unit its gains count.

use super::Kind;
use crate::precision::Precision;

impl Kind {
    /// What a difference of two values is relative to: their size, but where that may be 0 without the filter run being
    /// so: for `nll` at least one nat a row, for what is a distance of a mean from 1, that mean, for sums of squares of numbers
    /// of about 1, one.
    #[must_use]
    pub fn scale(self, value: f64, rows: usize) -> f64 {
        match self {
            Self::Nll => value.abs().max(rows as f64),
            Self::Mismatch | Self::Nis | Self::Nees | Self::NisDistribution | Self::Whiteness | Self::Rejected => {
                1.0 + value.abs()
            }
            Self::MseInnovation | Self::Prediction | Self::Rmse | Self::Distance | Self::NisMean | Self::NeesMean => {
                value.abs()
            }
        }
    }

    /// |a - b| over the larger scale of the two; 0 where that is 0.
    #[must_use]
    pub fn gap(self, a: f64, b: f64, rows: usize) -> f64 {
        let scale = self.scale(a, rows).max(self.scale(b, rows));
        if scale > 0.0 { (a - b).abs() / scale } else { 0.0 }
    }

    /// How far a value over `rows` rows may be from the exact one, in its own unit: what is promised of each precision
    /// (`tests/parity`). Values that are closer count as equal.
    #[must_use]
    pub fn resolution(self, precision: Precision, value: f64, rows: usize) -> f64 {
        match (precision, self) {
            (Precision::F64, _) => 1e-10 * value.abs().max(1.0),
            (Precision::F32, Self::Mismatch) => 1e-3,
            (Precision::F32, Self::Nis | Self::Nees | Self::NisMean | Self::NeesMean | Self::Rejected) => {
                1e-4 * (1.0 + value.abs())
            }
            (
                Precision::F32,
                Self::NisDistribution
                | Self::Whiteness
                | Self::Prediction
                | Self::Nll
                | Self::MseInnovation
                | Self::Rmse
                | Self::Distance,
            ) => 1e-5 * self.scale(value, rows),
        }
    }

    /// Whether it has derivatives in the parameters wherever it is defined. A distance from 1 has none at its best value. Of one
    /// component `nis_distribution` has a kink wherever a row's innovation passes 0, too small to stop a local search.
    #[must_use]
    pub const fn is_smooth(self) -> bool {
        !matches!(self, Self::Mismatch | Self::Nis | Self::Nees)
    }

    /// What one nat is in the unit of this cost, where it stands at `value`: 1 for `nll`. A mean square f over N rows is,
    /// but for constants, a likelihood N/2 ln f of errors of unknown size, so that a nat of it is 2 f / N; of a root mean
    /// square or a distance f it is f / N. Of `nis_distribution` and `whiteness` N/2 f is a score test's statistic, which is a
    /// likelihood ratio in nats where it is small.
    #[must_use]
    pub fn nat(self, value: f64, rows: usize) -> f64 {
        let row = value.abs().max(f64::MIN_POSITIVE) / rows.max(1) as f64;
        match self {
            Self::Nll => 1.0,
            Self::MseInnovation | Self::Prediction => 2.0 * row,
            Self::Rmse | Self::Distance => row,
            Self::NisDistribution | Self::Whiteness => 2.0 / rows.max(1) as f64,
            // A mean NIS has a variance of 2 / N; this is a standard error of it.
            Self::Mismatch | Self::Nis | Self::Nees | Self::NisMean | Self::NeesMean | Self::Rejected => {
                (2.0 / rows.max(1) as f64).sqrt()
            }
        }
    }
}
