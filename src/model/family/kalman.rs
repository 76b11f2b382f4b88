//! The linear Kalman filter.

use super::{Adapts, Described, Facts, Setting, Settings};
use crate::model::error::Fault;

/// The linear Kalman filter; it has no settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kalman;

impl Described for Kalman {
    const NAME: &'static str = "kalman";
    const KEYS: &'static [&'static str] = &[];

    fn read(_: &dyn Settings) -> Result<Self, Fault> {
        Ok(Self)
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        vec![]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: false, adapts: Adapts::Nothing, noise_floor: None }
    }
}
