//! The `[filter]`, `[tune]` and `[simulate]` tables.

use super::{SOUND, broken, error};
use crate::model::Problem;
use crate::optimize::ALGORITHMS;

#[test]
fn an_unknown_algorithm_is_answered_with_the_registry() {
    let known: Vec<String> = ALGORITHMS.iter().map(|row| format!("`{}`", row.name)).collect();
    let sentence = format!(
        "p.toml:26:13: `tune.algorithm` names the algorithm `psoo`, which does not exist: did you mean `pso`? (known: {})",
        known.join(", ")
    );
    assert_eq!(broken("\"pso\"", "\"psoo\""), (sentence, "\"psoo\"".to_owned()));
}

#[test]
fn objectives_of_truth_need_it() {
    let text = SOUND.replace("truth = { p = \"p_true\" }\n", "").replace("[\"nll\"]", "[\"distance\"]");
    let first = error(&text).to_string();
    assert!(
        first.starts_with("p.toml:26:15: `tune.objectives[1]`: the objective `distance` needs the true states"),
        "{first}"
    );
}

#[test]
fn options_of_objectives_have_their_ranges() {
    for (objective, message) in [
        ("{ name = \"whiteness\", lags = 0 }", "`tune.objectives[1].lags` is 0: expected a whole number from 1 to 64"),
        (
            "{ name = \"prediction\", ahead = 65 }",
            "`tune.objectives[1].ahead` is 65: expected a whole number from 1 to 64",
        ),
        (
            "{ name = \"prediction\", ahead = [5, 5] }",
            "`tune.objectives[1].ahead[2]`: 5 rows ahead are listed twice: remove one",
        ),
        ("{ name = \"prediction\", ahead = [] }", "at least one number of rows, such as [1, 5]"),
        (
            "{ name = \"nll\", lags = 5 }",
            "`tune.objectives[1].lags`: it does not apply to the objective `nll`: remove it",
        ),
    ] {
        let first = error(&SOUND.replace("\"nll\"", objective)).to_string();
        assert!(first.contains(message), "{first}");
    }
}

#[test]
fn simulation() {
    let text = |simulate: &str| {
        let text = SOUND.replace("inputs = [\"u\"]\n", "").replace("+ 0.5*u*dt^2", "").replace("+ u*dt", "");
        format!("{text}[simulate]\n{simulate}\n")
    };
    Problem::parse(&text("steps = 10\nQ = 0\nx0 = [1, 2]\nparameters = { r = 3 }"), "p.toml").unwrap();
    for (simulate, message) in [
        ("dt = 1", "28:1: [simulate] lacks `steps`: give the number of rows after row 0"),
        ("steps = 10\nmissing = 1", "30:11: `simulate.missing` is 1: expected a share from 0 to below 1"),
        (
            "steps = 10\nparameters = { s = 3 }",
            "30:16: `simulate.parameters` names the searched parameter `s`, which does not exist (known: `q`, `r`)",
        ),
        ("steps = 10\nx0 = [1]", "30:6: `simulate.x0` has 1 entry: expected 2, one per state (p, v)"),
        ("steps = 10\nQ = 1", "30:5: `simulate.Q`: expected a list of 2 variances"),
    ] {
        let first = error(&text(simulate)).to_string();
        assert!(first.starts_with(&format!("p.toml:{message}")), "{first}");
    }
}
