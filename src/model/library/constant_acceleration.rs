//! Nearly constant acceleration: white-noise jerk, or a Wiener acceleration in steps (Bar-Shalom, Li and Kirubarajan
//! 2001, sections 6.2.3 and 6.3.3).

use super::{BuiltIn, Noise, chains, matrix};
use crate::model::Expr;

/// States: the positions, then the velocities, then the accelerations.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "constant-acceleration",
    axes: [1, 3],
    leading: None,
    components: &["", "v", "a"],
    strengths: &["q"],
    read: |keys| chains(keys, 3, &["q"], process_noise),
};

/// Continuous: q integrated three times. Piecewise: q G G' with G = [dt^2/2, dt, 1].
fn process_noise(noise: Noise, strengths: &[Expr]) -> Vec<Expr> {
    let q = &strengths[0];
    match noise {
        Noise::Continuous => matrix(q, &[(5, 20), (4, 8), (3, 6), (4, 8), (3, 3), (2, 2), (3, 6), (2, 2), (1, 1)]),
        Noise::Piecewise => matrix(q, &[(4, 4), (3, 2), (2, 2), (3, 2), (2, 1), (1, 1), (2, 2), (1, 1), (0, 1)]),
    }
}
