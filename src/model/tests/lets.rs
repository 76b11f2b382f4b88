//! Names for formulas, `[model.let]`.

use crate::model::{Problem, ProblemError};

const TEXT: &str = r#"[data]
file = "log.csv"
measurements = ["z"]
inputs = ["u"]

[model]
state = ["p", "v"]
f = ["p + step", "drag*v + push"]
h = ["p + bias"]
Q = { v = "noise^2 * dt" }
R = ["noise"]
x0 = ["bias", 0]
P0 = ["4*noise", "noise"]

[model.let]
bias = "q / 2"       # the sensor's
noise = "bias^2 + 1"
step = "v*dt"
drag = "1 - 0.1*dt"
push = "if(u > bias, u, 0)*dt"

[parameters]
q = { min = 0.01, max = 10, start = 1 }
"#;

fn parse(text: &str) -> Result<Problem, ProblemError> {
    Problem::parse(text, "p.toml")
}

#[test]
fn names_stand_for_their_formulas() {
    let found = parse(TEXT).unwrap_or_else(|error| panic!("{error}"));
    let typed = TEXT.split("[model.let]").next().unwrap().to_owned()
        + "[parameters]"
        + TEXT.split("[parameters]").nth(1).unwrap();
    let typed = [
        "p + v*dt",
        "(1 - 0.1*dt)*v + if(u > q/2, u, 0)*dt",
        "p + q/2",
        "((q/2)^2 + 1)^2 * dt",
        "(q/2)^2 + 1",
        "q / 2",
        "4*((q/2)^2 + 1)",
        "(q/2)^2 + 1",
    ]
    .into_iter()
    .zip(["p + step", "drag*v + push", "p + bias", "noise^2 * dt", "noise", "bias", "4*noise", "noise"])
    .fold(typed, |text, (formula, named)| text.replacen(&format!("\"{named}\""), &format!("\"{formula}\""), 1));
    let typed = parse(&typed).unwrap_or_else(|error| panic!("{error}\n{typed}"));
    assert_eq!(found.model.without_spans(), typed.model.without_spans());
}

#[test]
fn a_tuned_file_keeps_them() {
    let problem = parse(TEXT).unwrap();
    assert_eq!(problem.tuned(&[2.5]), TEXT.replace("start = 1", "start = 2.5"));
}

#[test]
fn built_in_models_have_them_too() {
    let text = "[data]\nfile = \"l.csv\"\nmeasurements = [\"z\"]\n[model]\nkind = \"random-walk\"\nq = \"twice\"\nR = [\"twice\"]\nx0 = [0]\nP0 = [1]\n\
                let = { twice = \"2*r\" }\n[parameters]\nr = { min = 1, max = 2 }\n";
    let problem = parse(text).unwrap_or_else(|error| panic!("{error}"));
    assert!(problem.model.q[0].mentions(|symbol| symbol == crate::model::Symbol::Parameter(0)));
}

/// A change of the text: what is replaced, by what; the sentence with its place.
#[test]
fn mistakes_are_told_where_they_are() {
    for (old, new, sentence) in [
        (
            "\"q / 2\"",
            "\"noise / 2\"",
            "16:9: `noise` is defined further down in [model.let]: move it above what uses it",
        ),
        ("\"q / 2\"", "\"q / bias\"", "16:13: `bias` cannot be used in its own formula"),
        ("\"q / 2\"", "\"q / \"", "16:13: a formula stops short: expected a number, a name or `(`"),
        (
            "R = [\"noise\"]",
            "R = [\"1 + step\"]",
            "11:11: the state `v`, which `step` uses, cannot stand in model.R[1], which may use parameters",
        ),
        (
            "R = [\"noise\"]",
            "R = [\"drag\"]",
            "11:7: the interval `dt`, which `drag` uses, cannot stand in model.R[1], which may use parameters",
        ),
        (
            "x0 = [\"bias\"",
            "x0 = [\"push\"",
            "12:8: the input `u`, which `push` uses, cannot stand in model.x0[1], which may use parameters",
        ),
        ("\"drag*v + push\"", "\"drag*v + push*step^2\"", "8:33: `step^2` is not linear in the states"),
        ("\"drag*v + push\"", "\"drag*v + puhs\"", "8:28: unknown name `puhs`: did you mean `push`?"),
        ("bias = \"q / 2\"", "v = \"q / 2\"", "16:1: the name `v` is already a state: choose another"),
        ("bias = \"q / 2\"", "q = \"2\"", "16:1: the name `q` is already a parameter: choose another"),
        ("bias = \"q / 2\"", "u = \"2\"", "16:1: the name `u` is already an input: choose another"),
        ("bias = \"q / 2\"", "or = \"2\"", "16:1: the name `or` is already an operator: choose another"),
        (
            "bias = \"q / 2\"",
            "bias = [1]",
            "16:8: `model.let.bias`: expected a number or a formula in quotes, found a list",
        ),
    ] {
        assert_eq!(TEXT.matches(old).count(), 1, "{old}");
        let error = parse(&TEXT.replace(old, new)).expect_err(new).to_string();
        assert!(error.starts_with(&format!("p.toml:{sentence}")), "{error}\nexpected {sentence}");
    }
}

#[test]
fn what_they_stand_for_is_bounded() {
    let longer: String = (0..40).map(|i| format!("a{} = \"a{i} + 1\"\n", i + 1)).collect();
    let text = TEXT.replace("[model.let]\n", &format!("[model.let]\na0 = \"q\"\n{longer}"));
    assert!(parse(&text.replace("[\"noise\"]", "[\"a40\"]")).is_ok(), "40 operations");
    let twice: String = (0..40).map(|i| format!("a{} = \"a{i} * a{i}\"\n", i + 1)).collect();
    let error =
        parse(&TEXT.replace("[model.let]\n", &format!("[model.let]\na0 = \"q\"\n{twice}"))).unwrap_err().to_string();
    assert!(
        error.contains("the names of [model.let] stand for more than 200000 operations where they are used"),
        "{error}"
    );
    let deep: String = (0..600).map(|i| format!("a{} = \"-a{i}\"\n", i + 1)).collect();
    let error =
        parse(&TEXT.replace("[model.let]\n", &format!("[model.let]\na0 = \"q\"\n{deep}"))).unwrap_err().to_string();
    assert!(error.contains("a formula that chains more than 500 operations"), "{error}");
}
