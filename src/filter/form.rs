//! In which form the covariance is carried.

use std::fmt::{self, Display, Formatter};

/// The form of the covariance that a filter carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Form {
    /// P itself, its upper triangle: the fewest operations.
    Full,
    /// The factors of P = U D U' (Bierman 1977): what a diffuse P0 needs in single precision.
    Factored,
    /// The factors of P = L D L': the same from the other end, for filters that draw points along the columns of L.
    Lower,
}

impl Display for Form {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full => "covariance P",
            Self::Factored => "factors P = U D U'",
            Self::Lower => "factors P = L D L'",
        })
    }
}

impl Form {
    /// P0 over R above which single precision carries factors: f32 keeps 7 digits, and an update that takes P from P0 down
    /// to R loses as many as P0/R has, where nll per step is promised to 1e-5. The same holds for what an update takes P
    /// down by in the middle of a log.
    pub const DIFFUSE: f64 = 1e3;
    /// The same of double precision: 16 digits, of which costs are promised to 10.
    pub const DIFFUSE_F64: f64 = 1e6;
}

/// How a filter is carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Carrying {
    pub(super) form: Form,
    /// Whether x may be so far off before an update that taking the correction off it leaves its rounding.
    pub(super) anchored: bool,
    /// Whether every rule takes affine formulas for what they are; else as any others, which tests compare.
    pub(super) affine: bool,
}
