//! The families of filters, one line each; what they do stands in `gaussian/`.

use super::family::Family;
use super::form::Carrying;
use super::gaussian::Gaussian;
use super::gaussian::adapt::{Fuzzy, NoAdaptation, SageHusa, SageHusaR};
use super::gaussian::moments::{Affine, Extended, Points, Sigma};
use crate::model::FilterKind;

/// The filter that a problem asks for.
pub(super) fn of(kind: &FilterKind, carrying: Carrying) -> Box<dyn Family> {
    match kind {
        FilterKind::Kalman(_) => Box::new(Gaussian::new(carrying, Affine, NoAdaptation)),
        FilterKind::SageHusa(_) => Box::new(Gaussian::new(carrying, Affine, SageHusa)),
        FilterKind::SageHusaR(_) => Box::new(Gaussian::new(carrying, Affine, SageHusaR)),
        FilterKind::Extended(_) => Box::new(Gaussian::new(carrying, Extended::new(carrying, 1), NoAdaptation)),
        FilterKind::Iterated(iterated) => {
            Box::new(Gaussian::new(carrying, Extended::new(carrying, iterated.iterations), NoAdaptation))
        }
        FilterKind::Unscented(_) => {
            Box::new(Gaussian::new(carrying, Sigma::new(carrying, Points::Unscented), NoAdaptation))
        }
        FilterKind::Cubature(_) => {
            Box::new(Gaussian::new(carrying, Sigma::new(carrying, Points::Cubature), NoAdaptation))
        }
        FilterKind::Fuzzy(fuzzy) => Box::new(Gaussian::new(carrying, Affine, Fuzzy { window: fuzzy.window })),
    }
}
