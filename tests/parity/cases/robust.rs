//! Robust updates, every kind around every sort of filter, on logs with outliers and gaps.

use crate::case::{ALL, Case, OPTIONS, Text};
use crate::logs::{Gap, Shape};
use kfgpu::data::{Log, Table};
use kfgpu::random::{Purpose, Stream};

const FULL: Shape = Shape::regular(&[90]);
const GAPS: Shape = Shape::regular(&[50, 1, 40]).without(&[Gap::Components(0.25), Gap::Rows(0.1), Gap::Truth(0.1)]);

const CLIMB: &str = r#"state = ["d", "v", "a"]
f = ["d + v*dt + 0.5*a*dt^2", "v + a*dt", "a"]
h = ["d"]
Q = { a = "q" }
R = ["r"]
x0 = [10, 1, 0.2]
P0 = [5, 2, 1]"#;

const PLANE: &str = r#"state = ["x", "y"]
f = ["x + 0.1*y", "0.9*y"]
h = ["x", "x - 0.5*y"]
Q = ["q", "q"]
R = [["r"], ["0.4*r", "2*r"]]
x0 = "measurement"
P0 = [2, 2]"#;

const THREE: &str = r#"state = ["x", "y"]
f = ["x + 0.1*y", "0.9*y"]
h = ["x", "x - 0.5*y", "x + y"]
Q = ["q", "q"]
R = [["r"], ["0.4*r", "2*r"], [0, "0.3*r", "r"]]
x0 = [0, 0]
P0 = [2, 2]"#;

/// A target near a sensor of range and bearing.
const RADAR: &str = r#"state = ["x", "y", "vx", "vy"]
f = ["x + vx*dt", "y + vy*dt", "vx", "vy"]
h = ["sqrt(x^2 + y^2)", "atan2(y, x)"]
angle = ["z2"]
Q = { vx = "q", vy = "q" }
R = ["r", "1e-4*r"]
x0 = [600, 400, 1, -1]
P0 = [25, 25, 4, 4]"#;

/// The same with a third sensor.
const RANGES: &str = r#"state = ["x", "y", "vx", "vy"]
f = ["x + vx*dt", "y + vy*dt", "vx", "vy"]
h = ["sqrt(x^2 + y^2)", "atan2(y, x)", "sqrt((x - 300)^2 + y^2)"]
angle = ["z2"]
Q = { vx = "q", vy = "q" }
R = [["r"], [0, "1e-4*r"], ["0.3*r", 0, "r"]]
x0 = [600, 400, 1, -1]
P0 = [25, 25, 4, 4]"#;

/// The keys of `[filter]` and the parameters of every kind.
const KINDS: [(&str, &str, &str); 5] = [
    ("mixture", "eps = \"eps\"", "eps = { min = 0.001, max = 0.3, scale = \"log\", start = 0.05 }"),
    ("student-t", "dof = \"dof\"", "dof = { min = 2.5, max = 30, start = 5 }"),
    ("huber", "k = \"k\"", "k = { min = 0.8, max = 3, start = 1.345 }"),
    ("correntropy", "k = \"2*k\"\neps = 0.1", "k = { min = 0.8, max = 3, start = 1.345 }"),
    ("gate", "gate = \"gate\"\nlimit = 3\neps = \"eps\"", "gate = { min = 4, max = 16, start = 9 }\neps = 0.05"),
];

/// Every twentieth value far off, to both sides.
fn spoiled(mut log: Log, size: f64) -> Log {
    for (t, trajectory) in log.trajectories.iter_mut().enumerate() {
        let mut z = Table::new(trajectory.z.columns());
        for k in 0..trajectory.len() {
            let mut stream = Stream::new(3, Purpose::Workload, t as u64, k as u64);
            let spoil = |z: &f64| {
                let (draw, by) = (stream.uniform(), stream.uniform());
                if draw < 0.05 { z + size * (by - 0.5) } else { *z }
            };
            z.push(&trajectory.z.row(k).iter().map(spoil).collect::<Vec<f64>>());
        }
        trajectory.z = z;
    }
    log
}

fn case(name: &str, text: &Text<'_>, (shape, size): (Shape, f64)) -> Case {
    let drawn = Case::new(name, text, shape, 33);
    let log = spoiled(drawn.log, size);
    Case::of(drawn.name, drawn.problem, log, 33)
}

/// One of each kind.
pub(crate) fn cases() -> Vec<Case> {
    let names = [
        "mixture, extended radar, gaps",
        "student-t, correlated, gaps",
        "huber, three",
        "correntropy, climb",
        "gate, unscented radar, gaps",
    ];
    every(|name| names.contains(&name))
}

/// Those with names that are asked for.
pub(crate) fn every(asked: impl Fn(&str) -> bool) -> Vec<Case> {
    let mut cases = Vec::new();
    for (kind, keys, parameters) in KINDS {
        let parameters = format!("{}\n{parameters}", Text::BASIC.parameters);
        let mut add = |name: &str, (filter, model): (&str, &str), measurements: &[&str], truth: &[&str]| {
            let filter = format!("kind = \"{filter}\"\nrobust = \"{kind}\"\n{keys}");
            let base = Text { filter: &filter, model, measurements, truth, parameters: &parameters, ..Text::BASIC };
            let size = if model == RADAR || model == RANGES { 60.0 } else { 40.0 };
            for (gaps, shape, objectives) in [("", FULL, ALL), (", gaps", GAPS, OPTIONS)] {
                let name = format!("{kind}, {name}{gaps}");
                // Without gaps, linear filters show all that masks do not.
                if asked(&name) && (filter.starts_with("kind = \"kalman\"") || !gaps.is_empty()) {
                    cases.push(case(&name, &Text { objectives, ..base }, (shape, size)));
                }
            }
        };
        let (one, two, three) = (["z"], ["z1", "z2"], ["z1", "z2", "z3"]);
        let moving = ["x", "y", "vx", "vy"];
        add("climb", ("kalman", CLIMB), &one, &["d", "v", "a"]);
        let diffuse = CLIMB.replace("P0 = [5, 2, 1]", "P0 = [1e5, 1e5, 1e5]");
        add("climb, diffuse", ("kalman", &diffuse), &one, &["d", "v", "a"]);
        add("correlated", ("kalman", PLANE), &two, &["x", "y"]);
        add("three", ("kalman", THREE), &three, &["x", "y"]);
        for filter in ["extended", "iterated", "unscented"] {
            add(&format!("{filter} radar"), (filter, RADAR), &two, &moving);
        }
        for filter in ["iterated", "unscented"] {
            add(&format!("{filter} ranges"), (filter, RANGES), &three, &moving);
        }
    }
    cases
}
