//! Filters that adapt Q or R: every kind with its settings searched, over gaps, several measurements, diffuse starts,
//! trajectories of every length, and candidates that fail.

use crate::case::{ALL, Case, Double, OPTIONS, Single, Text};
use crate::logs::{Gap, Interval, Shape};

const FULL: Shape = Shape::regular(&[120]);
const GAPS: Shape = Shape::regular(&[60, 1, 40]).without(&[Gap::Components(0.25), Gap::Truth(0.1)]);
const ROWS: Shape = Shape::regular(&[90]).without(&[Gap::Rows(0.3), Gap::Leading(3)]);
const IRREGULAR: Shape = Shape::regular(&[50, 30]).every(Interval::Irregular(1.0));

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
R = ["r", "2*r"]
x0 = "measurement"
P0 = [2, 2]"#;

const CV: &str = r#"kind = "constant-velocity"
axes = ["x", "y"]
q = "q"
R = ["r", "r"]
x0 = [0, 0, 1, 1]
P0 = [10, 10, 4, 4]"#;

const SAGE_HUSA: &str = "kind = \"sage-husa\"\nforgetting = \"b\"";
const SAGE_HUSA_R: &str = "kind = \"sage-husa-r\"\nforgetting = \"b\"\nfloor = \"least\"";
const FUZZY: &str = "kind = \"fuzzy\"\nwindow = 6\ngain = \"gain\"\nwidth = \"2*half\"";

const FADING: &str = r#"b = { min = 0.9, max = 1, start = 0.98 }
least = { min = 0.05, max = 0.5, scale = "log", start = 0.1 }"#;
const RULES: &str = r#"gain = { min = 0, max = 0.15, start = 0.1 }
half = { min = 0.2, max = 1, start = 0.25 }"#;

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (kind, filter, settings) in
        [("sage-husa", SAGE_HUSA, FADING), ("sage-husa-r", SAGE_HUSA_R, FADING), ("fuzzy", FUZZY, RULES)]
    {
        let parameters = format!("{}\n{settings}", Text::BASIC.parameters);
        let base = Text { filter, parameters: &parameters, objectives: ALL, ..Text::BASIC };
        let climb = Text { truth: &["d", "v", "a"], model: CLIMB, ..base };
        let plane = Text { measurements: &["z1", "z2"], truth: &["x", "y"], model: PLANE, ..base };
        let cv = Text { measurements: &["x", "y"], truth: &["x", "y", "vx", "vy"], model: CV, ..base };
        let predict = CLIMB.replace("P0 =", "first = \"predict\"\nfirst_dt = 0.5\nP0 =");
        let high = CLIMB.replace("x0 = [10, 1, 0.2]", "x0 = [400000, 1000, 0.2]");
        let diffuse = CLIMB.replace("P0 = [5, 2, 1]", "P0 = [1e4, 1e4, 1e4]");
        let texts = [
            ("climb", climb, FULL, 257),
            ("climb, missing rows", Text { objectives: OPTIONS, ..climb }, ROWS, 65),
            ("climb, a step first", Text { model: &predict, ..climb }, GAPS, 65),
            ("climb at 400 km", Text { model: &high, ..climb }, FULL, 65),
            ("climb, diffuse", Text { model: &diffuse, ..climb }, FULL, 65),
            ("two of two, gaps", plane, GAPS, 257),
            ("cv, irregular", Text { objectives: OPTIONS, ..cv }, IRREGULAR, 65),
        ];
        for (name, text, shape, candidates) in texts {
            let case = Case::new(format!("{kind}, {name}"), &text, shape, candidates);
            // Its first samples nu^2 - H P H' are differences of numbers as large as P0.
            let lost = name == "climb, diffuse" && kind == "sage-husa-r";
            cases.push(if lost { case.single(Single::Measured).double(Double::Measured) } else { case });
        }
    }
    cases.extend([correlated(), defaults()]);
    cases.extend(sensitive());
    cases.extend(failing());
    cases
}

/// Loops that amplify rounding, which no precision holds to its promise: a floor so low that R is what two large numbers
/// leave, at last under a diffuse start, and rules so steep over a window so short that R never settles.
fn sensitive() -> Vec<Case> {
    let diffuse = CLIMB.replace("P0 = [5, 2, 1]", "P0 = [1e6, 1e6, 1e6]");
    let low = "b = { min = 0.9, max = 1, start = 0.98 }\nleast = { min = 0.001, max = 0.01, start = 0.005 }";
    let steep = "gain = { min = 0.2, max = 0.5, start = 0.3 }\nhalf = { min = 0.05, max = 0.2, start = 0.1 }";
    let cases = [
        ("sage-husa-r, low floor", SAGE_HUSA_R, CLIMB, low),
        ("sage-husa-r, low floor, diffuse", SAGE_HUSA_R, diffuse.as_str(), low),
        ("fuzzy, steep rules", FUZZY, CLIMB, steep),
    ];
    let case = |(name, filter, model, settings): (&str, _, _, &str)| {
        let parameters = format!("{}\n{settings}", Text::BASIC.parameters);
        let text =
            Text { truth: &["d", "v", "a"], filter, model, parameters: &parameters, objectives: ALL, ..Text::BASIC };
        Case::new(name, &text, FULL, 65).single(Single::Measured).double(Double::Measured)
    };
    cases.map(case).into()
}

/// The process noise adapts whatever R is.
fn correlated() -> Case {
    let parameters = format!("{}\n{FADING}", Text::BASIC.parameters);
    let model = PLANE.replace("[\"r\", \"2*r\"]", "[[\"r\"], [\"0.4*r\", \"2*r\"]]");
    let text = Text {
        measurements: &["z1", "z2"],
        truth: &["x", "y"],
        model: &model,
        filter: SAGE_HUSA,
        parameters: &parameters,
        objectives: ALL,
        ..Text::BASIC
    };
    Case::new("sage-husa, correlated R, gaps", &text, GAPS, 65)
}

/// The study's settings: nothing but R is searched.
fn defaults() -> Case {
    let text = Text {
        truth: &["d"],
        model: CLIMB,
        filter: "kind = \"fuzzy\"",
        objectives: r#"["nll", "rmse"]"#,
        ..Text::BASIC
    };
    Case::new("fuzzy, defaults", &text, FULL, 257)
}

/// Settings outside their ranges, and an R that starts negative, among good candidates.
fn failing() -> Vec<Case> {
    let level = "state = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\nQ = [0.05]\nx0 = [0]\nP0 = [1]\nR = [\"r\"]";
    let negative = level.replace("\"r\"", "\"r - 4\"");
    let r = "r = { min = 0.5, max = 9, start = 5 }";
    let cases = [
        ("forgetting", SAGE_HUSA, level, "b = { min = 0.8, max = 1.1, start = 0.98 }"),
        (
            "forgetting of R",
            SAGE_HUSA_R,
            level,
            "b = { min = -0.1, max = 1.1, start = 0.98 }\nleast = { min = -0.1, max = 1.2, start = 0.1 }",
        ),
        ("gain", FUZZY, level, "gain = { min = -0.1, max = 0.2, start = 0.1 }\nhalf = 0.25"),
        ("gain of 1", FUZZY, level, "gain = { min = 0.9, max = 1.1, start = 0.95 }\nhalf = 100"),
        ("width", FUZZY, level, "gain = 0.01\nhalf = { min = -0.5, max = 1, start = 0.3 }"),
        ("negative R", SAGE_HUSA_R, &negative, FADING),
        ("negative R, fuzzy", FUZZY, &negative, RULES),
    ];
    let case = |(name, filter, model, settings): (&str, _, &str, &str)| {
        let parameters = format!("{r}\n{settings}");
        let text = Text { filter, model, parameters: &parameters, ..Text::BASIC };
        let case = Case::new(format!("adaptive, {name} out of range"), &text, Shape::regular(&[50]), 65);
        let failed = case.reference().iter().filter(|costs| costs.is_err()).count();
        assert!(failed > 0 && failed < 65, "{}: {failed} of 65 candidates fail", case.name);
        case
    };
    cases.map(case).into()
}
