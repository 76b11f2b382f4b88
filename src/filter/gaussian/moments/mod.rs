//! Moment rules: how a gaussian goes through a formula of the model. One file a rule; every rule is a linear map with excess
//! noise, so that updates, masks, factors and adaptation are written once.

mod affine;

pub(in crate::filter) use affine::Affine;

use crate::filter::covariance::Covariance;
use crate::filter::covariance::Symmetric;
use crate::filter::error::TraceError;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::tape::Id;

/// Which formulas of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::filter) enum Map {
    /// f: from a state to the next.
    Transition,
    /// h: from a state to what is measured.
    Measurement,
}

/// Mean and covariance of y = f(x) for a gaussian x, in the filter's units; in the deviation form of y less f at the nominal.
///
/// The mean is `fixed + moved + linear`, kept apart because `fixed` may be hundreds of kilometres: it must meet what it
/// cancels (z, or the next nominal) in f64, before single precision adds a candidate's own share.
pub(in crate::filter) struct Moments {
    /// The same for every candidate (in the absolute form, as far as the rule can tell it apart).
    pub(in crate::filter) fixed: Vec<Id>,
    /// What a candidate's parameters change where the states are the nominal's.
    pub(in crate::filter) moved: Vec<Id>,
    /// What the states change.
    pub(in crate::filter) linear: Vec<Id>,
    /// The linear part of the map: the covariance of y is J P J' and `excess`.
    pub(in crate::filter) jacobian: Vec<Vec<Id>>,
    /// What the rule adds to the noise of the map, positive semidefinite; `None` where a linear map is all there is.
    pub(in crate::filter) excess: Option<Symmetric>,
}

/// A way to take a gaussian through formulas.
pub(in crate::filter) trait MomentRule {
    /// Takes a gaussian of mean `x` and covariance `P` through `map`.
    ///
    /// # Errors
    /// If the rule does not fit the formulas.
    fn through(&self, t: &mut Tracer<'_>, row: &Row, map: Map, x: &[Id], P: &Covariance)
    -> Result<Moments, TraceError>;
}
