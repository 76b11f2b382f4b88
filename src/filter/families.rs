//! The families of filters, one line each; what they do stands in `gaussian/`.

use super::family::Family;
use super::form::Carrying;
use super::gaussian::Gaussian;
use super::gaussian::adapt::{Fuzzy, NoAdaptation, SageHusa, SageHusaR};
use super::gaussian::moments::{Affine, Linearised, Points, Sigma};
use super::imm::{Imm, ModeFilter};
use crate::model::{FilterKind, Mode, Problem};

/// The filter that a problem asks for.
pub(super) fn of(problem: &Problem, carrying: Carrying) -> Box<dyn Family> {
    let robust = problem.robust.as_ref();
    match &problem.filter {
        FilterKind::Kalman(_) => Box::new(Gaussian::new(carrying, Affine, NoAdaptation).with(robust)),
        FilterKind::SageHusa(_) => Box::new(Gaussian::new(carrying, Affine, SageHusa)),
        FilterKind::SageHusaR(_) => Box::new(Gaussian::new(carrying, Affine, SageHusaR)),
        FilterKind::Extended(_) => {
            Box::new(Gaussian::new(carrying, Linearised::new(carrying, 1), NoAdaptation).with(robust))
        }
        FilterKind::Iterated(iterated) => {
            Box::new(Gaussian::new(carrying, Linearised::new(carrying, iterated.iterations), NoAdaptation).with(robust))
        }
        FilterKind::Unscented(_) => {
            Box::new(Gaussian::new(carrying, Sigma::new(carrying, Points::Settings), NoAdaptation).with(robust))
        }
        FilterKind::Cubature(_) => {
            Box::new(Gaussian::new(carrying, Sigma::new(carrying, Points::Equal), NoAdaptation).with(robust))
        }
        FilterKind::Fuzzy(fuzzy) => Box::new(Gaussian::new(carrying, Affine, Fuzzy { window: fuzzy.window })),
        FilterKind::Imm(imm) => {
            let mode = |mode: &Mode| {
                let own = problem.of_mode(mode);
                let family = of(&own, carrying);
                ModeFilter { name: mode.name.clone(), problem: own, family, allowed: mode.allowed.clone() }
            };
            let modes = problem.modes.iter().map(mode).collect();
            Box::new(Imm { modes, transition: imm.transition.clone(), start: imm.start.clone() })
        }
    }
}
