//! Formulas and built-in models.

use super::{SOUND, broken, check, error};

#[test]
fn formulas() {
    check(&[
        (
            "\"v + u*dt\"",
            "\"v + u*dtt\"",
            "dtt",
            "10:38: unknown name `dtt`: did you mean `dt`? (known: `p`, `v`, `q`, `r`, `u`, `dt`, `pi`)",
        ),
        ("\"v + u*dt\"", "\"v + (u*dt\"", "\"", "10:41: a formula stops short: expected `)` or an operator"),
        ("\"v + u*dt\"", "'v + u**dt'", "*", "10:38: a formula has `*` where a number, a name or `(` was expected"),
        (
            "\"v + u*dt\"",
            "\"\"\"\nv + w\"\"\"",
            "w",
            "11:5: unknown name `w` (known: `p`, `v`, `q`, `r`, `u`, `dt`, `pi`)",
        ),
        (
            "\"v + u*dt\"",
            "\"v +\\tw\"",
            "\"v +\\tw\"",
            "10:31: unknown name `w` (known: `p`, `v`, `q`, `r`, `u`, `dt`, `pi`)",
        ),
        (
            "\"v + u*dt\"",
            "\"v + u*dt*cos(p)\"",
            "cos(p)",
            "10:41: `cos(p)` is not linear in the states, and the kalman filter needs model.f[2] to be linear (sums of states times parameters, inputs and dt; other filters come later)",
        ),
        (
            "\"v + u*dt\"",
            "\"v + (p*v)\"",
            "(p*v)",
            "10:36: `(p*v)` is not linear in the states, and the kalman filter needs model.f[2] to be linear (sums of states times parameters, inputs and dt; other filters come later)",
        ),
        (
            "h = [\"p\"]",
            "h = [\"p*dt\"]",
            "dt",
            "11:9: the interval `dt` cannot stand in model.h[1], which may use states, inputs and parameters",
        ),
        (
            "\"q*dt\"",
            "\"q*v\"",
            "v",
            "12:39: the state `v` cannot stand in model.Q[2][2], which may use parameters and dt",
        ),
        (
            "x0 = [0, 0]",
            "x0 = [0, \"u\"]",
            "u",
            "14:11: the input `u` cannot stand in model.x0[2], which may use parameters",
        ),
        (
            "x0 = [0, 0]",
            "x0 = [0, true]",
            "true",
            "14:10: `model.x0[2]`: expected a number or a formula in quotes, found true",
        ),
        ("x0 = [0, 0]", "x0 = [0]", "[0]", "14:6: `model.x0` has 1 entry: expected 2, one per state (p, v)"),
        ("x0 = [0, 0]", "x0 = [0, inf]", "inf", "14:10: `model.x0[2]` is inf: expected a finite number"),
        (
            "h = [\"p\"]",
            "h = [\"p\", \"v\"]",
            "[\"p\", \"v\"]",
            "11:5: `model.h` has 2 entries: expected 1, one per measurement (z)",
        ),
    ]);
}

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
