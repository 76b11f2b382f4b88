//! Built-in motion and sensors against the values of other programs for the same models, typed there.

use std::path::Path;

use kfgpu::data::Log;
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{Run, run, score};
use serde_json::Value;

fn golden(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file);
    serde_json::from_str(&std::fs::read_to_string(path).expect("the file is there")).expect("JSON")
}

fn nll(run: &Run) -> f64 {
    run.trajectories[0].iter().filter_map(|step| step.update.as_ref()).map(|update| update.nll).sum()
}

fn example(name: &str) -> (String, std::path::PathBuf) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    (std::fs::read_to_string(folder.join(name)).expect("the file is there"), folder)
}

fn read(text: &str, folder: &Path) -> (Problem, Log) {
    let problem = Problem::parse(text, &folder.join("p.toml").display().to_string()).unwrap_or_else(|e| panic!("{e}"));
    let log = Log::open(&problem.data, folder).expect("the log reads");
    (problem, log)
}

fn at(problem: &Problem, parameters: &Value) -> Vec<f64> {
    let of = |name: &&str| parameters[*name].as_f64().expect("a parameter");
    problem.parameters.names().iter().map(of).collect()
}

/// 40-digit arithmetic, numpy, filterpy: an extended filter does not see the order of states.
fn nonlinear(name: &str, text: &str, folder: &Path) {
    let (problem, log) = read(text, folder);
    for set in golden("golden_nonlinear.json")["problems"][name]["sets"].as_array().expect("sets") {
        let run = run(&problem, &log, &at(&problem, &set["parameters"])).expect("runs");
        let expected = set["filters"]["ekf"]["loglik"].as_f64().expect("a number");
        assert!((nll(&run) + expected).abs() < 1e-10 * expected.abs(), "{name}: {}, expected {}", nll(&run), -expected);
    }
}

#[test]
fn a_coordinated_turn_seen_by_a_radar() {
    let text = r#"[data]
file = "ct_range_bearing.csv"
time = "t"
measurements = ["range", "bearing"]
truth = { w = "w_true", x = "x_true", y = "y_true", vx = "vx_true", vy = "vy_true" }
[model]
kind = "coordinated-turn"
axes = ["x", "y"]
h = "range-bearing"
q = "q1"
q_rate = "q2"
R = ["r", "rb"]
x0 = [-0.045, 1010, 990, 295, 5]
P0 = [1e-4, 100, 100, 10, 10]
[filter]
kind = "extended"
[parameters]
q1 = { min = 1e-2, max = 10, scale = "log", start = 0.1 }
q2 = { min = 1e-5, max = 1e-2, scale = "log", start = 1.75e-4 }
r = { min = 10, max = 1000, scale = "log", start = 100 }
rb = { min = 1e-6, max = 1e-4, scale = "log", start = 1e-5 }
"#;
    nonlinear("ct", text, &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/nonlinear"));
}

/// The golden filter's states are relative to the ship; a bearing from where the ship is says the same.
#[test]
fn a_bearing_from_a_ship() {
    let (text, folder) = example("bearings_only.toml");
    nonlinear("bearings_only", &text, &folder);
}

#[test]
fn a_unicycle_that_ranges_to_radios() {
    let golden = &golden("golden_real.json")["plaza2"];
    let (text, folder) = example("plaza2.toml");
    let (problem, log) = read(&text, &folder);
    let fixed = &golden["fixed"];
    let found = run(&problem, &log, &at(&problem, &fixed["parameters"])).expect("runs");
    let expected = fixed["ekf"]["loglik"].as_f64().expect("a number");
    assert!((nll(&found) + expected).abs() < 1e-6, "{}", nll(&found));
    let mut positions = Objective::new(Kind::Rmse);
    positions.states = vec![1, 2];
    let rmse = score(&problem, &log, &found, &[positions])[0];
    // kfgpu's is a root mean square over states and rows, the golden one over rows.
    let expected = fixed["ekf"]["rmse"].as_f64().expect("a number");
    assert!((rmse - expected).abs() < 1e-8 || (rmse * 2f64.sqrt() - expected).abs() < 1e-8, "{rmse}");
    // a = 0 and b = 1 are plain ranges.
    let (before, rest) = text.split_once("h = [").expect("an h");
    let (_, after) = rest.split_once("\n]\n").expect("its end");
    let beacons = "[[-33.620537, 26.967797], [-68.926537, 18.377797], [1.709463, -5.812203], [-37.580537, 69.227797]]";
    let (problem, log) = read(&format!("{before}h = \"ranges\"\nat = {beacons}\n{after}"), &folder);
    let ignored = &golden["scale_ignored"];
    let found = run(&problem, &log, &at(&problem, &ignored["parameters"])).expect("runs");
    let expected = ignored["loglik"].as_f64().expect("a number");
    assert!((nll(&found) + expected).abs() < 1e-5, "{}", nll(&found));
}

/// statsmodels 0.15.0: the quasi-likelihood of stochastic volatility, at two points.
#[test]
fn the_volatility_of_the_pound() {
    let (text, folder) = example("volatility.toml");
    let (problem, log) = read(&text, &folder);
    assert_eq!(problem.parameters.names(), ["phi", "sigma", "beta"]);
    // The maximum is given with five digits of the parameters.
    for (candidate, expected, tolerance) in
        [([0.9731, 0.1726, 0.6338], 2_208.732_944_909, 1e-6), ([0.97917, 0.16991, 0.6127], 2_208.399_345, 1e-5)]
    {
        let found = nll(&run(&problem, &log, &candidate).expect("runs"));
        assert!((found - expected).abs() < tolerance, "{found}, expected {expected}");
    }
}
