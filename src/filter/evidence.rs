//! What objectives may see of a row, whatever the filter.

use super::covariance::Covariance;
use crate::tape::Id;

/// What a filter says of a row: nodes, in the filter's units, of the prior against what was measured, and of the posterior.
pub(crate) struct Evidence {
    /// Joint innovation z - E z, m; meaningless where missing.
    pub(in crate::filter) innovation: Vec<Id>,
    /// Diagonal of its joint covariance S, m.
    pub(in crate::filter) spread: Vec<Id>,
    /// The likelihood of the row is exp(-`exponent` / 2) over the square root of the product of 2 pi and these.
    pub(in crate::filter) factors: Vec<Factor>,
    /// See there; the NIS, where the filter is one gaussian.
    pub(in crate::filter) exponent: Id,
    /// nu' S^-1 nu over the present components, 0 where there is none; `None` where a filter has no such number.
    pub(in crate::filter) nis: Option<Id>,
    /// Posterior mean, n.
    pub(in crate::filter) state: Vec<Id>,
    /// Posterior covariance.
    pub(in crate::filter) covariance: Covariance,
    /// For each state the presence of the components that see it by itself, each by itself.
    pub(in crate::filter) alone: Vec<Vec<Id>>,
    /// What a candidate fails without, besides the factors.
    pub(in crate::filter) positive: Vec<Id>,
}

/// A factor of a likelihood.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Factor {
    pub(in crate::filter) value: Id,
    /// The component of the measurement that it stands for, and with which it is missing.
    pub(in crate::filter) component: usize,
}
