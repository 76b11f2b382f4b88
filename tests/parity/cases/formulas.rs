//! Typed models: searched parameters everywhere, inputs, ties, factors, singular dynamics, 1 to 8 states.

use crate::case::{ALL, Case, OPTIONS, Text};
use crate::logs::{Gap, Interval, Shape};

const REGULAR: Shape = Shape::regular(&[100]);
const IRREGULAR: Shape = REGULAR.every(Interval::Irregular(1.0));
const POOLED: Shape = Shape::regular(&[50, 1, 20]).without(&[Gap::Components(0.2)]);

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = searched();
    cases.extend(inputs());
    cases.extend(singular());
    cases.extend((1..=8).map(chain));
    cases.extend((2..=8).step_by(2).map(dense));
    cases
}

/// Position and velocity with friction; everything may be searched.
const MOTION: Text<'static> = Text {
    truth: &["d", "v"],
    model: "state = [\"d\", \"v\"]\nf = [\"d + v*dt\", \"v\"]\nh = [\"d\"]\nQ = { v = \"q\" }\nR = [\"r\"]\nx0 = [1, 0.5]\nP0 = [3, 1]",
    objectives: ALL,
    ..Text::BASIC
};

const FRICTION: &str = r#"state = ["d", "v"]
f = ["d + v*dt", "phi*v"]
h = ["gain*d + bias"]
Q = { v = "q" }
R = ["r"]
x0 = ["d0", "2*d0"]
P0 = ["p", "p/4"]"#;

fn searched() -> Vec<Case> {
    let parameters = format!(
        "{}\nphi = {{ min = 0.8, max = 1, start = 0.95 }}\ngain = {{ min = 0.9, max = 1.1, start = 1 }}\n\
         bias = {{ min = -1, max = 1, start = 0 }}\nd0 = {{ min = -2, max = 2, start = 0.5 }}\n\
         p = {{ min = 0.5, max = 50, scale = \"log\", start = 4 }}",
        Text::BASIC.parameters
    );
    let all = Text { model: FRICTION, parameters: &parameters, ..MOTION };
    let scaled = FRICTION.replace("v*dt", "phi*v*dt");
    let times_dt = Text { model: &scaled, ..all };
    let tied = format!("{}\nq2 = {{ tie = \"q\" }}\nr2 = {{ tie = \"r\" }}", Text::BASIC.parameters);
    let tied_model = "state = [\"d\", \"v\"]\nf = [\"d + v\", \"v\"]\nh = [\"d\", \"d + v\"]\nQ = [\"q\", \"q2/3\"]\nR = [\"r\", \"r2\"]\nx0 = [0, 0]\nP0 = [1, 1]";
    let tied = Text { measurements: &["z1", "z2"], model: tied_model, parameters: &tied, ..MOTION };
    let factored_model = "state = [\"d\", \"v\"]\nf = [\"d + v\", \"v\"]\nh = [\"d\"]\nQ = { factor = \"L\", form = \"lower\" }\nR = [\"r\"]\nx0 = [0, 0]\nP0 = { factor = \"M\", form = \"square\" }";
    let factored_parameters = "L = { min = -0.3, max = 0.3, start = 0.1 }\nL11 = { min = 0.2, max = 1, start = 0.4 }\nL22 = { tie = \"L11\" }\n\
         M = { init = [-0.5, 0.5], start = 0 }\nM11 = { init = [1, 2], start = 1 }\nM22 = { init = [1, 2], start = 1 }\nr = { min = 0.5, max = 20, start = 2 }";
    let factored = Text { model: factored_model, parameters: factored_parameters, ..MOTION };
    vec![
        Case::new("motion regular", &MOTION, REGULAR, 257),
        Case::new("motion irregular", &MOTION, IRREGULAR, 257),
        Case::new("motion in Unix time", &MOTION, REGULAR.every(Interval::Unix(0.01)), 257),
        Case::new("searched in f, h, x0, P0, Q, R", &all, REGULAR, 257),
        Case::new("searched in f, h, x0, P0, Q, R, pooled", &Text { objectives: OPTIONS, ..all }, POOLED, 257),
        Case::new("searched in f, times a constant dt", &times_dt, REGULAR.every(Interval::Regular(0.5)), 257),
        Case::new("searched in f, times irregular dt", &times_dt, IRREGULAR, 257),
        Case::new("tied", &tied, POOLED, 257),
        Case::new("factored Q and P0", &factored, REGULAR, 257),
        Case::new("factored Q and P0, pooled", &Text { objectives: OPTIONS, ..factored }, POOLED, 257),
    ]
}

const DRIVEN: &str = r#"state = ["d", "v"]
f = ["d + v*dt + 0.5*u", "0.9*v + u - 0.2*w"]
h = ["d + 0.3*w", "d - v + 2"]
Q = ["q/10", "q"]
R = ["r", "r/2"]
P0 = [3, 1]"#;

fn inputs() -> Vec<Case> {
    let start_text = format!("{DRIVEN}\nx0 = [1, 0]");
    let base =
        Text { measurements: &["z1", "z2"], inputs: &["u", "w"], truth: &["d", "v"], objectives: ALL, ..Text::BASIC };
    let measured = format!("{DRIVEN}\nx0 = \"measurement\"");
    let scaled = start_text.replace("+ u -", "+ b*u -");
    let parameters = format!("{}\nb = {{ min = 0.5, max = 2, start = 1 }}", Text::BASIC.parameters);
    let named = r#"["nll", { name = "rmse", states = ["v"] }, { name = "distance", states = ["v", "d"], skip = 2 }]"#;
    let leading = POOLED.without(&[Gap::Components(0.2), Gap::Leading(1)]);
    let start = Text { model: &start_text, ..base };
    let pooled = Shape::regular(&[50, 2, 20]).without(&[Gap::Components(0.2), Gap::Truth(0.3)]);
    // What the input chooses is still affine in the states; the root of the branch that is not taken is none.
    let chosen = start_text.replace("0.9*v + u -", "if(u > 0 and not w < -1, 0.9*v + sqrt(u), 0.8*v - (w >= 0)) -");
    let chosen = Text { model: &chosen, ..base };
    // A curve of an input, whose ends it leaves, and one of a searched parameter.
    let curve = format!("table('{}/tests/data/ocv.csv', ", env!("CARGO_MANIFEST_DIR"));
    let curves = start_text
        .replace("+ 0.3*w", &format!("+ {curve}w)"))
        .replace("0.9*v + u", &format!("({curve}q/5) - 3.2)*v + u"));
    let curves = Text { model: &curves, ..base };
    vec![
        Case::new("curves of an input and a parameter", &curves, IRREGULAR, 257),
        Case::new("inputs", &start, IRREGULAR, 257),
        Case::new("inputs that choose", &chosen, IRREGULAR, 257),
        Case::new("inputs, named states, pooled", &Text { objectives: named, ..start }, leading, 257),
        Case::new("inputs, x0 measured late", &Text { model: &measured, ..base }, skipped(pooled), 257),
        Case::new("searched times an input", &Text { model: &scaled, parameters: &parameters, ..base }, IRREGULAR, 257),
    ]
}

/// Rows with gaps first, so that a start from a measurement skips them.
fn skipped(shape: Shape) -> Shape {
    Shape { lengths: &[50, 12, 20], gaps: &[Gap::Leading(3), Gap::Components(0.2), Gap::Truth(0.3)], ..shape }.from(5.0)
}

fn singular() -> Vec<Case> {
    let register = "state = [\"x1\", \"x2\"]\nf = [\"a1*x1 + a2*x2\", \"x1\"]\nh = [\"x1\"]\nQ = { x1 = \"q\" }\nR = [\"r\"]\nx0 = [0, 0]\nP0 = [1, 1]";
    let parameters = format!(
        "{}\na1 = {{ min = 0.5, max = 1, start = 0.8 }}\na2 = {{ min = -0.5, max = -0.1, start = -0.3 }}",
        Text::BASIC.parameters
    );
    let register =
        Text { truth: &["x1", "x2"], model: register, parameters: &parameters, objectives: ALL, ..Text::BASIC };
    let shift = "state = [\"x1\", \"x2\", \"x3\"]\nf = [\"x1\", \"x1\", \"x2\"]\nh = [\"x1 + x2 + x3\"]\nQ = { x1 = \"q\" }\nR = [\"r\"]\nx0 = [0, 0, 0]\nP0 = [1, 2, 3]";
    let errors = r#"["nll", "mse_innovation", "mismatch", "nis", "rmse", "distance"]"#;
    let shift = Text { truth: &["x1", "x2", "x3"], model: shift, objectives: errors, ..Text::BASIC };
    let still = "state = [\"c\"]\nf = [\"c\"]\nh = [\"c\"]\nQ = [0]\nR = [\"r\"]\nx0 = [\"q\"]\nP0 = [4]";
    let still = Text { truth: &["c"], model: still, objectives: ALL, ..Text::BASIC };
    vec![
        Case::new("shift register", &register, REGULAR, 257),
        Case::new("shift register, pooled", &register, POOLED, 257),
        Case::new("singular transition", &shift, POOLED, 257),
        Case::new("zero Q", &still, REGULAR, 257),
        Case::new("zero Q, gaps", &still, POOLED, 257),
    ]
}

/// A damped chain: state i follows state i + 1; every other one is measured.
fn chain(n: usize) -> Case {
    let states: Vec<String> = (0..n).map(|i| format!("s{i}")).collect();
    let f: Vec<String> = (0..n)
        .map(|i| if i + 1 < n { format!("0.9*s{i} + 0.2*s{}", i + 1) } else { format!("0.95*s{i} + 0.1") })
        .collect();
    let h: Vec<String> = (0..n).step_by(2).map(|i| format!("s{i} - 0.5")).collect();
    let names: Vec<String> = (0..h.len()).map(|i| format!("z{i}")).collect();
    run(n, &format!("chain of {n}"), (&states, &f, &h, &names), if n > 4 { 40 } else { 257 })
}

/// Every state feeds every other, every measurement sees them all.
fn dense(n: usize) -> Case {
    let states: Vec<String> = (0..n).map(|i| format!("s{i}")).collect();
    let weight = |i: usize, j: usize| ((7 * i + 11 * j + 3) % 13) as f64 / 13.0 - 0.5;
    let row = |i: usize, scale: f64, own: f64| {
        let terms: Vec<String> =
            (0..n).map(|j| format!("{}*s{j}", scale * weight(i, j) + if i == j { own } else { 0.0 })).collect();
        terms.join(" + ")
    };
    let f: Vec<String> = (0..n).map(|i| row(i, 0.2, 0.7)).collect();
    let h: Vec<String> = (0..n / 2).map(|i| row(i + 3, 1.0, 0.5)).collect();
    let names: Vec<String> = (0..h.len()).map(|i| format!("z{i}")).collect();
    run(n, &format!("dense {n}"), (&states, &f, &h, &names), if n > 4 { 24 } else { 257 })
}

fn run(
    n: usize,
    name: &str,
    (states, f, h, names): (&[String], &[String], &[String], &[String]),
    candidates: u64,
) -> Case {
    let noise: Vec<String> = (0..n).map(|i| format!("q*{}", 1 + i % 3)).collect();
    let r = vec!["r"; h.len()];
    let model = format!(
        "state = {states:?}\nf = {f:?}\nh = {h:?}\nQ = {noise:?}\nR = {r:?}\nx0 = {:?}\nP0 = {:?}",
        vec![1; n],
        vec![4; n]
    );
    let measurements: Vec<&str> = names.iter().map(String::as_str).collect();
    let truth: Vec<&str> = states.iter().map(String::as_str).collect();
    let text = Text { measurements: &measurements, truth: &truth, model: &model, objectives: ALL, ..Text::BASIC };
    Case::new(name, &text, POOLED, candidates)
}
