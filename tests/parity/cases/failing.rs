//! Candidates that fail among good ones: reference and lanes must agree on which, and by which bit.

use crate::case::{ALL, Case, INNOVATIONS, Refusal, Text};
use crate::logs::{Gap, Interval, Shape};

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
    cases.extend(straddling());
    for overflowing in [1e160, -1e200, f64::MAX] {
        cases[4].population.push(&[overflowing]);
    }
    for case in &mut cases[5..7] {
        for at_bound in [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]] {
            case.population.push(&at_bound);
        }
    }
    cases
}

/// Half of the candidates have a Q, R or P0 that is no covariance, although S may stay positive.
fn straddling() -> Vec<Case> {
    let model = |q: &str, r: &str, p0: &str| {
        format!(
            "state = [\"x\", \"v\"]\nf = [\"x + v*dt\", \"v\"]\nh = [\"x\", \"v\"]\nQ = {q}\nx0 = [0, 1]\nP0 = {p0}\nR = {r}"
        )
    };
    let (q, r, p0) = ("[0.1, 0.1]", "[1, 2]", "[9, 4]");
    let irregular = FULL.every(Interval::Irregular(0.5));
    let cases = [
        ("Q below 0", model("[0.1, \"a\"]", r, p0), FULL),
        ("Q by dt", model("[[\"0.3*dt\", \"a*dt\"], [\"a*dt\", \"0.2*dt\"]]", r, p0), irregular),
        ("Q at long intervals", model("[0.1, \"0.2 + a*dt\"]", r, p0), irregular),
        ("R below 0", model(q, "[\"a + 0.2\", 2]", p0), FULL),
        ("R indefinite", model(q, "[[1, \"2*a\"], [\"2*a\", 2]]", p0), FULL.without(&[Gap::Components(0.3)])),
        ("P0 indefinite", model(q, r, "[[9, \"9*a\"], [\"9*a\", 4]]"), FULL),
    ];
    let case = |(name, model, shape): (&str, String, Shape)| {
        let text = Text {
            measurements: &["z1", "z2"],
            truth: &["x", "v"],
            model: &model,
            parameters: "a = { init = [-1, 1], start = 0.1 }",
            objectives: r#"["nll", "nis", "mse_innovation", "rmse"]"#,
            ..Text::BASIC
        };
        let case = Case::new(format!("straddling, {name}"), &text, shape, 65);
        let failed = case.reference().iter().filter(|costs| **costs == Err(Refusal::NotPositive)).count();
        assert!(failed > 5 && failed < 60, "{}: {failed} of 65 candidates fail", case.name);
        case
    };
    cases.map(case).into()
}
