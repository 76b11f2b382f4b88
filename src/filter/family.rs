//! What a family of filters is to tracing.

use super::error::TraceError;
use super::evidence::Evidence;
use super::row::Row;
use super::tracer::Tracer;
use crate::model::Model;
use crate::tape::Id;

/// A filter, on the graph: what it starts from, and what a row makes of what it carries.
///
/// The first n entries of what is carried are the mean of the state, or of its first mode.
pub(super) trait Family {
    /// Names of the entries, in order.
    fn names(&self, model: &Model) -> Vec<String>;

    /// Number of entries at the end of which nothing is to be found out: they are neither constant nor equal to others.
    fn opaque(&self, _: &Model) -> usize {
        0
    }

    /// Number of gaussians that are mixed: their entries stand one after the other, then comes the probability of each. 0 where
    /// one is all there is.
    fn modes(&self) -> usize {
        0
    }

    /// The entries before the first row of a trajectory.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    fn start(&self, t: &mut Tracer<'_>) -> Result<Vec<Id>, TraceError>;

    /// The measurement update: from prior to posterior.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    fn update(&self, t: &mut Tracer<'_>, row: &Row, prior: &[Id]) -> Result<(Evidence, Vec<Id>), TraceError>;

    /// The time update: from posterior to the prior of the next row.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    fn predict(&self, t: &mut Tracer<'_>, row: &Row, posterior: &[Id]) -> Result<Predicted, TraceError>;

    /// A state, known for certain, one row on without the process noise: f(x). States are as the first n entries are carried.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    fn advance(&self, t: &mut Tracer<'_>, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError>;

    /// What is measured in a row less what such a state says of it, z - h(x); meaningless where missing.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    fn residual(&self, t: &mut Tracer<'_>, row: &Row, x: &[Id]) -> Result<Vec<Id>, TraceError>;
}

/// What a time update makes.
pub(super) struct Predicted {
    /// The entries before the next row.
    pub(super) prior: Vec<Id>,
    /// What a candidate fails without.
    pub(super) positive: Vec<Id>,
}
