//! The `[filter]`, `[tune]` and `[simulate]` tables.

use super::{SOUND, check, error};
use crate::model::Problem;

#[test]
fn tuning() {
    check(&[
        (
            "\"kalman\"",
            "\"extended\"",
            "\"extended\"",
            "23:8: `filter.kind` names the filter `extended`, which does not exist (known: `kalman`)",
        ),
        (
            "\"pso\"",
            "\"psoo\"",
            "\"psoo\"",
            "26:13: `tune.algorithm` names the algorithm `psoo`, which does not exist: did you mean `pso`? (known: `pso`, `pso-inertia`, `pio`, `pio-printed`, `pio+`, `nsga2`, `nsga2-study`, `moma`, `moma-annealed`, `random`)",
        ),
        (
            "[\"nll\"]",
            "[\"nil\"]",
            "\"nil\"",
            "27:15: `tune.objectives[1]` names the objective `nil`, which does not exist: did you mean `nis`? (known: `nll`, `mse_innovation`, `mismatch`, `nis`, `nees`, `rmse`, `distance`)",
        ),
        (
            "[\"nll\"]",
            "[]",
            "[]",
            "27:14: `tune.objectives` has 0 entries: expected at least one objective, such as [\"nll\"]",
        ),
        (
            "[\"nll\"]",
            "[\"nll\", { name = \"nll\", skip = 1 }]",
            "{ name = \"nll\", skip = 1 }",
            "27:22: `tune.objectives[2]`: the objective `nll` is listed twice",
        ),
        (
            "[\"nll\"]",
            "[\"nees\"]",
            "\"nees\"",
            "27:15: `tune.objectives[1]`: the objective `nees` needs truth of all states, and `v` has none",
        ),
        (
            "[\"nll\"]",
            "[{ name = \"rmse\", states = [\"v\"] }]",
            "\"v\"",
            "27:42: `tune.objectives[1].states[1]`: the state `v` has no truth: give its column in data.truth",
        ),
        (
            "[\"nll\"]",
            "[{ name = \"nll\", window = 3 }]",
            "3",
            "27:40: `tune.objectives[1].window`: it does not apply to the objective `nll`: remove it",
        ),
        (
            "[\"nll\"]",
            "[{ name = \"mismatch\", ct = \"first\" }]",
            "\"first\"",
            "27:41: `tune.objectives[1].ct` is \"first\": expected \"mean\" or \"last\"",
        ),
        (
            "[\"nll\"]",
            "[\"nll\"]\nstop = { wall_time = 0 }",
            "0",
            "28:22: `tune.stop.wall_time` is 0: expected a number above 0",
        ),
    ]);
    let text = SOUND.replace("truth = { p = \"p_true\" }\n", "").replace("[\"nll\"]", "[\"distance\"]");
    let first = error(&text).to_string();
    assert!(
        first.starts_with("p.toml:26:15: `tune.objectives[1]`: the objective `distance` needs the true states"),
        "{first}"
    );
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
