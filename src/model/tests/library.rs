//! Built-in models and sensors in problem files: what they stand for, and what is refused.

use crate::model::Problem;

/// A turning target, seen by a radar.
const TURN: &str = r#"[data]
file = "log.csv"
measurements = ["range", "bearing"]
inputs = ["ox", "oy"]
[model]
kind = "coordinated-turn"
axes = ["x", "y"]
h = "range-bearing"
at = ["ox", "oy - 3"]
q = "q"
q_rate = 0.1
R = [1, 2]
x0 = [0, 1, 2, 3, 4]
P0 = [1, 1, 1, 1, 1]
[filter]
kind = "extended"
[parameters]
q = { min = 1, max = 2 }
"#;

fn parse(text: &str) -> Problem {
    Problem::parse(text, "p.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The same model with `h` typed.
fn typed(text: &str, from: &str, to: &str) {
    let (named, typed) = (parse(text).model, parse(&text.replace(from, to)).model);
    assert_eq!(named.without_spans(), typed.without_spans(), "{to}");
}

#[test]
fn sensors_stand_for_formulas() {
    let named = "h = \"range-bearing\"\nat = [\"ox\", \"oy - 3\"]";
    let r = "sqrt((x - ox)^2 + (y - (oy - 3))^2)";
    typed(TURN, named, &format!("h = [\"{r}\", \"atan2(y - (oy - 3), x - ox)\"]\nangle = [\"bearing\"]"));
    let text = TURN.replace(named, "h = \"range-rate\"\nvelocity = [\"ox\", 0]");
    let rate = "(x*(vx - ox) + y*(vy - 0))/sqrt(x^2 + y^2)";
    typed(&text, "h = \"range-rate\"\nvelocity = [\"ox\", 0]", &format!("h = [\"sqrt(x^2 + y^2)\", \"{rate}\"]"));
    let text = TURN.replace(named, "h = \"ranges\"\nat = [[1, 2], [\"ox\", \"oy\"]]");
    typed(
        &text,
        "h = \"ranges\"\nat = [[1, 2], [\"ox\", \"oy\"]]",
        "h = [\"sqrt((x - 1)^2 + (y - 2)^2)\", \"sqrt((x - ox)^2 + (y - oy)^2)\"]",
    );
    let space = TURN
        .replace("coordinated-turn", "constant-velocity")
        .replace("[\"x\", \"y\"]\nh", "[\"e\", \"n\", \"u\"]\nh")
        .replace("q_rate = 0.1\n", "")
        .replace("\"bearing\"]", "\"bearing\", \"elevation\"]")
        .replace("R = [1, 2]", "R = [1, 2, 3]")
        .replace("[0, 1, 2, 3, 4]", "[0, 1, 2, 3, 4, 5]")
        .replace("[1, 1, 1, 1, 1]", "[1, 1, 1, 1, 1, 1]")
        .replace(named, "h = \"range-bearing-elevation\"");
    let h = "h = [\"sqrt(e^2 + n^2 + u^2)\", \"atan2(n, e)\", \"atan2(u, sqrt(e^2 + n^2))\"]";
    typed(&space, "h = \"range-bearing-elevation\"", &format!("{h}\nangle = [\"bearing\", \"elevation\"]"));
    let one = |sensor: &str| {
        TURN.replace("[\"range\", \"bearing\"]", "[\"z\"]")
            .replace("R = [1, 2]", "R = [1]")
            .replace("range-bearing", sensor)
            .replace("at = [\"ox\", \"oy - 3\"]\n", "")
    };
    typed(&one("range"), "h = \"range\"", "h = [\"sqrt(x^2 + y^2)\"]");
    typed(&one("bearing"), "h = \"bearing\"", "h = [\"atan2(y, x)\"]\nangle = [\"z\"]");
}

#[test]
fn sensors_of_typed_models_see_what_is_named_as_places_are() {
    let text = r#"[data]
file = "log.csv"
[[sensor]]
name = "near"
measurements = ["r0", "r1"]
h = "ranges"
at = [[0, 0], [10, "b"]]
R = [1, 1]
[[sensor]]
name = "far"
measurements = ["bearing"]
h = "bearing"
at = [5, 5]
R = [1]
[model]
state = ["px", "y"]
f = ["px", "y"]
Q = [1, 1]
x0 = [1, 1]
P0 = [1, 1]
[model.let]
x = "px + 2"
[filter]
kind = "unscented"
[parameters]
b = { min = 0, max = 9 }
"#;
    let problem = parse(text);
    assert_eq!(problem.model.angles.measurements, [2]);
    typed(text, "h = \"bearing\"\nat = [5, 5]", "h = [\"atan2(y - 5, x - 5)\"]\nangle = [\"bearing\"]");
}

#[test]
fn motion_says_its_angles_and_takes_inputs_by_their_names() {
    let text = r#"[data]
file = "log.csv"
measurements = ["e", "n"]
inputs = ["ds", "turned"]
[model]
kind = "unicycle"
dth = "scale*turned"
q = 1
q_heading = 2
R = [1, 1]
x0 = [0, 0, 0]
P0 = [1, 1, 1]
[filter]
kind = "extended"
[parameters]
scale = { min = 0.5, max = 2 }
"#;
    let model = parse(text).model;
    assert_eq!(model.states, ["heading", "e", "n"]);
    assert_eq!(model.angles.states, [0]);
    let typed = text.replace(
        "kind = \"unicycle\"\ndth = \"scale*turned\"\nq = 1\nq_heading = 2",
        concat!(
            "state = [\"heading\", \"e\", \"n\"]\nangle = [\"heading\"]\nh = [\"e\", \"n\"]\n",
            "f = [\"heading + scale*turned\", \"e + ds*cos(heading + scale*turned/2)\", ",
            "\"n + ds*sin(heading + scale*turned/2)\"]\nQ = [\"2*dt\", \"1*dt\", \"1*dt\"]"
        ),
    );
    let typed = crate::model::Model { kind: Some("unicycle"), ..parse(&typed).model.without_spans() };
    assert_eq!(model.without_spans(), typed);
    let sentence =
        Problem::parse(&text.replace("\"ds\", \"turned\"", "\"s\", \"turned\""), "p.toml").unwrap_err().to_string();
    let expected = "p.toml:5:1: [model] lacks `ds`: give the distance of each step, a formula of inputs and parameters, or call \
                    an input `ds`";
    assert!(sentence.starts_with(expected), "{sentence}");
}

#[test]
fn mistakes_are_said_where_they_are() {
    let at = "at = [\"ox\", \"oy - 3\"]\n";
    let mut wrong = Vec::new();
    for (from, to, expected) in [
        (
            "range-bearing\"",
            "range-baering\"",
            "8:5: `model.h` is \"range-baering\": expected a list of formulas, or the name of a sensor (\"range\", \"bearing\", \"range-bearing\", \"range-bearing-elevation\", \"range-rate\", \"ranges\"); did you mean \"range-bearing\"?",
        ),
        (
            "range-bearing\"",
            "bearing\"",
            "8:5: `model.h`: a sensor \"bearing\" measures 1 number, and there are 2 (range, bearing)",
        ),
        (
            "range-bearing\"",
            "range-bearing-elevation\"",
            "8:5: `model.h`: a sensor \"range-bearing-elevation\" needs positions in 3 axes or more: call states or names of [model.let] `x`, `y`, `z`, take a built-in model that has them, or type formulas",
        ),
        ("h = \"range-bearing\"", "h = [\"x\", \"y\"]", "9:6: `model.at`: it belongs to an `h` that names a sensor"),
        ("\"oy - 3\"]", "\"oy\", 1]", "9:6: `model.at` has 3 entries: expected 2, one per axis (x, y)"),
        ("\"oy - 3\"", "\"oz\"", "9:14: unknown name `oz`"),
        (
            at,
            "velocity = [0, 0]\n",
            "9:12: `model.velocity`: a sensor \"range-bearing\" measures no velocity: remove it",
        ),
        ("range-bearing\"", "ranges\"", "9:7: `model.at[1]`: expected a list of formulas, found the string \"ox\""),
        (
            "\"extended\"",
            "\"kalman\"",
            "6:8: `\"coordinated-turn\"` is not linear in the states, and the kalman filter needs model.kind to be linear",
        ),
        (
            "axes = [\"x\", \"y\"]\n",
            "",
            "5:1: [model] lacks `axes`: give the names of its axes, such as [\"x\", \"y\"], which `h` does not tell",
        ),
        ("[\"x\", \"y\"]\nh", "[\"x\"]\nh", "7:8: `model.axes` has 1 entry: expected 2"),
        (
            "q = \"q\"",
            "q = \"q\"\nrate = 1",
            "12:10: `model.q_rate`: it is the noise of a rate that is estimated: remove it or `rate`",
        ),
        (
            "q_rate = 0.1",
            "rate = \"vx\"",
            "11:8: `model.rate`: the turn rate is known, a formula of inputs, parameters and dt without states",
        ),
        (
            "q_rate = 0.1\n",
            "",
            "5:1: [model] lacks `q_rate`: give a number or a formula: a setting of this built-in model",
        ),
    ] {
        assert!(TURN.contains(from), "{from}");
        let sentence = Problem::parse(&TURN.replacen(from, to, 1), "p.toml").expect_err(to).to_string();
        if !sentence.starts_with(&format!("p.toml:{expected}")) {
            wrong.push(format!("{to}: {sentence}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // The sensor is what is not linear, where the motion is.
    let linear = TURN
        .replace("q_rate = 0.1\n", "rate = 0.2\n")
        .replace("[0, 1, 2, 3, 4]", "[1, 2, 3, 4]")
        .replace("[1, 1, 1, 1, 1]", "[1, 1, 1, 1]");
    parse(&linear);
    let sentence = Problem::parse(&linear.replace("\"extended\"", "\"kalman\""), "p.toml").unwrap_err().to_string();
    let expected =
        "p.toml:8:5: `\"range-bearing\"` is not linear in the states, and the kalman filter needs model.h to be linear";
    assert!(sentence.starts_with(expected), "{sentence}");
    let singer = |keys: &str| {
        let text = linear.replace("coordinated-turn", "singer").replace("rate = 0.2\n", keys);
        Problem::parse(&text, "p.toml").map(|_| String::new()).unwrap_or_else(|e| e.to_string())
    };
    let both = singer("alpha = 1\ntau = 1\n");
    assert!(both.contains("`model.tau`: it is 1 / `alpha`, which is given too: remove one of them"), "{both}");
    let noise = singer("alpha = 1\nnoise = \"continuous\"\n");
    assert!(noise.contains("`q` of a singer model is the variance of its acceleration: remove `noise`"), "{noise}");
}
