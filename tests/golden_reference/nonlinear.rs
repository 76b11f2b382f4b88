//! Filters of nonlinear f and h against other programs: `golden_nonlinear.json` (40-digit arithmetic, numpy, filterpy, Stone
//! Soup) and `golden_real.json` (numpy, filterpy), see `tests/golden/README.md`.

use std::path::Path;

use kfgpu::data::{Log, Table};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{Run, run, score};
use serde_json::Value;

/// The folder of the problem files.
const FOLDER: &str = "tests/data/nonlinear";

fn golden(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file);
    serde_json::from_str(&std::fs::read_to_string(path).expect("the file is there")).expect("JSON")
}

/// A problem of [`FOLDER`] with another `[filter]`, and its log.
pub(crate) fn problem(name: &str, filter: &str) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER);
    let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).expect("the file is there");
    assert!(text.contains("kind = \"extended\""), "{name}: what is replaced");
    let problem = Problem::parse(&text.replace("kind = \"extended\"", filter), name).expect("the problem parses");
    let log = Log::open(&problem.data, &folder).expect("the log reads");
    (problem, log)
}

/// What `[filter]` says for a name of the golden file; `None` where kfgpu has no such filter. Plain names of sigma-point
/// filters average bearings on the circle, so with an angle the `_linear_mean` ones count.
fn filter(name: &str, has_angle: bool) -> Option<String> {
    let of = |alpha: f64, beta: f64, kappa: f64| {
        format!("kind = \"unscented\"\nalpha = {alpha}\nbeta = {beta}\nkappa = {kappa}")
    };
    let bare = match name.strip_suffix("_linear_mean") {
        Some(bare) => bare,
        None if has_angle && (name.starts_with("ukf") || name.starts_with("ckf")) => return None,
        None => name,
    };
    Some(match bare {
        "ekf" => "kind = \"extended\"".to_owned(),
        "iekf5" => "kind = \"iterated\"\niterations = 5".to_owned(),
        "ukf_a1_b0_k1" => of(1.0, 0.0, 1.0),
        "ukf_a1e-3_b2_k0" => of(1e-3, 2.0, 0.0),
        "ukf_a.5_b2_k2" => of(0.5, 2.0, 2.0),
        "ckf" => "kind = \"cubature\"".to_owned(),
        _ => return None,
    })
}

/// Rows without measurement, without range, without bearing.
fn with_gaps(log: &mut Log) {
    let trajectory = &mut log.trajectories[0];
    let mut z = Table::new(2);
    for k in 0..trajectory.len() {
        let row = trajectory.z.row(k);
        let empty = (10..=12).contains(&k);
        let no_range = empty || [30, 60, 90].contains(&k);
        let no_bearing = empty || [20, 40, 60, 80].contains(&k);
        let cell = |gone: bool, value| if gone { f64::NAN } else { value };
        z.push(&[cell(no_range, row[0]), cell(no_bearing, row[1])]);
    }
    trajectory.z = z;
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// |found - expected|, of the size of `expected` or of 1.
fn apart(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(1.0)
}

/// Root mean square over rows of the distance in two states, or of one state.
fn rmse(run: &Run, log: &Log, states: usize) -> f64 {
    let squares = run.trajectories[0].iter().map(|step| {
        let truth = log.trajectories[0].truth.row(step.row);
        (0..states).map(|i| (step.posterior.x[i] - truth[i]).powi(2)).sum::<f64>()
    });
    (squares.sum::<f64>() / run.trajectories[0].len() as f64).sqrt()
}

/// Largest relative differences of the log-likelihood, of states and variances, of what rows and NIS say, and of the RMSE of
/// positions.
fn differences(run: &Run, log: &Log, expected: &Value, rows: &[usize]) -> [f64; 4] {
    let steps = &run.trajectories[0];
    let nll: f64 = steps.iter().filter_map(|s| s.update.as_ref()).map(|u| u.nll).sum();
    let loglik = apart(-nll, expected["loglik"].as_f64().expect("a number"));
    let (mut states, mut rest) = (0.0f64, 0.0f64);
    let shown = numbers(&expected["loglik_rows"]);
    for (i, row) in rows.iter().enumerate() {
        let step = &steps[*row];
        for (found, expected) in step.posterior.x.iter().zip(numbers(&expected["x"][i])) {
            states = states.max(apart(*found, expected));
        }
        rest = rest.max(apart(step.update.as_ref().map_or(0.0, |u| -u.nll), shown[i]));
    }
    let last = &steps[steps.len() - 1].posterior.p;
    for (found, expected) in last.diagonal().iter().zip(numbers(&expected["P_diag_last"])) {
        states = states.max(((found - expected) / expected).abs());
    }
    rest = rest.max(apart(run.nis_sum(0).0, expected["nis_sum"].as_f64().expect("a number")));
    let positions = if last.nrows() == 1 { 1 } else { 2 };
    let error = apart(rmse(run, log, positions), expected["rmse_position"].as_f64().expect("a number"));
    [loglik, states, rest, error]
}

#[test]
fn other_programs_agree() {
    let golden = golden("golden_nonlinear.json");
    let mut compared = 0;
    for (name, of) in golden["problems"].as_object().expect("problems") {
        let rows: Vec<usize> = numbers(&of["rows_shown"]).iter().map(|row| *row as usize).collect();
        for set in of["sets"].as_array().expect("sets") {
            for (filter_name, expected) in set["filters"].as_object().expect("filters") {
                let Some(filter) = filter(filter_name, name != "growth") else { continue };
                let (problem, mut log) = problem(name.trim_end_matches("_missing"), &filter);
                if name == "ct_missing" {
                    with_gaps(&mut log);
                }
                let of = |parameter: &&str| set["parameters"][*parameter].as_f64().expect("a parameter");
                let candidate: Vec<f64> = problem.parameters.names().iter().map(of).collect();
                let run = run(&problem, &log, &candidate).expect("runs");
                let found = differences(&run, &log, expected, &rows);
                let tolerance = if filter_name.contains("1e-3") { 1e-6 } else { 1e-11 };
                // The RMSE is stored with eight digits.
                let close = found[..3].iter().all(|d| *d < tolerance) && found[3] < 1e-7;
                assert!(close, "{name} {filter_name}: {found:?}, {candidate:?}");
                // So do the lanes, which share nothing with the reference.
                let expected = -expected["loglik"].as_f64().expect("a number");
                let mut lanes = CpuEvaluator::new(&problem, &log, CpuOptions::default()).expect("it traces");
                let population = Population::from_rows(candidate.len(), candidate.clone());
                let nll = lanes.evaluate(&population).costs(0)[0];
                assert!(apart(nll, expected) < tolerance.max(1e-9), "{name} {filter_name}: {nll} against {expected}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 45, "filters compared");
}

/// Ranges one by one, irregular intervals, inputs, and a heading that turns past pi.
#[test]
fn a_robot_that_ranges_to_radios() {
    let golden = &golden("golden_real.json")["plaza2"]["fixed"];
    let of = |name: &str| golden["parameters"][name].as_f64().expect("a parameter");
    for (name, filter) in [
        ("ekf", "kind = \"extended\""),
        ("ukf_a1_b0_k1_redraw_filterpy", "kind = \"unscented\"\nalpha = 1\nbeta = 0\nkappa = 1"),
    ] {
        let (problem, log) = problem("plaza2", filter);
        let candidate: Vec<f64> = problem.parameters.names().iter().map(|name| of(name)).collect();
        let run = run(&problem, &log, &candidate).expect("runs");
        let steps = &run.trajectories[0];
        let expected = &golden[name];
        let nll: f64 = steps.iter().filter_map(|s| s.update.as_ref()).map(|u| u.nll).sum();
        // Values are stored with ten digits.
        assert!(apart(-nll, expected["loglik"].as_f64().expect("a number")) < 1e-9, "{name}: {nll}");
        assert!(apart(rmse(&run, &log, 2), expected["rmse"].as_f64().expect("a number")) < 1e-9, "{name}");
        for (found, expected) in steps[steps.len() - 1].posterior.x.iter().zip(numbers(&expected["x_last"])) {
            assert!(apart(*found, expected) < 1e-9, "{name}: {found}, expected {expected}");
        }
        if let Some(expected) = expected["nis_per_range"].as_f64() {
            assert!(apart(run.nis_mean(), expected) < 1e-9, "{name}: {}", run.nis_mean());
        }
    }
}

/// The heading of the log is in [-pi, pi) or so, the filter's goes on: errors are taken modulo 2 pi.
#[test]
fn errors_of_an_angle_are_less_than_half_a_turn() {
    let (problem, log) = problem("plaza2", "kind = \"extended\"");
    let run = run(&problem, &log, &problem.parameters.baseline()).expect("runs");
    let steps = &run.trajectories[0];
    let raw = |step: &kfgpu::reference::Step| step.posterior.x[2] - log.trajectories[0].truth.row(step.row)[2];
    let turns = steps.iter().map(|step| raw(step).abs()).fold(0.0, f64::max);
    let mut heading = Objective::new(Kind::Rmse);
    heading.states = vec![2];
    let [rmse] = score(&problem, &log, &run, &[heading])[..] else { unreachable!("one objective") };
    let nees: f64 = steps.iter().filter_map(|step| step.nees).fold(0.0, f64::max);
    assert!(turns > 30.0, "the robot turned by {turns} rad more than the log says");
    assert!(rmse < 0.2 && nees < 1e3, "rmse of the heading {rmse}, largest NEES {nees}");
}
