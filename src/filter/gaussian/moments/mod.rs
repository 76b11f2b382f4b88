//! Moment rules: how a gaussian goes through a formula of the model. One file a rule; every rule is a linear map with excess
//! noise, so that updates, masks, factors and adaptation are written once.

mod affine;
mod linearised;
mod sigma;
mod tangent;

pub(in crate::filter) use affine::Affine;
pub(in crate::filter) use linearised::Linearised;
pub(in crate::filter) use sigma::{Points, Sigma};

use crate::filter::covariance::Covariance;
use crate::filter::covariance::Symmetric;
use crate::filter::error::TraceError;
use crate::filter::nodes::{MapNodes, ModelNodes};
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units::Units;
use crate::tape::{Graph, Id};

/// Which formulas of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::filter) enum Map {
    /// f: from a state to the next.
    Transition,
    /// h: from a state to what is measured.
    Measurement,
}

impl Map {
    /// Its formulas.
    const fn of(self, model: &ModelNodes) -> &MapNodes {
        match self {
            Self::Transition => &model.f,
            Self::Measurement => &model.h,
        }
    }

    /// In which its values are computed.
    fn units(self, units: &Units) -> &[i32] {
        match self {
            Self::Transition => &units.states,
            Self::Measurement => &units.measurements,
        }
    }
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
    /// Where the rule has them, what the same is gathered from without taking anything away.
    pub(in crate::filter) columns: Option<Columns>,
    /// What a candidate fails without.
    pub(in crate::filter) positive: Vec<Id>,
}

impl Moments {
    /// The mean as one number a row: of a transition, where nothing is left to cancel.
    pub(in crate::filter) fn mean(&self, g: &mut Graph) -> Vec<Id> {
        let parts = self.linear.iter().zip(self.fixed.iter().zip(&self.moved));
        let mean = parts.map(|(linear, (fixed, moved))| {
            let drift = g.add(*fixed, *moved);
            g.add(*linear, drift)
        });
        mean.collect()
    }
}

/// Columns whose squares add up to covariances.
pub(in crate::filter) struct Columns {
    /// To J P J'.
    pub(in crate::filter) linear: Vec<Vec<Id>>,
    /// To the excess.
    pub(in crate::filter) excess: Vec<Vec<Id>>,
}

/// Affine formulas, by whatever rule: all are exact for them.
fn exact(t: &mut Tracer<'_>, row: &Row, map: Map, x: &[Id], P: &Covariance) -> Result<Moments, TraceError> {
    Affine.through(t, row, map, x, P)
}

/// A way to take a gaussian through formulas.
pub(in crate::filter) trait MomentRule {
    /// Takes a gaussian of mean `x` and covariance `P` through `map`.
    ///
    /// # Errors
    /// If the rule does not fit the formulas.
    fn through(&self, t: &mut Tracer<'_>, row: &Row, map: Map, x: &[Id], P: &Covariance)
    -> Result<Moments, TraceError>;

    /// How often h is linearised in a row: again at the updated mean from the second time on.
    fn iterations(&self, _: &Row) -> usize {
        1
    }
}
