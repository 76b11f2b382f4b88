//! The NIS of measured rows, and what they add up to.

/// Measured rows of each trajectory after which P0 and x0 are taken to be forgotten.
pub(super) const SETTLING: usize = 20;

/// The NIS of one measured row.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowNis {
    pub(super) trajectory: usize,
    pub(super) row: usize,
    pub(super) nis: f64,
    /// Number of present components.
    pub(super) components: u32,
    /// Number of the measured row in its trajectory, from 1.
    pub(super) number: usize,
}

impl RowNis {
    /// Whether it is one of the first [`SETTLING`] measured rows of its trajectory.
    pub(super) const fn is_first(&self) -> bool {
        self.number <= SETTLING
    }

    /// Whether it is one of as many rows after those.
    pub(super) const fn is_next(&self) -> bool {
        SETTLING < self.number && self.number <= 2 * SETTLING
    }
}

/// A sum with the number of degrees of freedom that it has.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sum {
    pub(super) total: f64,
    pub(super) count: usize,
}

impl Sum {
    /// Of the NIS of these rows.
    pub(super) fn of<'a>(rows: impl IntoIterator<Item = &'a RowNis>) -> Self {
        let add =
            |sum: Self, row: &RowNis| Self { total: sum.total + row.nis, count: sum.count + row.components as usize };
        rows.into_iter().fold(Self::default(), add)
    }

    /// A mean per degree of freedom; NaN without any.
    pub(super) fn mean(self) -> f64 {
        self.total / number(self.count)
    }
}

#[expect(clippy::cast_precision_loss, reason = "no log has 2^53 rows")]
pub(super) fn number(length: usize) -> f64 {
    length as f64
}
