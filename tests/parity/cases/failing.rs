//! Candidates that fail among good ones: reference and lanes must agree on which.

use crate::case::{ALL, Case, INNOVATIONS, Text};
use crate::logs::{Gap, Shape};

const FULL: Shape = Shape::regular(&[60]);

pub(crate) fn cases() -> Vec<Case> {
    let plane = "state = [\"x\", \"y\"]\nf = [\"x\", \"y\"]\nh = [\"x\", \"y\"]\nQ = [0.001, 0.001]\nx0 = [0, 1]\nP0 = [0.01, 0.01]\nR = [[1, \"c\"], [\"c\", 1]]";
    let indefinite = Text {
        measurements: &["z1", "z2"],
        truth: &["x", "y"],
        model: plane,
        parameters: "c = { min = 0, max = 2, start = 0.3 }",
        objectives: ALL,
        ..Text::BASIC
    };
    let level = "state = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\nQ = [0.05]\nx0 = [0]\nP0 = [1]\nR = [\"r - 2\"]";
    let negative = Text {
        model: level,
        parameters: "r = { min = 0, max = 10, start = 4 }",
        objectives: INNOVATIONS,
        ..Text::BASIC
    };
    let unused = "state = [\"x\"]\nf = [\"x\"]\nh = [\"x\", \"x\"]\nQ = [0.05]\nx0 = [0]\nP0 = [1]\nR = [1, \"r - 2\"]";
    let unused = Text { measurements: &["z1", "z2"], model: unused, ..negative };
    let never = FULL.without(&[Gap::Component { component: 1, trajectory: 0 }]);
    let growing = "state = [\"x\"]\nf = [\"a*x\"]\nh = [\"x\"]\nQ = [0.05]\nx0 = [0]\nP0 = [1]\nR = [1]";
    let growing = Text { model: growing, parameters: "a = { min = 0.5, max = 1.2, start = 1 }", ..negative };
    let boundary = "state = [\"x\", \"y\"]\nf = [\"x\", \"y\"]\nh = [\"x\", \"y\"]\nQ = [0.1, 0.1]\nx0 = [0, 1]\nP0 = [1, 1]\nR = { factor = \"M\", form = \"lower\" }";
    let boundary = Text {
        model: boundary,
        parameters: "M = { min = 0, max = 2, start = 1 }",
        objectives: r#"["nll", "nis", "rmse"]"#,
        ..indefinite
    };
    let mut cases = vec![
        Case::new("indefinite R", &indefinite, FULL, 257),
        Case::new("indefinite R, gaps", &indefinite, FULL.without(&[Gap::Components(0.3)]), 257),
        Case::new("negative R", &negative, FULL, 257),
        Case::new("negative R of a component never present", &unused, never, 65),
        Case::new("overflowing f", &growing, FULL, 65),
        Case::new("R singular at a bound", &boundary, FULL, 9),
        Case::new("R singular at a bound, gaps", &boundary, FULL.without(&[Gap::Components(0.3)]), 9),
    ];
    for overflowing in [1e160, -1e200, f64::MAX] {
        cases[4].population.push(&[overflowing]);
    }
    for case in &mut cases[5..] {
        for at_bound in [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]] {
            case.population.push(&at_bound);
        }
    }
    cases
}
