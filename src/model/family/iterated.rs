//! The iterated extended Kalman filter.

use super::{Adapts, Described, Facts, Setting, Settings, View};
use crate::model::error::Fault;

/// The extended filter whose h is linearised again at the updated mean: a Gauss-Newton step each (Bell and Cathey 1993,
/// doi 10.1109/9.250476).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Iterated {
    /// Number of linearisations of h in a row; the first is that of the extended filter.
    pub iterations: usize,
}

/// Every one is traced.
const MOST: u32 = 20;

impl Described for Iterated {
    const NAME: &'static str = "iterated";
    const KEYS: &'static [&'static str] = &["iterations"];
    const LINEAR: bool = false;
    const VIEW: View = View::TangentAgain;

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        Ok(Self { iterations: settings.count("iterations", 3, 1, MOST)? })
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        vec![]
    }

    fn sizes(&self) -> Vec<usize> {
        vec![self.iterations]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: false, adapts: Adapts::Nothing, noise_floor: None }
    }
}
