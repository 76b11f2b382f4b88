use super::per_row::per_row;
use super::*;
use crate::data::Log;
use crate::model::Problem;
use crate::reference;
use crate::simulate::simulate;
use crate::study::Split;
use rayon::prelude::*;

const LEVEL: &str = "[data]\nmeasurements = [\"y\"]\ntruth = { level = \"level\" }\nVALIDATE\n[model]\nstate = [\"level\"]\nf = [\"level\"]\nh = [\"level\"]\n\
    Q = [\"q\"]\nR = [\"r\"]\nx0 = [0]\nP0 = [4]\n[parameters]\nq = { min = 1e-3, max = 1e3, start = 0.5 }\n\
    r = { min = 1e-3, max = 1e3, start = 4 }\n[tune]\nobjectives = OBJECTIVES\n[simulate]\ndt = 1\n";

fn problem(validate: &str, objectives: &str, simulate: &str) -> Problem {
    let text = LEVEL.replace("VALIDATE", validate).replace("OBJECTIVES", objectives) + simulate;
    Problem::parse(&text, "level.toml").unwrap()
}

fn held_out(problem: &Problem, log: Log) -> HeldOut {
    Split::of(problem, log).unwrap().held_out.expect("rows are held out")
}

fn difference(problem: &Problem, held_out: &HeldOut, baseline: &[f64], winner: &[f64]) -> HeldOutDifference {
    let costs = [baseline, winner].map(|candidate| reference::costs_held_out(problem, held_out, candidate).unwrap());
    HeldOutDifference::of(problem, held_out, (baseline, Some(&costs[0])), (winner, Some(&costs[1])))
}

/// What rows add up to is what the reference scores, for every objective and option, in time and over trajectories.
#[test]
fn rows_add_up_to_the_objectives() {
    let objectives = "[\"nll\", { name = \"mse_innovation\", skip = 30 }, \"nis\", \"nis_distribution\", \
                      { name = \"whiteness\", lags = 3 }, { name = \"prediction\", ahead = [1, 4] }, \"nees\", \"rmse\", \"distance\", \
                      { name = \"mismatch\", window = 7 }]";
    let last = objectives.replace("window = 7", "window = 9, ct = \"last\"");
    for validate in ["validate = { share = 0.5, by = \"time\" }", "validate = 0.4"] {
        for objectives in [objectives, &last] {
            let problem = problem(validate, objectives, "steps = 99\ntrajectories = 3\nmissing = 0.1\n");
            let held_out = held_out(&problem, simulate(&problem, Some(3)).unwrap());
            let expected = reference::costs_held_out(&problem, &held_out, &[0.7, 3.0]).unwrap();
            let rows = per_row(&problem, &held_out, &[0.7, 3.0]).unwrap();
            for ((objective, rows), expected) in problem.tune.objectives.iter().zip(&rows).zip(expected) {
                let found = rows.cost(objective);
                let name = objective.name();
                assert!((found - expected).abs() < 1e-11 * expected.abs().max(1.0), "{name}: {found} and {expected}");
                let sum: f64 = rows.influence(objective).rows.iter().flatten().sum();
                assert!(sum.abs() < 1e-9, "{name}: influences add up to {sum}");
            }
        }
    }
}

/// Of each objective over `logs` logs: the mean difference, and how many of the intervals difference +- 1.96 standard errors
/// hold it.
fn coverage(problem: &Problem, logs: u64, baseline: &[f64], winner: &[f64]) -> Vec<(f64, usize)> {
    let one = |seed| {
        // Fresh realisations are drawn with the problem's own seed.
        let mut problem = problem.clone();
        problem.simulate.as_mut().expect("simulated").seed = seed;
        let held_out = held_out(&problem, simulate(&problem, None).unwrap());
        difference(&problem, &held_out, baseline, winner).by_objective
    };
    let all: Vec<Named<Difference>> = (0..logs).into_par_iter().map(one).collect();
    let of = |name: &str| {
        let found: Vec<Difference> = all.iter().filter_map(|named| named.get(name).copied()).collect();
        let mean = found.iter().map(|d| d.difference).sum::<f64>() / found.len() as f64;
        (mean, found.iter().filter(|d| (d.difference - mean).abs() <= 1.96 * d.standard_error).count())
    };
    problem.tune.objectives.iter().map(|objective| of(objective.name())).collect()
}

/// Over 500 logs each; of 95 % the standard deviation is 1 %.
#[test]
fn intervals_hold_the_difference() {
    let by_time = "validate = { share = 0.6, by = \"time\" }";
    let objectives = "[\"nll\", \"mse_innovation\", \"rmse\"]";
    let one = problem(by_time, objectives, "steps = 249\n");
    let many = problem("validate = 0.6", objectives, "steps = 19\ntrajectories = 20\n");
    for (what, problem) in [("150 rows", &one), ("30 trajectories", &many)] {
        let found = coverage(problem, 500, &[1.0, 4.0], &[0.45, 4.2]);
        for (objective, (mean, inside)) in problem.tune.objectives.iter().zip(found) {
            println!("{what}, {}: mean difference {mean:.4}, {inside} of 500 intervals hold it", objective.name());
            assert!((455..=495).contains(&inside), "{what}, {}: {inside} of 500", objective.name());
        }
    }
}

#[test]
fn what_is_told_apart_is_said_to_be() {
    let problem = problem("validate = { share = 0.5, by = \"time\" }", "[\"nll\"]", "steps = 399\n");
    let held_out = held_out(&problem, simulate(&problem, Some(1)).unwrap());
    let right = [0.5, 4.0];
    let against = |other: [f64; 2]| difference(&problem, &held_out, &other, &right);
    let better = against([20.0, 0.1]);
    assert_eq!(better.verdict, Standing::Better, "{better:?}");
    let worse = difference(&problem, &held_out, &right, &[20.0, 0.1]);
    assert_eq!(worse.verdict, Standing::Worse, "{worse:?}");
    assert!((worse.difference + better.difference).abs() < 1e-9, "{worse:?}");
    assert_eq!(against([0.52, 3.9]).verdict, Standing::NotToldApart);
    let same = against(right);
    assert_eq!((same.verdict, same.standard_error), (Standing::NotToldApart, 0.0), "a candidate beside itself");
}

#[test]
fn a_failing_filter_is_worse_and_few_rows_tell_nothing() {
    let problem = problem("validate = { share = 0.1, by = \"time\" }", "[\"nll\"]", "steps = 59\n");
    let held_out = held_out(&problem, simulate(&problem, Some(1)).unwrap());
    let of =
        |baseline, winner| HeldOutDifference::of(&problem, &held_out, (&[0.5, 4.0], baseline), (&[20.0, 0.1], winner));
    assert_eq!(of(Some(&[1.0]), None).verdict, Standing::Worse);
    assert_eq!(of(None, Some(&[1.0])).verdict, Standing::Better);
    assert_eq!(of(None, None).verdict, Standing::NotToldApart);
    let few = of(Some(&[1.0]), Some(&[100.0]));
    assert!(few.standard_error.is_nan() && few.verdict == Standing::NotToldApart, "six rows: {few:?}");
    let json = serde_json::to_value(&few).unwrap();
    assert_eq!((&json["verdict"], &json["standard_error"]), (&"not-told-apart".into(), &serde_json::Value::Null));
}

#[test]
fn better_here_and_worse_there_is_a_trade() {
    let named = |differences: [(f64, f64); 2]| {
        let differences = differences.map(|(difference, error)| Difference::of(difference, error));
        HeldOutDifference::together(Named::new(["nll", "rmse"], differences))
    };
    for (differences, verdict, is_trade) in [
        ([(3.0, 1.0), (0.1, 1.0)], Standing::Better, false),
        ([(0.1, 1.0), (-3.0, 1.0)], Standing::Worse, false),
        ([(3.0, 1.0), (-3.0, 1.0)], Standing::NotToldApart, true),
        ([(1.0, 1.0), (-1.0, 1.0)], Standing::NotToldApart, false),
    ] {
        let found = named(differences);
        assert_eq!((found.verdict, found.is_trade()), (verdict, is_trade), "{differences:?}");
    }
    let untold = named([(-1.19, 2.34), (0.5, f64::NAN)]).untold();
    assert_eq!(untold, "`nll` is 1.19 +- 2.34 nats worse, `rmse` is 0.500 +- ? better");
    assert_eq!(named([(35.12, 4.21), (0.1, 1.0)]).amounts(Standing::Better), "`nll` by 35.1 +- 4.21 nats");
}
