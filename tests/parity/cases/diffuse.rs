//! Diffuse starts: P0/R of 1e4 to 1e12. f32 carries factors above 1e3, f64 above 1e6, and both keep their promise to the end.

use crate::case::{Case, INNOVATIONS, Text};
use crate::logs::{Gap, Shape};

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [4, 6, 8, 12] {
        for (kind, n) in [("local-level", 1), ("constant-velocity", 2), ("constant-acceleration", 3)] {
            let model = format!(
                "kind = \"{kind}\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = {:?}\nP0 = {:?}",
                vec![0; n],
                vec![10f64.powi(exponent); n]
            );
            let parameters =
                "q = { min = 0.01, max = 1, scale = \"log\", start = 0.1 }\nr = { min = 1, max = 3, start = 1 }";
            let text = Text { model: &model, parameters, objectives: INNOVATIONS, ..Text::BASIC };
            let shape = Shape::regular(&[100]).without(&[Gap::Components(0.1)]);
            cases.push(Case::new(format!("{kind} P0/R 1e{exponent}"), &text, shape, 65));
        }
    }
    cases
}
