//! In f64 the factors carry what P carries, for every shape of problem; and both are the reference's filter.

use crate::case::Case;
use kfgpu::evaluate::{Evaluation, Precision};
use kfgpu::filter::Form;
use kfgpu::reference;

const OBJECTIVES: &str = r#"objectives = ["nll", "mse_innovation", "mismatch", "nis", "nees", "rmse"]"#;

/// A motion model on one or more axes; `more` is what else stands in [model].
fn motion(name: &str, kind: &str, axes: &str, strengths: &str, more: &str, simulate: &str) -> Case {
    let n = axes.split(',').count();
    let prefixes: &[&str] = match kind {
        "constant-velocity" => &["", "v"],
        "local-linear-trend" => &["", "slope_"],
        _ => &["", "v", "a"],
    };
    let states = prefixes.iter().flat_map(|p| axes.split(',').map(move |a| format!("{p}{}", a.trim())));
    let truth = truth(states);
    let measurements: Vec<String> = axes.split(',').map(|a| format!("\"{}\"", a.trim())).collect();
    let r = vec!["\"r\""; n].join(", ");
    let text = format!(
        "[data]\ntime = \"t\"\nmeasurements = [{measurements}]\n{truth}\n[model]\nkind = \"{kind}\"\n{strengths}\nR = [{r}]\n{more}\n\
         [parameters]\nq = {{ min = 1e-3, max = 10, scale = \"log\", start = 0.1 }}\n\
         r = {{ min = 0.1, max = 10, scale = \"log\", start = 1 }}\n[tune]\nalgorithm = \"pso\"\n{OBJECTIVES}\n\
         [simulate]\nsteps = 80\ndt = 0.5\nseed = 3\n{simulate}\n",
        measurements = measurements.join(", "),
    );
    Case::simulated(name, &text)
}

fn truth(states: impl Iterator<Item = String>) -> String {
    let pairs: Vec<String> = states.map(|s| format!("{s} = \"{s}\"")).collect();
    format!("truth = {{ {} }}", pairs.join(", "))
}

fn typed(name: &str, model: &str, parameters: &str, simulate: &str) -> Case {
    let text = format!(
        "[data]\ntime = \"t\"\n{model}\n[parameters]\n{parameters}\n[tune]\nalgorithm = \"pso\"\n{OBJECTIVES}\n\
         [simulate]\nsteps = 80\ndt = 0.5\nseed = 5\n{simulate}\n"
    );
    Case::simulated(name, &text)
}

fn cases() -> Vec<Case> {
    let cv = |name: &str, noise: &str, more: &str, simulate: &str| {
        let strengths = format!("noise = \"{noise}\"\nq = \"q\"\nx0 = [0, 1]\nP0 = [20, 5]");
        motion(name, "constant-velocity", "x", &strengths, more, simulate)
    };
    let qr = "q = { min = 1e-3, max = 10, scale = \"log\", start = 0.1 }\nr = { min = 0, max = 10, start = 1 }";
    let three = "noise = \"piecewise\"\nq = \"q\"\nx0 = [0, 0, 0, 1, 1, 1]\nP0 = [20, 20, 20, 5, 5, 5]";
    let ca = "noise = \"piecewise\"\nq = \"q\"\nx0 = [0, 1, 0.1]\nP0 = [20, 5, 1]";
    let correlated = r#"
truth = { p = "p", v = "v" }
measurements = ["x", "s"]
[model]
state = ["p", "v"]
f = ["p + v*dt", "v"]
h = ["p + 0.2*v", "p - v"]
Q = { v = "q*dt" }
R = [["r + 0.5", "0.6*r"], ["0.6*r", "r"]]
x0 = [0, 1]
P0 = [[20, 3], [3, 5]]"#;
    let turning = r#"
truth = { a = "a", b = "b", c = "c" }
measurements = ["x"]
[model]
state = ["a", "b", "c"]
f = ["0.8*a - 0.6*b", "0.6*a + 0.8*b", "phi*c"]
h = ["a + c"]
Q = [["q", "q/2", 0], ["q/2", "q", 0], [0, 0, 0]]
R = ["r"]
x0 = [3, 0, 1]
P0 = [4, 4, 1]"#;
    let known = r#"
truth = { bias = "bias", level = "level" }
measurements = ["x"]
[model]
state = ["bias", "level"]
f = ["bias", "level"]
h = ["level + bias"]
Q = { level = "q" }
R = ["r"]
x0 = [0.5, 0]
P0 = ["m^2", 4]"#;
    vec![
        cv("CV 1-D", "continuous", "", ""),
        cv("CV 1-D, rank-1 Q, gaps", "piecewise", "", "missing = 0.4"),
        cv("CV 1-D, rank-1 Q, gaps", "piecewise", "", "missing = 0.4").irregular(),
        cv("CV 1-D", "continuous", "", "").irregular(),
        cv("CV 1-D, first = predict", "continuous", "first = \"predict\"", ""),
        cv("CV 1-D, pooled, gaps", "continuous", "", "trajectories = 3\nmissing = 0.2"),
        motion(
            "CV 3-D, rank-1 Q, gaps",
            "constant-velocity",
            "x, y, z",
            &format!("axes = [\"x\", \"y\", \"z\"]\n{three}"),
            "",
            "missing = 0.2",
        ),
        motion("CA 1-D, rank-1 Q", "constant-acceleration", "x", ca, "", ""),
        motion("CA 1-D, rank-1 Q", "constant-acceleration", "x", ca, "", "missing = 0.3").irregular(),
        motion(
            "local linear trend",
            "local-linear-trend",
            "x",
            "noise = \"piecewise\"\nq_level = \"q\"\nq_slope = 0.01\nx0 = [0, 1]\nP0 = [20, 5]",
            "",
            "",
        ),
        typed("correlated R, gaps", correlated, qr.replace("min = 0,", "min = 0.1,").as_str(), "missing = 0.3"),
        typed("correlated R, gaps", correlated, qr.replace("min = 0,", "min = 0.1,").as_str(), "missing = 0.3")
            .irregular(),
        typed(
            "dense F, a decaying state without noise",
            turning,
            &format!("{qr}\nphi = {{ min = 0.3, max = 0.9, start = 0.5 }}"),
            "",
        ),
        typed(
            "a state that becomes known exactly",
            known,
            &format!("{qr}\nm = {{ min = 0, max = 1, start = 0.5 }}"),
            "missing = 0.1",
        ),
        Case::example("robot"),
        Case::example("uav_gps_cv"),
        Case::example("matlab_plant"),
    ]
}

fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(1.0)
}

/// Largest relative difference of the usable costs; statuses must agree.
fn worst(case: &Case, found: &Evaluation, expected: &Evaluation) -> f64 {
    let mut worst: f64 = 0.0;
    for i in 0..case.population.len() {
        let candidate = case.population.row(i);
        assert_eq!(found.status(i), expected.status(i), "{}: status of {candidate:?}", case.name);
        for (a, b) in found.costs(i).iter().zip(expected.costs(i)) {
            worst = worst.max(relative(*a, *b));
        }
    }
    worst
}

#[test]
fn factors_equal_the_full_form_in_f64() {
    let mut over = vec![];
    for case in cases() {
        let full = case.evaluate(Precision::F64, Form::Full);
        let factored = case.evaluate(Precision::F64, Form::Factored);
        let error = worst(&case, &factored, &full);
        println!("{:50} {error:.1e}", case.name);
        if error > 1e-9 {
            over.push(case.name);
        }
    }
    assert!(over.is_empty(), "over 1e-9: {over:?}");
}

/// The reference shares no code with either form.
#[test]
fn factors_equal_the_reference_in_f64() {
    let mut over = vec![];
    for case in cases() {
        let factored = case.evaluate(Precision::F64, Form::Factored);
        let mut worst: f64 = 0.0;
        for (i, candidate) in case.population.rows().enumerate() {
            let expected = reference::costs(&case.problem, &case.log, candidate);
            assert_eq!(expected.is_ok(), factored.status(i).is_ok(), "{}: status of {candidate:?}", case.name);
            for (found, expected) in factored.costs(i).iter().zip(expected.unwrap_or_default()) {
                worst = worst.max(relative(*found, expected));
            }
        }
        println!("{:50} {worst:.1e}", case.name);
        if worst > 1e-9 {
            over.push(case.name);
        }
    }
    assert!(over.is_empty(), "over 1e-9: {over:?}");
}

/// r = 0 (a perfect sensor) and q = 0 at once: pivots vanish, nothing may divide by them.
#[test]
fn perfect_sensors_and_states_without_noise_stay_exact() {
    let case = cases().swap_remove(13);
    assert_eq!(case.name, "a state that becomes known exactly");
    let mut evaluator = case.evaluator(Precision::F64, Some(Form::Factored));
    for (q, r, m) in [(0.5, 0.0, 0.5), (0.5, 1.0, 0.0), (0.0, 1.0, 0.0), (0.5, 0.0, 0.0), (0.0, 1.0, 0.5)] {
        let population = kfgpu::evaluate::Population::from_rows(3, vec![q, r, m]);
        let mut problem = case.problem.clone();
        problem.tune.objectives.truncate(4);
        let expected = reference::costs(&problem, &case.log, &[q, r, m]).unwrap();
        let mut evaluator_of_four =
            Case { problem, log: case.log.clone(), name: case.name.clone(), population: population.clone() }
                .evaluator(Precision::F64, Some(Form::Factored));
        let found = kfgpu::evaluate::Evaluator::evaluate(&mut evaluator_of_four, &population);
        for (a, b) in found.costs(0).iter().zip(&expected) {
            assert!(relative(*a, *b) < 1e-9, "q = {q}, r = {r}, sqrt P0 = {m}: {a} against {b}");
        }
    }
    let _ = &mut evaluator;
}
