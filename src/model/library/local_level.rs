//! Local level: a level that wanders, the first structural time-series model (Durbin and Koopman 2012, chapter 2).

use super::{BuiltIn, Noise, chains, matrix};
use crate::model::Expr;

/// State: the level of each axis.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "local-level",
    axes: [1, 3],
    leading: None,
    components: &[""],
    strengths: &["q"],
    read: |keys| chains(keys, 1, &["q"], process_noise),
};

/// q dt for a spectral density q, q for a variance per step.
pub(super) fn process_noise(noise: Noise, strengths: &[Expr]) -> Vec<Expr> {
    match noise {
        Noise::Continuous => matrix(&strengths[0], &[(1, 1)]),
        Noise::Piecewise => matrix(&strengths[0], &[(0, 1)]),
    }
}
