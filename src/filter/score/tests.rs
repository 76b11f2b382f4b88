//! Objectives at the edges of their definitions, lanes against the reference.

use crate::data::{Log, Table, Trajectory};
use crate::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Population, Precision, Status};
use crate::model::Problem;
use crate::objective::{Constraint, Kind, Objective};
use crate::reference;

const NAN: f64 = f64::NAN;

/// Two wandering states, both measured, the first with noise `r`, the second driven by `q`.
fn problem(objectives: &str) -> Problem {
    let text = format!(
        "[data]\nfile = \"none.csv\"\nmeasurements = [\"z1\", \"z2\"]\ntruth = {{ x = \"tx\", y = \"ty\" }}\n[model]\n\
         state = [\"x\", \"y\"]\nf = [\"x\", \"y\"]\nh = [\"x\", \"y\"]\nQ = [0.5, \"q\"]\nR = [\"r\", 1]\nx0 = [0, 0]\nP0 = [2, 2]\n\
         [parameters]\nr = {{ min = 0, max = 1, start = 0.5 }}\nq = {{ min = -1, max = 1, start = 0.5 }}\n[tune]\nobjectives = {objectives}\n"
    );
    Problem::parse(&text, "edge.toml").unwrap()
}

/// The same with the first sensor's deviation in place of its variance: R = M M' may be singular, and P after an update too.
fn exact(objectives: &str) -> Problem {
    let text = problem(objectives).text.replace("R = [\"r\", 1]", "R = { factor = \"M\", form = \"lower\" }");
    Problem::parse(&text.replace("r = {", "M21 = 0\nM22 = 1\nM11 = {"), "exact.toml").unwrap()
}

/// Rows of (z1, z2, true x, true y).
fn trajectory(rows: &[[f64; 4]]) -> Trajectory {
    let (mut z, mut u, mut truth) = (Table::new(2), Table::new(0), Table::new(2));
    for row in rows {
        z.push(&row[..2]);
        u.push(&[]);
        truth.push(&row[2..]);
    }
    let time: Vec<f64> = (0u32..).take(rows.len()).map(f64::from).collect();
    Trajectory { id: String::new(), line: vec![2; rows.len()], time, z, u, truth }
}

fn log(trajectories: &[&[[f64; 4]]]) -> Log {
    Log {
        source: "edge.csv".to_owned(),
        measurements: vec!["z1".to_owned(), "z2".to_owned()],
        inputs: vec![],
        truth: vec!["x".to_owned(), "y".to_owned()],
        trajectories: trajectories.iter().map(|rows| trajectory(rows)).collect(),
        ..Log::default()
    }
}

fn evaluate(problem: &Problem, log: &Log, candidate: [f64; 2]) -> Evaluation {
    let mut evaluator = CpuEvaluator::new(problem, log, CpuOptions::default()).unwrap();
    evaluator.evaluate(&Population::from_rows(2, candidate.to_vec()))
}

fn assert_equal(problem: &Problem, log: &Log, candidate: [f64; 2]) {
    let (found, expected) = (evaluate(problem, log, candidate), reference::costs(problem, log, &candidate).unwrap());
    assert_eq!(found.status(0), Status::OK, "the reference says {expected:?}");
    for (found, expected) in found.costs(0).iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-12, "found {found}, the reference says {expected}");
    }
}

/// Without noise P is singular after an update, and NEES is not defined there; where truth is unknown nobody asks for it.
#[test]
fn nees_asks_nothing_of_rows_without_truth() {
    let problem = exact("[\"nees\", \"nll\"]");
    let log = log(&[&[[1.0, 2.0, NAN, NAN], [NAN, 1.0, 0.5, 1.5], [NAN, NAN, 0.6, NAN]]]);
    assert_equal(&problem, &log, [0.0, 0.5]);
}

/// Where P is singular NEES is not defined, however good the likelihood.
#[test]
fn nees_of_a_singular_covariance_fails() {
    let problem = exact("[\"nees\", \"nll\"]");
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5]]]);
    let reference = reference::costs(&problem, &log, &[0.0, 0.5]).unwrap();
    assert!(reference[0].is_nan() && reference[1].is_finite(), "undefined: {reference:?}");
    assert_eq!(evaluate(&problem, &log, [0.0, 0.5]).status(0), Status::NOT_POSITIVE, "so the candidate is not usable");
    assert_equal(&problem, &log, [0.5, 0.5]);
}

/// A Q below 0 can leave S positive: the likelihood would look good, NEES come out negative.
#[test]
fn what_is_no_covariance_fails_whatever_is_scored() {
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5]]]);
    for objectives in ["[\"nll\"]", "[\"nees\"]", "[\"mse_innovation\", \"rmse\"]"] {
        let problem = problem(objectives);
        for (candidate, matrix) in [([0.5, -0.1], "Q"), ([-0.1, 0.5], "R"), ([0.0, 0.5], "R"), ([NAN, 0.5], "R")] {
            let failure = reference::costs(&problem, &log, &candidate).unwrap_err();
            assert_eq!(failure.what, reference::Cause::NotCovariance { matrix }, "{candidate:?}");
            for precision in [Precision::F64, Precision::F32] {
                let options = CpuOptions { precision, ..CpuOptions::default() };
                let mut lanes = CpuEvaluator::new(&problem, &log, options).unwrap();
                let found = lanes.evaluate(&Population::from_rows(2, candidate.to_vec()));
                assert_eq!(found.status(0), Status::NOT_POSITIVE, "{candidate:?} in {precision}");
            }
        }
        assert_equal(&problem, &log, [0.5, 0.0]);
    }
}

#[test]
fn a_distance_over_no_rows_is_not_zero() {
    let problem = problem("[{ name = \"distance\", skip = 2 }]");
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5]]]);
    assert!(reference::costs(&problem, &log, &[0.5, 0.5]).unwrap()[0].is_nan(), "nothing scores");
    assert!(!evaluate(&problem, &log, [0.5, 0.5]).status(0).is_ok(), "so there is no cost");
}

#[test]
fn mismatch_leaves_out_trajectories_without_measurements() {
    let rows = [[1.0, 2.0, NAN, NAN], [2.0, 1.0, NAN, NAN], [0.0, NAN, NAN, NAN]];
    let empty = [[NAN; 4]; 3];
    for options in ["", ", window = 1", ", ct = \"last\"", ", skip = 2"] {
        let problem = problem(&format!("[{{ name = \"mismatch\"{options} }}]"));
        assert_equal(&problem, &log(&[&empty, &rows, &rows[..1], &rows[1..], &empty]), [0.5, 0.5]);
    }
}

/// By what lanes trace, in both precisions, against the reference: the violation of a candidate, and its cost.
#[test]
fn a_mean_is_what_its_distance_from_one_is_taken_of() {
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5], [3.0, 1.5, 0.6, 1.2]]]);
    let plain = problem("[\"nll\", \"nis\", \"nees\"]");
    // 0 as limit makes a violation the value itself.
    for (constraints, of) in [("nis_mean <= 0", 1), ("nees_mean <= 0", 2)] {
        let bounded = problem(&format!("[\"nll\", \"nis\", \"nees\"]\nconstraints = [\"{constraints}\"]"));
        for candidate in [[0.5, 0.5], [0.1, 0.9], [1.0, 0.1]] {
            let (found, without) = (evaluate(&bounded, &log, candidate), evaluate(&plain, &log, candidate));
            assert_eq!(found.costs(0), without.costs(0), "a constraint changes no bit of a cost");
            let distance = (found.violation(0) - 1.0).abs();
            assert!((distance - found.costs(0)[of]).abs() < 1e-12, "{constraints}: {distance}");
            let scores = reference::scores(&bounded, &log, &candidate).unwrap();
            assert_eq!(scores[..3], reference::costs(&bounded, &log, &candidate).unwrap());
            assert!((scores[3] - found.violation(0)).abs() < 1e-12, "{constraints}: {scores:?}");
        }
    }
}

#[test]
fn violations_are_those_of_the_reference() {
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5], [3.0, 1.5, 0.6, 1.2]]]);
    let bounds = "[\"nis_mean <= 0.25\", { name = \"rmse\", states = [\"x\"], skip = 1, min = 2, max = 0.1 }]";
    let problem = problem(&format!("[\"nll\"]\nconstraints = {bounds}"));
    let population = Population::from_rows(2, vec![0.5, 0.5, 0.1, 0.9, 1.0, 0.1]);
    for (precision, tolerance) in [(Precision::F64, 1e-12), (Precision::F32, 1e-5)] {
        let options = CpuOptions { precision, ..CpuOptions::default() };
        let found = CpuEvaluator::new(&problem, &log, options).unwrap().evaluate(&population);
        for (i, candidate) in population.rows().enumerate() {
            let scores = reference::scores(&problem, &log, candidate).unwrap();
            let expected = Constraint::total_violation(&problem.tune.constraints, &scores[1..]);
            let off = (found.violation(i) / expected - 1.0).abs();
            assert!(expected > 0.0 && off < tolerance, "{precision}: {} of {expected}", found.violation(i));
        }
    }
}

/// NEES is no number where P is singular: no bound on it is met.
#[test]
fn a_bound_on_what_has_no_value_is_not_met() {
    let problem = exact("[\"nll\"]\nconstraints = [\"nees_mean <= 1e9\"]");
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5]]]);
    let found = evaluate(&problem, &log, [0.0, 0.5]);
    assert!(found.violation(0).is_infinite(), "{}", found.violation(0));
}

/// One row ahead is the innovation, in rows of every kind and after a start from a measurement.
#[test]
fn a_prediction_of_one_row_is_the_innovation_to_the_bit() {
    let rows = [[1.0, 2.0, NAN, NAN], [NAN, 1.0, NAN, NAN], [3.0, 1.5, NAN, NAN], [NAN; 4], [2.0, NAN, NAN, NAN]];
    let log = log(&[&rows, &rows[2..], &rows[..1]]);
    for skip in [0, 1] {
        let one = format!(
            "[{{ name = \"mse_innovation\", skip = {skip} }}, {{ name = \"prediction\", ahead = 1, skip = {skip} }}]"
        );
        for x0 in ["x0 = [0, 0]", "x0 = \"measurement\""] {
            let text = problem(&one).text.replace("x0 = [0, 0]", x0);
            let problem = Problem::parse(&text, "one.toml").unwrap();
            for precision in [Precision::F64, Precision::F32] {
                let options = CpuOptions { precision, ..CpuOptions::default() };
                let mut lanes = CpuEvaluator::new(&problem, &log, options).unwrap();
                let found = lanes.evaluate(&Population::from_rows(2, vec![0.5, 0.7]));
                let [mse, prediction] = [0, 1].map(|i| found.costs(0)[i].to_bits());
                assert_eq!(mse, prediction, "{x0}, skip {skip}, {precision}: {:?}", found.costs(0));
            }
            let [mse, prediction] = reference::costs(&problem, &log, &[0.5, 0.7]).unwrap()[..] else { panic!("two") };
            assert_eq!(mse.to_bits(), prediction.to_bits(), "reference: {mse} and {prediction}");
        }
    }
}

/// What objectives and constraints share is carried once.
#[test]
fn a_memory_is_shared() {
    let rows = [[1.0, 2.0, NAN, NAN], [NAN, 1.0, NAN, NAN], [3.0, 1.5, NAN, NAN], [0.5, 0.5, NAN, NAN]];
    let log = log(&[&rows]);
    let carried = |objectives: &[Objective]| {
        let program = crate::filter::trace(&problem("[\"nll\"]"), &log, objectives, None).unwrap();
        let memory = program.carried().iter().filter(|c| c.name.contains('-') && c.role == crate::filter::Role::State);
        memory.count()
    };
    let whiteness = |lags| Objective { lags, ..Objective::new(Kind::Whiteness) };
    let prediction = |ahead: &[usize]| Objective { ahead: ahead.to_vec(), ..Objective::new(Kind::Prediction) };
    assert_eq!(carried(&[whiteness(2)]), 2 * 2, "two components");
    assert_eq!(carried(&[whiteness(2), whiteness(3)]), 2 * 3);
    assert_eq!(carried(&[prediction(&[1])]), 0, "the innovation needs none");
    assert_eq!(carried(&[prediction(&[2, 3]), prediction(&[3])]), 2 * 2, "two states");
}
