//! The extended Kalman filter.

use super::{Adapts, Described, Facts, Setting, Settings, View};
use crate::model::error::Fault;

/// f and h are replaced by their tangents at the mean: Jazwinski, *Stochastic Processes and Filtering Theory* (1970),
/// section 8.3. It has no settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extended;

impl Described for Extended {
    const NAME: &'static str = "extended";
    const KEYS: &'static [&'static str] = &[];
    const LINEAR: bool = false;
    const VIEW: View = View::Tangent;

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
