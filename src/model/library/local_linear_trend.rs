//! Local linear trend: a level and its slope, both wandering (Durbin and Koopman 2012, section 3.2).

use super::{BuiltIn, Noise, chains, matrix, share};
use crate::model::{Binary, Expr};

/// States: the levels, then the slopes per second.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "local-linear-trend",
    axes: [1, 3],
    leading: None,
    components: &["", "slope_"],
    strengths: &["q_level", "q_slope"],
    read: |keys| chains(keys, 2, &["q_level", "q_slope"], process_noise),
};

/// Continuous: independent white noises of densities q_level on the level's rate and q_slope on the slope's, integrated
/// over the step. Piecewise: the textbook's diag(q_level, q_slope) of each step.
fn process_noise(noise: Noise, strengths: &[Expr]) -> Vec<Expr> {
    let (level, slope) = (&strengths[0], &strengths[1]);
    match noise {
        Noise::Continuous => {
            let mut q = matrix(slope, &[(3, 3), (2, 2), (2, 2), (1, 1)]);
            q[0] = Expr::binary(Binary::Add, share(level, 1, 1), q[0].clone());
            q
        }
        Noise::Piecewise => vec![level.clone(), Expr::number(0.0), Expr::number(0.0), slope.clone()],
    }
}
