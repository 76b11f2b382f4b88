//! What objectives may see of a row, whatever the filter.

#![expect(non_snake_case, reason = "Kalman notation: H, R")]

use super::covariance::{Covariance, Symmetric};
use crate::tape::Id;

/// What a filter says of a row: nodes, in the filter's units, of the prior against what was measured, and of the posterior.
pub(crate) struct Evidence {
    /// Joint innovation z - E z, m; meaningless where missing.
    pub(in crate::filter) innovation: Vec<Id>,
    /// Diagonal of its joint covariance S, m.
    pub(in crate::filter) spread: Vec<Id>,
    /// The density of what was measured.
    pub(in crate::filter) likelihood: Likelihood,
    /// nu' S^-1 nu over the present components, 0 where there is none; `None` where a filter has no such number.
    pub(in crate::filter) nis: Option<Id>,
    /// One less the weight of the row, 0 where nothing is measured; `None` where every row counts in full.
    pub(in crate::filter) rejected: Option<Id>,
    /// Posterior mean, n.
    pub(in crate::filter) state: Vec<Id>,
    /// Posterior covariance.
    pub(in crate::filter) covariance: Covariance,
    /// For each state the presence of the components that see it by itself, each by itself.
    pub(in crate::filter) alone: Vec<Vec<Id>>,
    /// What a candidate fails without, besides the factors.
    pub(in crate::filter) positive: Vec<Id>,
    /// What the measurement was taken for.
    pub(in crate::filter) seen: Seen,
}

/// A measurement z = H x + v, var v = R, with what the curvature of h adds to R.
#[derive(Debug, Clone)]
pub(in crate::filter) struct Seen {
    pub(in crate::filter) H: Vec<Vec<Id>>,
    pub(in crate::filter) R: Symmetric,
}

/// The density p of what was measured in a row: -2 ln p = `exponent` + sum ln(2 pi `factors`) + sum power ln `powers`.
///
/// No logarithm is taken in a row: factors and powers are multiplied up over the log.
pub(in crate::filter) struct Likelihood {
    /// See there; the NIS, where the density is a gaussian. 0 where nothing is measured.
    pub(in crate::filter) exponent: Id,
    /// One for each component of the measurement, at most.
    pub(in crate::filter) factors: Vec<Factor>,
    /// What counts with a power of its own; left out where nothing is measured.
    pub(in crate::filter) powers: Vec<Power>,
}

/// A factor of a density for a row with a measurement.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Power {
    /// Positive, without a unit, and best within 1e-15 to 1e15: single precision multiplies two of them.
    pub(in crate::filter) value: Id,
    /// The same in every row: a number, or a value that depends on the candidate alone.
    pub(in crate::filter) power: Id,
}

/// A factor of a likelihood.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Factor {
    pub(in crate::filter) value: Id,
    /// The component of the measurement that it stands for, and with which it is missing.
    pub(in crate::filter) component: usize,
}
