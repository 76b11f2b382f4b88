//! Built-in motion beyond chains of integrators: Singer's acceleration, known turns.

use crate::case::{ALL, Case, INNOVATIONS, Text};
use crate::logs::{Gap, Interval, Shape};

const FULL: Shape = Shape::regular(&[100]);
const IRREGULAR: Shape = Shape::regular(&[60, 30]).every(Interval::Irregular(1.0)).without(&[Gap::Components(0.2)]);

const SINGER: &str = r#"kind = "singer"
axes = ["x", "y"]
q = "q"
alpha = { x = "alpha", y = "2*alpha" }
R = ["r", "r"]
x0 = [0, 0, 1, 1, 0, 0]
P0 = [10, 10, 4, 4, 1, 1]"#;

const TURN: &str = r#"kind = "coordinated-turn"
axes = ["x", "y"]
rate = "w"
q = "q"
R = ["r", "2*r"]
x0 = [0, 0, 1, 1]
P0 = [10, 10, 4, 4]"#;

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    // Rates below and above 1 / dt, where the formulas of Singer's Q change.
    let forgets =
        format!("{}\nalpha = {{ min = 1e-4, max = 5, scale = \"log\", start = 0.3 }}", Text::BASIC.parameters);
    let turns = format!("{}\nw = {{ min = -0.5, max = 0.5, start = 0 }}", Text::BASIC.parameters);
    for (name, model, parameters, truth) in [
        ("singer", SINGER, &forgets, &["x", "y", "vx", "vy", "ax", "ay"][..]),
        ("known turn", TURN, &turns, &["x", "y", "vx", "vy"][..]),
    ] {
        let text = Text { measurements: &["x", "y"], truth, model, parameters, objectives: ALL, ..Text::BASIC };
        cases.push(Case::new(name, &text, FULL, 65));
        let text = Text { objectives: INNOVATIONS, ..text };
        cases.push(Case::new(format!("{name}, irregular"), &text, IRREGULAR, 65));
    }
    cases
}
