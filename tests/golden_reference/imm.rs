//! Interacting multiple models against other programs: `golden_imm.json` (40-digit arithmetic, numpy, filterpy), and what
//! follows from the definition.

use std::path::Path;

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
use kfgpu::model::Problem;
use kfgpu::reference::{Run, costs, run};
use serde_json::Value;

/// A problem of `tests/data/imm` after some replacements, and its log.
fn problem(name: &str, replace: &[(&str, &str)]) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/imm");
    let mut text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).expect("the file is there");
    for (from, to) in replace {
        assert!(text.contains(from), "{name}: {from}");
        text = text.replace(from, to);
    }
    let problem = Problem::parse(&text, name).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let log = Log::open(&problem.data, &folder).expect("the log reads");
    (problem, log)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

fn assert_close(found: f64, expected: f64, what: &str) {
    let apart = (found - expected).abs() / expected.abs().max(1.0);
    assert!(apart < 1e-10, "{what}: {found}, expected {expected}");
}

/// The reference and the tape in f64 at the start values.
fn assert_alike(problem: &Problem, log: &Log, what: &str) -> Vec<f64> {
    let baseline = problem.parameters.baseline();
    let expected = costs(problem, log, &baseline).expect("runs");
    let mut lanes = CpuEvaluator::new(problem, log, CpuOptions::default()).expect("traces");
    let found = lanes.evaluate(&Population::from_rows(baseline.len(), baseline));
    for (i, expected) in expected.iter().enumerate() {
        assert_close(found.costs(0)[i], *expected, &format!("{what}, objective {i} on the tape"));
    }
    expected
}

fn check(run: &Run, log: &Log, expected: &Value, name: &str) {
    let steps = &run.trajectories[0];
    let log_likelihood =
        |rows: usize| -> f64 { -steps[..rows].iter().flat_map(|s| &s.update).map(|u| u.nll).sum::<f64>() };
    assert_close(log_likelihood(steps.len()), expected["loglik"].as_f64().expect("a number"), name);
    let rows = match expected.get("rows_shown") {
        Some(rows) => numbers(rows),
        None => [0, 1, 10, 29, 35, 54, 60, 85, 99, 119].map(f64::from).to_vec(),
    };
    for (i, row) in rows.iter().map(|row| *row as usize).enumerate() {
        let what = format!("{name}, row {row}");
        let step = &steps[row];
        assert_close(log_likelihood(row + 1), numbers(&expected["loglik_cumulative"])[i], &what);
        for (key, found) in [("mode_probabilities", step.modes.as_slice()), ("x", step.posterior.x.as_slice())] {
            found
                .iter()
                .zip(numbers(&expected[key][i]))
                .for_each(|(found, expected)| assert_close(*found, expected, &what));
        }
        if let Some(diagonal) = expected.get("P_diag") {
            let found = step.posterior.p.diagonal();
            found.iter().zip(numbers(&diagonal[i])).for_each(|(found, expected)| assert_close(*found, expected, &what));
        }
    }
    let Some(rmse) = expected.get("rmse_position") else { return };
    let squares = steps.iter().map(|step| {
        let truth = log.trajectories[0].truth.row(step.row);
        (0..2).map(|i| (step.posterior.x[i] - truth[i]).powi(2)).sum::<f64>()
    });
    let found = (squares.sum::<f64>() / steps.len() as f64).sqrt();
    assert!((found - rmse.as_f64().expect("a number")).abs() < 1e-6, "{name}: {found}");
}

#[test]
fn other_programs_agree() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/golden_imm.json");
    let golden: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("the file is there")).expect("JSON");
    let cases = golden["cases"].as_object().expect("cases");
    assert_eq!(cases.len(), 6, "cases");
    for (name, expected) in cases {
        let (base, predict) = match name.strip_suffix("_predict_first") {
            Some(base) => (base, true),
            None => (name.as_str(), false),
        };
        let file = match base {
            "cv2" => "cv2",
            "cv_left_right" => "turns",
            _ => "turns_rb",
        };
        let first: &[(&str, &str)] = if predict { &[("x0 =", "first = \"predict\"\nfirst_dt = 1\nx0 =")] } else { &[] };
        let (problem, log) = problem(file, first);
        let run = run(&problem, &log, &problem.parameters.baseline()).expect("runs");
        check(&run, &log, expected, name);
        let costs = assert_alike(&problem, &log, name);
        assert_close(-costs[0], expected["loglik"].as_f64().expect("a number"), name);
    }
}

/// The text of two modes over the log, one line of them each.
fn noises(filter: &str, modes: [&str; 2]) -> (Problem, Log) {
    let calm = format!("name = \"calm\"\n{}", modes[0]);
    let wild = format!("name = \"wild\"\n{}", modes[1]);
    problem(
        "cv2",
        &[
            ("transition = [[\"stay1\", \"1 - stay1\"], [0.1, 0.9]]\nstart = [0.8, 0.2]", filter),
            ("name = \"calm\"\nq = \"q1\"", &calm),
            ("name = \"wild\"\nq = \"q2\"", &wild),
        ],
    )
}

#[test]
fn equal_modes_are_one_filter() {
    let (one, log) = problem("cv2", &[("kind = \"imm\"", "kind = \"imm\"")]);
    let mode = one.of_mode(&one.modes[1]);
    let expected = costs(&mode, &log, &one.parameters.baseline()).expect("runs");
    let (same, log) = noises("stay = 0.7\nstart = [0.3, 0.7]", ["q = \"q2\"", "q = \"q2\""]);
    let found = assert_alike(&same, &log, "equal modes");
    found.iter().zip(&expected).for_each(|(found, expected)| assert_close(*found, *expected, "equal modes"));
}

#[test]
fn the_numbers_of_the_modes_change_nothing() {
    let there = noises("transition = [[0.95, 0.05], [0.1, 0.9]]\nstart = [0.8, 0.2]", ["q = \"q1\"", "q = \"q2\""]);
    let back = noises("transition = [[0.9, 0.1], [0.05, 0.95]]\nstart = [0.2, 0.8]", ["q = \"q2\"", "q = \"q1\""]);
    let [there, back] = [there, back].map(|(problem, log)| assert_alike(&problem, &log, "renumbered"));
    there.iter().zip(&back).for_each(|(there, back)| assert_close(*there, *back, "renumbered"));
}

/// A mean stay of m seconds is left with probability 1 - exp(-dt / m), whatever the interval.
#[test]
fn a_sojourn_is_a_probability_of_staying() {
    let stay = (-1.0f64 / 20.0).exp();
    let typed = format!("stay = [{stay:?}, 0.9]");
    let left = 1.0f64 / (10.0f64 / 9.0).ln();
    let sojourn = format!("sojourn = [20, {left:?}]");
    let [typed, sojourn] = [typed, sojourn].map(|filter| {
        let (problem, log) = noises(&filter, ["q = \"q1\"", "q = \"q2\""]);
        assert_alike(&problem, &log, &filter)
    });
    typed.iter().zip(&sojourn).for_each(|(typed, sojourn)| assert_close(*typed, *sojourn, "sojourn"));
}

/// By hand: one state that stays where it is, two modes that differ in R, one measurement and one step.
#[test]
fn one_step_by_hand() {
    let text = "[data]\nfile = \"none.csv\"\nmeasurements = [\"z\"]\n[model]\nstate = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\nQ = [1]\n\
                x0 = [0]\nP0 = [1]\n[filter]\nkind = \"imm\"\nstay = [0.8, 0.6]\nstart = [0.75, 0.25]\n[[mode]]\nname = \"good\"\n\
                R = [1]\n[[mode]]\nname = \"bad\"\nR = [3]\n[parameters]\nunused = { min = 0, max = 1 }\n[tune]\nobjectives = [\"nll\"]\n";
    let problem = Problem::parse(text, "hand.toml").expect("parses");
    let folder = std::env::temp_dir();
    let file = folder.join(format!("kfgpu_imm_by_hand_{}.csv", std::process::id()));
    std::fs::write(&file, "z\n2\n1\n").expect("written");
    let mut data = problem.data.clone();
    data.file = Some(file.file_name().expect("a name").to_string_lossy().into_owned());
    let log = Log::open(&data, &folder).expect("reads");
    std::fs::remove_file(&file).expect("removed");
    let found = run(&problem, &log, &[0.5]).expect("runs");
    let normal = |nu: f64, s: f64| (-0.5 * nu * nu / s).exp() / (std::f64::consts::TAU * s).sqrt();
    // Row 0: S = 2 and 4.
    let joint = [0.75 * normal(2.0, 2.0), 0.25 * normal(2.0, 4.0)];
    let first = joint[0] + joint[1];
    let mu = joint.map(|joint| joint / first);
    let (x, p) = ([1.0, 0.5], [0.5, 0.75]);
    // Mixing and one step.
    let came = [[0.8 * mu[0], 0.4 * mu[1]], [0.2 * mu[0], 0.6 * mu[1]]];
    let c = came.map(|came| came[0] + came[1]);
    let (mut total, mut after) = (0.0, [0.0; 2]);
    for j in 0..2 {
        let w = came[j].map(|came| came / c[j]);
        let mean = w[0] * x[0] + w[1] * x[1];
        let variance: f64 = (0..2).map(|i| w[i] * (p[i] + (x[i] - mean).powi(2))).sum::<f64>() + 1.0;
        after[j] = c[j] * normal(1.0 - mean, variance + [1.0, 3.0][j]);
        total += after[j];
    }
    let steps = &found.trajectories[0];
    assert_close(steps[0].update.as_ref().expect("measured").nll, -first.ln(), "row 0");
    assert_close(steps[1].update.as_ref().expect("measured").nll, -total.ln(), "row 1");
    assert_close(steps[1].modes[0], after[0] / total, "row 1");
    assert_alike(&problem, &log, "by hand");
}
