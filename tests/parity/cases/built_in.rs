//! Every built-in model, on 1 to 3 axes, with both kinds of noise, over log shapes and starts in turn.

use crate::case::{ALL, Case, OPTIONS, Text};
use crate::logs::{Gap, Interval, Shape};

/// Kind, state prefixes, keys of the noise strengths.
const KINDS: [(&str, &[&str], &[&str]); 5] = [
    ("local-level", &[""], &["q"]),
    ("local-linear-trend", &["", "slope_"], &["q_level", "q_slope"]),
    ("random-walk", &[""], &["q"]),
    ("constant-velocity", &["", "v"], &["q"]),
    ("constant-acceleration", &["", "v", "a"], &["q"]),
];

const SHAPES: [Shape; 7] = [
    Shape::regular(&[100]),
    Shape::regular(&[100]).every(Interval::Regular(0.1)),
    Shape::regular(&[100]).every(Interval::Irregular(1.0)),
    Shape::regular(&[60, 1, 25]),
    Shape::regular(&[100]).without(&[Gap::Components(0.2), Gap::Truth(0.1)]),
    Shape::regular(&[80]).every(Interval::Irregular(0.5)).without(&[Gap::Rows(0.3), Gap::Leading(4)]),
    Shape::regular(&[40, 30]).without(&[Gap::Component { component: 0, trajectory: 1 }, Gap::Components(0.05)]),
];

const STARTS: [&str; 4] = [
    "x0 = ZERO",
    "x0 = ZERO\nfirst = \"predict\"\nfirst_dt = 0.7",
    "x0 = \"measurement\"",
    "x0 = ZERO\nfirst = \"predict\"",
];

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for kind in KINDS {
        for axes in 1..=3 {
            for noise in ["continuous", "piecewise"] {
                cases.push(case(kind, axes, noise, cases.len()));
            }
        }
    }
    cases
}

fn case((kind, prefixes, strengths): (&str, &[&str], &[&str]), axes: usize, noise: &str, turn: usize) -> Case {
    let names = &["x", "y", "z"][..axes];
    let states: Vec<String> = prefixes.iter().flat_map(|p| names.iter().map(move |a| format!("{p}{a}"))).collect();
    let shape = SHAPES[turn % SHAPES.len()];
    let irregular = matches!(shape.interval, Interval::Irregular(_));
    let no_start = shape.gaps.iter().any(|g| matches!(g, Gap::Component { .. }));
    let mut start = STARTS[turn % STARTS.len()];
    // A default first_dt needs regular intervals, and a start from a measurement a complete one.
    if (irregular && turn % 4 == 3) || (no_start && turn % 4 == 2) {
        start = STARTS[1];
    }
    let zeros = format!("{:?}", vec![0; states.len()]);
    // Each axis its own noise on every other model; one for all, so that axes merge, on the rest.
    let own = turn.is_multiple_of(2) && axes > 1;
    let r: Vec<String> = (0..axes).map(|i| if own && i == 0 { "2*r".to_owned() } else { "r".to_owned() }).collect();
    let q: Vec<String> = strengths.iter().map(|key| format!("{key} = \"q\"")).collect();
    let model = format!(
        "kind = \"{kind}\"\naxes = {names:?}\nnoise = \"{noise}\"\n{}\nR = {r:?}\nP0 = {:?}\n{}",
        q.join("\n"),
        vec![10; states.len()],
        start.replace("ZERO", &zeros)
    );
    let truth: Vec<&str> = states.iter().map(String::as_str).collect();
    let objectives = if turn.is_multiple_of(3) { OPTIONS } else { ALL };
    let text = Text { measurements: names, truth: &truth, model: &model, objectives, ..Text::BASIC };
    let candidates = if axes == 1 { 257 } else { 40 };
    Case::new(format!("{kind} {axes} {noise} shape {} start {}", turn % 7, turn % 4), &text, shape, candidates)
}
