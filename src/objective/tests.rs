//! Objectives at the edges of their definitions, lanes against the reference.

use crate::data::{Log, Table, Trajectory};
use crate::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Population, Status};
use crate::model::Problem;
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
    let problem = problem("[\"nees\", \"nll\"]");
    let log = log(&[&[[1.0, 2.0, NAN, NAN], [NAN, 1.0, 0.5, 1.5], [NAN, NAN, 0.6, NAN]]]);
    assert_equal(&problem, &log, [0.0, 0.5]);
}

/// A Q below 0 can leave S positive and P not: NEES would come out negative, and look good.
#[test]
fn nees_of_an_indefinite_covariance_fails() {
    let problem = problem("[\"nees\", \"nll\"]");
    let log = log(&[&[[1.0, 2.0, 0.5, 1.5], [NAN, 1.0, 0.5, 1.5]]]);
    let reference = reference::costs(&problem, &log, &[0.5, -0.9]).unwrap();
    assert!(reference[0].is_nan() && reference[1].is_finite(), "undefined: {reference:?}");
    assert!(!evaluate(&problem, &log, [0.5, -0.9]).status(0).is_ok(), "so the candidate is not usable");
    assert_equal(&problem, &log, [0.5, 0.5]);
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
