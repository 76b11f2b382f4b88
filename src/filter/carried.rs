//! What is carried from row to row.

/// What becomes of a carried register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// An entry of x, of the covariance or of what is adapted: starts from the prologue, stays.
    State,
    /// A running sum: starts at 0, is moved to an f64 total every [`Program::BLOCK`](super::Program::BLOCK) rows.
    Sum,
    /// A running product: starts at 1, its exponent is taken out every few rows; the total is its logarithm. It stays 0
    /// once a factor was not positive.
    Product,
    /// 1 as long as the innovation variances that no product watches over were positive, -1 after one was not.
    Check,
}

impl Role {
    /// What a register of this role holds before the first row; a state comes from the prologue.
    #[must_use]
    pub const fn start(self) -> f64 {
        match self {
            Self::State | Self::Sum => 0.0,
            Self::Product | Self::Check => 1.0,
        }
    }
}

/// A register carried from row to row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Carried {
    /// `x.d`, `P.d.v` (or `U.d.v`, `D.d`), `sum0`, ...
    pub name: String,
    /// What becomes of it.
    pub role: Role,
}

/// The number of a leaf.
#[expect(clippy::cast_possible_truncation, reason = "dimensions are bounded far below 2^32")]
pub(super) const fn narrow(i: usize) -> u32 {
    i as u32
}
