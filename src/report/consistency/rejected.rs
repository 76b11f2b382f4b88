//! Rows that robust updates left out, wholly or in part.

use std::fmt;

use serde::Serialize;

use crate::report::short;

/// What robust updates left out of the measured rows.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Rejected {
    /// Mean of one less the weight of a row, 0 to 1; NaN (JSON `null`) without rows.
    pub share: f64,
    /// Rows with a weight below one half, which no test is about.
    pub rows: usize,
    /// Measured rows.
    pub of: usize,
}

impl Rejected {
    /// One more row; whether it counted less than half.
    pub(super) fn add(&mut self, rejected: f64) -> bool {
        let is_out = rejected > 0.5;
        self.of += 1;
        self.rows += usize::from(is_out);
        self.share += (rejected - self.share) / self.of as f64;
        is_out
    }
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { share, rows, of } = self;
        let share = short(100.0 * share, 3);
        write!(f, "{share} % of the measured rows; {rows} of {of} counted less than half, and are not in these tests")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_the_mean() {
        let mut rejected = Rejected::default();
        let out = [0.0, 1.0, 0.25, 0.75].map(|row| rejected.add(row));
        assert_eq!(out, [false, true, false, true]);
        assert_eq!(rejected, Rejected { share: 0.5, rows: 2, of: 4 });
        assert_eq!(
            rejected.to_string(),
            "50 % of the measured rows; 2 of 4 counted less than half, and are not in these tests"
        );
    }
}
