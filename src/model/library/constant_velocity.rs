//! Nearly constant velocity: white-noise acceleration (Bar-Shalom, Li and Kirubarajan 2001, sections 6.2.2 and 6.3.2).

use super::{BuiltIn, Noise, chains, matrix};
use crate::model::Expr;

/// States: the positions, then the velocities.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "constant-velocity",
    axes: [1, 3],
    leading: None,
    components: &["", "v"],
    strengths: &["q"],
    read: |keys| chains(keys, 2, &["q"], process_noise),
};

/// Continuous: q [[dt^3/3, dt^2/2], [dt^2/2, dt]]. Piecewise: q G G' with G = [dt^2/2, dt].
pub(super) fn process_noise(noise: Noise, strengths: &[Expr]) -> Vec<Expr> {
    match noise {
        Noise::Continuous => matrix(&strengths[0], &[(3, 3), (2, 2), (2, 2), (1, 1)]),
        Noise::Piecewise => matrix(&strengths[0], &[(4, 4), (3, 2), (3, 2), (2, 1)]),
    }
}
