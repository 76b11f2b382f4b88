//! Interacting multiple models: two to four of them, linear or not, of one size or several, with chains of every form, over
//! gaps and irregular intervals, with modes that are ruled out, and with candidates whose chain is none.

use crate::case::{ALL, Case, INNOVATIONS, OPTIONS, Text};
use crate::logs::{Gap, Interval, Shape};

const FULL: Shape = Shape::regular(&[120]);
const GAPS: Shape = Shape::regular(&[60, 1, 40]).without(&[Gap::Components(0.25), Gap::Truth(0.1)]);
const ROWS: Shape = Shape::regular(&[90]).without(&[Gap::Rows(0.3), Gap::Leading(3)]);
const IRREGULAR: Shape = Shape::regular(&[50, 30]).every(Interval::Irregular(1.0));

const LINE: &str = r#"state = ["p", "v"]
f = ["p + v*dt", "v"]
h = ["p"]
R = ["r"]
x0 = [0, 1]
P0 = [4, 1]"#;

const TWO_NOISES: &str = r#"kind = "imm"
stay = "stay"
[[mode]]
name = "calm"
Q = [0, "q"]
[[mode]]
name = "wild"
Q = [0, "30*q"]"#;

const STAY: &str = r#"stay = { min = 0.6, max = 0.99, start = 0.9 }"#;

const PLANE: &str = r#"state = ["x", "y", "vx", "vy"]
f = ["x + vx*dt", "y + vy*dt", "vx", "vy"]
h = ["x", "y"]
Q = { vx = "q*dt", vy = "q*dt" }
R = ["r", "2*r"]
x0 = [0, 0, 3, 1]
P0 = [9, 9, 2, 2]"#;

const TURNS: &str = r#"
[[mode]]
name = "straight"
[[mode]]
name = "left"
f = ["x + vx*dt", "y + vy*dt", "cos(0.2*dt)*vx - sin(0.2*dt)*vy", "sin(0.2*dt)*vx + cos(0.2*dt)*vy"]
[[mode]]
name = "right"
f = ["x + vx*dt", "y + vy*dt", "cos(w*dt)*vx + sin(w*dt)*vy", "cos(w*dt)*vy - sin(w*dt)*vx"]"#;

const RATE: &str = r#"w = { min = 0.1, max = 0.3, start = 0.2 }"#;

pub(crate) fn cases() -> Vec<Case> {
    let parameters = format!("{}\n{STAY}\n{RATE}", Text::BASIC.parameters);
    let base = Text { parameters: &parameters, objectives: ALL, ..Text::BASIC };
    let line = Text { truth: &["p", "v"], model: LINE, filter: TWO_NOISES, ..base };
    let predict = LINE.replace("x0 =", "first = \"predict\"\nfirst_dt = 0.5\nx0 =");
    let far = LINE.replace("x0 = [0, 1]", "x0 = [400000, 1]");
    let measured = LINE.replace("x0 = [0, 1]", "x0 = \"measurement\"");
    let sojourn = TWO_NOISES.replace("stay = \"stay\"", "sojourn = [\"20*stay\", 6]\nstart = [0.9, 0.1]");
    let plane = Text { measurements: &["x", "y"], truth: &["x", "y", "vx", "vy"], model: PLANE, ..base };
    let turns =
        format!("kind = \"imm\"\ntransition = [[0.9, 0.05, 0.05], [\"1 - stay\", \"stay\", 0], [0.2, 0, 0.8]]{TURNS}");
    let correlated = PLANE.replace("R = [\"r\", \"2*r\"]", "R = [[\"r\", \"0.4*r\"], [\"0.4*r\", \"2*r\"]]");
    let texts = [
        ("two noises", line, FULL, 257),
        ("two noises, missing rows", Text { objectives: OPTIONS, ..line }, ROWS, 65),
        ("two noises, gaps", line, GAPS, 65),
        ("two noises, a step first", Text { model: &predict, ..line }, GAPS, 65),
        ("two noises, from a measurement", Text { model: &measured, ..line }, GAPS, 65),
        ("two noises at 400 km", Text { model: &far, ..line }, FULL, 65),
        ("two noises, sojourn", Text { filter: &sojourn, ..line }, IRREGULAR, 65),
        ("turns", Text { filter: &turns, ..plane }, FULL, 257),
        ("turns, gaps", Text { filter: &turns, objectives: OPTIONS, ..plane }, GAPS, 65),
        ("turns, correlated", Text { model: &correlated, filter: &turns, ..plane }, GAPS, 65),
    ];
    let case = |(name, text, shape, candidates)| Case::new(format!("imm, {name}"), &text, shape, candidates);
    let mut cases: Vec<Case> = texts.map(case).into();
    cases.extend(curved(base));
    cases.extend([masked(base), sizes(base), leaving()]);
    cases
}

/// Range and bearing from a place beside the track, by tangents and by points.
fn curved(base: Text<'_>) -> [Case; 2] {
    let model = PLANE
        .replace(
            "h = [\"x\", \"y\"]",
            "h = [\"sqrt((x + 40)^2 + (y + 60)^2)\", \"atan2(y + 60, x + 40)\"]\nangle = [\"bearing\"]",
        )
        .replace("R = [\"r\", \"2*r\"]", "R = [\"r\", \"1e-4*r\"]");
    let seen = Text { measurements: &["range", "bearing"], truth: &["x", "y", "vx", "vy"], model: &model, ..base };
    let tangents = format!("kind = \"imm\"\nstay = [\"stay\", 0.9, 0.8]{TURNS}");
    let points = tangents.replace("name = \"left\"", "name = \"left\"\nfilter = \"unscented\"\nbeta = 1.5");
    [
        Case::new("imm, range and bearing", &Text { filter: &tangents, ..seen }, FULL, 65),
        Case::new("imm, range and bearing, one by points", &Text { filter: &points, ..seen }, GAPS, 65),
    ]
}

/// A mode that an input rules out, and one that a parameter does.
fn masked(base: Text<'_>) -> Case {
    let filter = TWO_NOISES.replace("name = \"wild\"", "name = \"wild\"\nallowed = \"u + 0.4*stay\"");
    let text = Text { inputs: &["u"], truth: &["p", "v"], model: LINE, filter: &filter, ..base };
    Case::new("imm, a mode that is ruled out at times", &text, GAPS, 65)
}

/// A mode that has no acceleration.
fn sizes(base: Text<'_>) -> Case {
    let model = r#"state = ["p", "v", "a"]
f = ["p + v*dt + 0.5*a*dt^2", "v + a*dt", "0.9*a"]
h = ["p"]
Q = { a = "q" }
R = ["r"]
x0 = [0, 1, 0]
P0 = [4, 1, 0.5]"#;
    let filter = "kind = \"imm\"\nstay = \"stay\"\n[[mode]]\nname = \"pushed\"\n[[mode]]\nname = \"free\"\n\
                  state = [\"place\", \"speed\"]\nmap = [\"p\", \"v\"]\nf = [\"place + speed*dt\", \"speed\"]\nh = [\"place\"]\n\
                  Q = { speed = \"0.1*q\" }";
    Case::new("imm, modes of several sizes", &Text { truth: &["p", "v", "a"], model, filter, ..base }, FULL, 65)
}

/// Rows whose parameters leave the simplex.
fn leaving() -> Case {
    let filter = "kind = \"imm\"\ntransition = [[\"a\", \"b\", \"1 - a - b\"], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]\n\
                  [[mode]]\nname = \"calm\"\nQ = [0, 0.05]\n[[mode]]\nname = \"rough\"\nQ = [0, 0.5]\n[[mode]]\nname = \"wild\"\n\
                  Q = [0, 5]";
    let parameters = "a = { min = 0, max = 1, start = 0.8 }\nb = { min = 0, max = 1, start = 0.1 }\n\
                      r = { min = 0.5, max = 20, scale = \"log\", start = 2 }";
    let text = Text { model: LINE, filter, parameters, objectives: INNOVATIONS, ..Text::BASIC };
    Case::new("imm, chains that are none", &text, FULL, 257)
}
