//! `[tune] constraints` and `pick`.

use super::{SOUND, check};
use crate::model::{Pick, Problem};
use crate::objective::{Kind, Relation};

/// The objectives of the sound problem with a line behind them.
fn with(line: &str) -> String {
    format!("[\"nll\"]\n{line}")
}

/// Checks lines behind the objectives of the sound problem: what is underlined, and what is said.
fn refused(cases: &[(&str, &str, &str)]) {
    let lines: Vec<(String, &str, &str)> =
        cases.iter().map(|(line, under, said)| (with(line), *under, *said)).collect();
    let cases: Vec<(&str, &str, &str, &str)> =
        lines.iter().map(|(line, under, said)| ("[\"nll\"]", line.as_str(), *under, *said)).collect();
    check(&cases);
}

#[test]
fn constraints_say_where_they_are_wrong() {
    let cases = [
        (
            "constraints = \"nis_mean\"",
            "\"nis_mean\"",
            "28:15: `tune.constraints`: expected a list of constraints, such as [\"nis_mean <= 1.2\"], found the string \"nis_mean\"",
        ),
        (
            "constraints = [\"nis_mean < 1.2\"]",
            "<",
            "28:26: `tune.constraints[1]` is `<`: expected <= or >= between the name and the limit",
        ),
        (
            "constraints = [\"nis <= 1\", \"nis_mean == 1\"]",
            "==",
            "28:38: `tune.constraints[2]` is `==`: expected <= or >= between the name and the limit",
        ),
        (
            "constraints = [\"nis_men <= 1.2\"]",
            "nis_men",
            "28:17: `tune.constraints[1]` names the measure `nis_men`, which does not exist: did you mean `nis_mean`? (known: `nll`, `mse_innovation`, `mismatch`, `nis`, `nees`, `rmse`, `distance`, `nis_mean`, `nees_mean`)",
        ),
        (
            "constraints = [\"nis_mean <= 1,2\"]",
            "1,2",
            "28:29: `tune.constraints[1]` is limited by `1,2`: expected a finite number after <= or >=",
        ),
        (
            "constraints = [\"nis_mean <= inf\"]",
            "inf",
            "28:29: `tune.constraints[1]` is limited by `inf`: expected a finite number after <= or >=",
        ),
        (
            "constraints = [\"nis_mean <= \"]",
            "\"nis_mean <= \"",
            "28:16: `tune.constraints[1]` is limited by ``: expected a finite number after <= or >=",
        ),
        (
            "constraints = [\"1.2\"]",
            "\"1.2\"",
            "28:16: `tune.constraints[1]` is \"1.2\": expected a name, <= or >=, and a number, such as \"nis_mean <= 1.2\" or \"0.8 <= nis_mean <= 1.2\", or a table with `name` and `max` or `min`",
        ),
        (
            "constraints = [\"nees_mean <= 1\"]",
            "\"nees_mean <= 1\"",
            "28:16: `tune.constraints[1]`: the constraint on `nees_mean` needs truth of all states, and `v` has none",
        ),
        (
            "constraints = [{ name = \"rmse\" }]",
            "{ name = \"rmse\" }",
            "28:16: [tune.constraints[1]] lacks `max`: give the largest value allowed (or `min`, the smallest)",
        ),
        (
            "constraints = [{ name = \"nis\", max = 1, window = 3 }]",
            "3",
            "28:50: `tune.constraints[1].window`: it does not apply to the objective `nis`: remove it",
        ),
        (
            "constraints = [{ name = \"nis\", maxi = 1 }]",
            "maxi",
            "28:32: unknown key `maxi` in [tune.constraints[1]]: did you mean `max`? (known: `name`, `max`, `min`, `states`, `skip`, `window`, `ct`)",
        ),
    ];
    refused(&cases);
}

#[test]
fn constraints_are_read_in_both_forms() {
    let line =
        "constraints = [\" nis_mean>=0.5\", { name = \"rmse\", states = [\"p\"], skip = 2, min = 1, max = 5e0 }]";
    let problem = Problem::parse(&SOUND.replace("[\"nll\"]", &with(line)), "p.toml").unwrap();
    let found = &problem.tune.constraints;
    let parts: Vec<_> = found.iter().map(|c| (c.measure.kind, c.relation, c.limit, c.measure.skip)).collect();
    let expected = [
        (Kind::NisMean, Relation::AtLeast, 0.5, 0),
        (Kind::Rmse, Relation::AtMost, 5.0, 2),
        (Kind::Rmse, Relation::AtLeast, 1.0, 2),
    ];
    assert_eq!(parts, expected);
    assert_eq!(found[1].measure.states, [0]);
    let scorers: Vec<&str> = problem.tune.scorers().iter().map(|o| o.name()).collect();
    assert_eq!(scorers, ["nll", "nis_mean", "rmse", "rmse"]);
}

#[test]
fn constraints_from_both_sides_say_where_they_are_wrong() {
    refused(&[
        (
            "constraints = [\"1.2 <= nis_mean <= 0.8\"]",
            "\"1.2 <= nis_mean <= 0.8\"",
            "28:16: `tune.constraints[1]` is \"1.2 <= nis_mean <= 0.8\": expected a smaller and a larger number around the name, such as \"0.8 <= nis_mean <= 1.2\"",
        ),
        (
            "constraints = [\"0.8 <= nis_mean >= 0.5\"]",
            "\"0.8 <= nis_mean >= 0.5\"",
            "28:16: `tune.constraints[1]` is \"0.8 <= nis_mean >= 0.5\": expected a smaller and a larger number around the name, such as \"0.8 <= nis_mean <= 1.2\"",
        ),
        (
            "constraints = [\"0.8 < nis_mean <= 1.2\"]",
            "<",
            "28:21: `tune.constraints[1]` is `<`: expected <= or >= between the name and the limit",
        ),
        (
            "constraints = [\"low <= nis_mean <= 1.2\"]",
            "low",
            "28:17: `tune.constraints[1]` is limited by `low`: expected a finite number before <= or >=",
        ),
        (
            "constraints = [\"1 <= nis_mean <= 1.2 <= 3\"]",
            "\"1 <= nis_mean <= 1.2 <= 3\"",
            "28:16: `tune.constraints[1]` is \"1 <= nis_mean <= 1.2 <= 3\": expected a name, <= or >=, and a number, such as \"nis_mean <= 1.2\" or \"0.8 <= nis_mean <= 1.2\", or a table with `name` and `max` or `min`",
        ),
    ]);
}

#[test]
fn a_constraint_may_stand_on_both_sides() {
    let read = |line: &str| {
        let problem = Problem::parse(&SOUND.replace("[\"nll\"]", &with(line)), "p.toml").unwrap();
        problem.tune.constraints.iter().map(|c| (c.measure.kind, c.relation, c.limit)).collect::<Vec<_>>()
    };
    let [low, high] = [(Kind::NisMean, Relation::AtLeast, 0.8), (Kind::NisMean, Relation::AtMost, 1.2)];
    assert_eq!(read("constraints = [\"0.8 <= nis_mean<=1.2\"]"), [low, high]);
    assert_eq!(read("constraints = [\"1.2 >= nis_mean >= 0.8\"]"), [high, low]);
    assert_eq!(read("constraints = [\"0.8 <= nis_mean\", \"1.2 >= nis_mean\"]"), [low, high]);
}

#[test]
fn picks_say_where_they_are_wrong() {
    let two = |line: &str| format!("[\"nll\", \"nis\"]\n{line}");
    let cases = [
        (
            "pick = \"kne\"",
            "\"kne\"",
            "28:8: `tune.pick` names the objective `kne`, which does not exist (known: `nll`, `nis`)",
        ),
        (
            "pick = \"nees\"",
            "\"nees\"",
            "28:8: `tune.pick` names the objective `nees`, which does not exist (known: `nll`, `nis`)",
        ),
        (
            "pick = 1",
            "1",
            "28:8: `tune.pick`: expected \"knee\", the name of an objective, or { weights = { ... } }, found the number 1",
        ),
        ("pick = { weights = { nll = -1 } }", "-1", "28:28: `tune.pick.weights.nll` is -1: expected a weight from 0"),
        (
            "pick = { weights = { nll = 0 } }",
            "{ nll = 0 }",
            "28:20: `tune.pick.weights`: no objective has a weight above 0: give one to each that counts",
        ),
        (
            "pick = { weights = { rmse = 1 } }",
            "rmse",
            "28:22: `tune.pick.weights` names the objective `rmse`, which does not exist (known: `nll`, `nis`)",
        ),
        (
            "pick = {}",
            "{}",
            "28:8: [tune.pick] lacks `weights`: give a weight of each objective that counts, such as { nll = 0.7, rmse = 0.3 }",
        ),
    ];
    let lines: Vec<(String, &str, &str)> = cases.iter().map(|(line, under, said)| (two(line), *under, *said)).collect();
    let cases: Vec<(&str, &str, &str, &str)> =
        lines.iter().map(|(line, under, said)| ("[\"nll\"]", line.as_str(), *under, *said)).collect();
    check(&cases);
    for (line, expected) in [
        ("pick = \"nis\"", Pick::Best(1)),
        ("pick = \"knee\"", Pick::Knee),
        ("pick = { weights = { nis = 0.3, nll = 2 } }", Pick::Weights(vec![2.0, 0.3])),
    ] {
        let problem = Problem::parse(&SOUND.replace("[\"nll\"]", &two(line)), "p.toml").unwrap();
        assert_eq!(problem.tune.pick, expected, "{line}");
    }
}

#[test]
fn several_objectives_default_to_a_method_for_fronts() {
    let algorithm = |objectives: &str| {
        let text = SOUND.replace("algorithm = \"pso\"\n", "").replace("[\"nll\"]", objectives);
        let tune = Problem::parse(&text, "p.toml").unwrap().tune;
        (tune.algorithm, tune.polish)
    };
    assert_eq!(algorithm("[\"nll\"]"), ("pso".to_owned(), true));
    assert_eq!(algorithm("[\"nll\", \"nis\"]"), ("nsga2".to_owned(), true));
}
