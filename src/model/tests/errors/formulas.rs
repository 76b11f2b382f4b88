//! Formulas and built-in models.

use super::{SOUND, broken, error};

#[test]
fn absurd_formulas() {
    for (formula, message) in [
        (
            format!("{}v{}", "(".repeat(100_000), ")".repeat(100_000)),
            "a formula of 200001 characters: at most 10000 are allowed",
        ),
        (
            format!("{}v", "(".repeat(9_000)),
            "a formula nested more than 100 deep (parentheses, calls, signs and powers count)",
        ),
        (
            format!("v{}", "+v".repeat(4_000)),
            "a formula that chains more than 500 operations: split it with parentheses",
        ),
        ("v".repeat(1_000_000), "a formula of 1000000 characters: at most 10000 are allowed"),
    ] {
        let (sentence, _) = broken("\"v + u*dt\"", &format!("\"{formula}\""));
        assert!(sentence.ends_with(message), "{sentence}");
        assert!(sentence.starts_with("p.toml:10:"), "{sentence}");
    }
    let error = error(&SOUND.replace("v + u*dt", &"v".repeat(5_000_000)));
    assert!(error.to_string().contains("bytes, and at most 4194304 are read"), "{error}");
}

#[test]
fn built_in_models() {
    let text = |model: &str| {
        format!(
            "[data]\nfile = \"l.csv\"\nmeasurements = [\"x\", \"y\"]\n[model]\n{model}\nR = [1, 1]\nx0 = \"measurement\"\n"
        )
    };
    for (model, message) in [
        (
            "kind = \"constant-velocty\"",
            "5:8: `model.kind` names the built-in model `constant-velocty`, which does not exist: did you mean `constant-velocity`?",
        ),
        ("kind = \"random-walk\"\nf = [\"x\"]", "6:1: unknown key `f` in [model]"),
        ("kind = \"random-walk\"\nP0 = [1, 1]", "4:1: [model] lacks `q`: give the strength of its process noise"),
        (
            "kind = \"random-walk\"\nq = [1, 2, 3]\nP0 = [1, 1]",
            "6:5: `model.q` has 3 entries: expected 2, one per axis (x, y)",
        ),
        (
            "kind = \"random-walk\"\nq = 1\naxes = [\"a\"]\nP0 = [1, 1]",
            "7:8: `model.axes` has 1 entry: expected 2, one per measurement (x, y)",
        ),
        (
            "kind = \"random-walk\"\nq = 1\nnoise = \"pink\"\nP0 = [1, 1]",
            "7:9: `model.noise` is \"pink\": expected \"continuous\" or \"piecewise\"",
        ),
        (
            "kind = \"constant-velocity\"\nq = 1\naxes = [\"x\", \"vx\"]\nP0 = [1]",
            "7:8: the name `vx` is already a state: choose another",
        ),
    ] {
        let first = error(&text(model)).to_string();
        assert!(first.starts_with(&format!("p.toml:{message}")), "{first}");
    }
}

#[test]
fn a_step_before_the_first_row_and_a_measured_start_exclude_each_other() {
    let text = SOUND.replace("inputs = [\"u\"]\n", "").replace("+ 0.5*u*dt^2", "").replace("+ u*dt", "");
    let text = text.replace("x0 = [0, 0]", "x0 = \"measurement\"").replace("\"update\"", "\"predict\"");
    let first = error(&text).to_string();
    assert!(first.contains("15:9: `model.first`: \"predict\" cannot go with x0 = \"measurement\""), "{first}");
}
