//! Objectives of the whole distribution, over time and ahead, on models and logs of every shape.

use crate::case::{Case, Text};
use crate::logs::{Gap, Interval, Shape};

const DEFAULTS: &str = r#"["nis_distribution", "whiteness", "prediction"]"#;

const OPTIONS: &str = r#"[{ name = "nis_distribution", skip = 3 }, { name = "whiteness", lags = 23, skip = 2 },
    { name = "prediction", ahead = [7, 1, 4], skip = 6 }, { name = "mse_innovation", skip = 6 }]
constraints = [{ name = "whiteness", lags = 5, skip = 2, max = 1 }]"#;

const SHAPES: [(&str, Shape); 6] = [
    ("regular", Shape::regular(&[120])),
    ("irregular", Shape::regular(&[100]).every(Interval::Irregular(0.5))),
    ("short trajectories", Shape::regular(&[60, 1, 25, 7])),
    ("components missing", Shape::regular(&[60, 40]).without(&[Gap::Components(0.25)])),
    ("rows missing", Shape::regular(&[90]).without(&[Gap::Rows(0.3), Gap::Leading(4)])),
    ("one component never", Shape::regular(&[40, 60]).without(&[Gap::Component { component: 0, trajectory: 1 }])),
];

const CLIMB: &str = r#"state = ["d", "v", "a"]
f = ["d + v*dt + 0.5*a*dt^2", "v + a*dt", "a"]
h = ["d"]
Q = { a = "q" }
R = ["r"]
x0 = [400000, 1000, 0.2]
P0 = [5, 2, 1]"#;

const DRIVEN: &str = r#"state = ["x", "y"]
f = ["0.95*x + 0.1*y + u*dt", "0.9*y + 0.2"]
h = ["x + 3", "x - 0.5*y + u"]
Q = ["q", "q"]
R = [["r", "0.3*r"], ["0.3*r", "2*r"]]
x0 = "measurement"
P0 = [2, 2]"#;

const PLANE: &str = r#"kind = "constant-velocity"
axes = ["x", "y", "z"]
q = "q"
R = ["r", "r", "r"]
first = "predict"
first_dt = 0.5
x0 = [0, 0, 0, 1, 1, 1]
P0 = [10, 10, 10, 4, 4, 4]"#;

const FUZZY: &str = "kind = \"fuzzy\"\nwindow = 6\ngain = 0.1\nwidth = 0.5";

pub(crate) fn cases() -> Vec<Case> {
    let base = Text::BASIC;
    let texts = [
        ("climb", Text { model: CLIMB, ..base }),
        ("climb, fuzzy", Text { model: CLIMB, filter: FUZZY, ..base }),
        ("driven", Text { measurements: &["z1", "z2"], inputs: &["u"], model: DRIVEN, ..base }),
        ("plane", Text { measurements: &["x", "y", "z"], model: PLANE, ..base }),
    ];
    let mut cases = Vec::new();
    for (name, text) in texts {
        for (shape, log) in SHAPES {
            let started = name == "driven";
            // A start from a measurement needs a complete one in every trajectory.
            if started && shape == "one component never" {
                continue;
            }
            let objectives = if cases.len() % 3 == 2 { OPTIONS } else { DEFAULTS };
            cases.push(Case::new(format!("objectives, {name}, {shape}"), &Text { objectives, ..text }, log, 65));
        }
    }
    cases
}
