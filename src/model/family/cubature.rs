//! The cubature Kalman filter.

use super::{Adapts, Described, Facts, Setting, Settings, View};
use crate::model::error::Fault;

/// f and h are taken at x +- sqrt(n) L_j with equal weights: Arasaratnam and Haykin (2009, doi 10.1109/TAC.2009.2019800). It is
/// the unscented filter with alpha 1, beta 0, kappa 0, and has no settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cubature;

impl Described for Cubature {
    const NAME: &'static str = "cubature";
    const KEYS: &'static [&'static str] = &[];
    const LINEAR: bool = false;
    const VIEW: View = View::Points;

    fn read(_: &dyn Settings) -> Result<Self, Fault> {
        Ok(Self)
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        vec![]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: true, adapts: Adapts::Nothing, noise_floor: None }
    }
}
