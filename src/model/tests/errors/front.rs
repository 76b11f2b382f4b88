//! `[tune] constraints` and `pick`.

use super::SOUND;
use crate::model::{Pick, Problem};
use crate::objective::{Kind, Relation};

/// The objectives of the sound problem with a line behind them.
fn with(line: &str) -> String {
    format!("[\"nll\"]\n{line}")
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
fn picks_are_read_in_three_forms() {
    let two = |line: &str| format!("[\"nll\", \"nis\"]\n{line}");
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
