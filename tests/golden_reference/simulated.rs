//! Simulated logs have the moments of their model, and the filter of the true model finds them consistent.

use kfgpu::data::Log;
use kfgpu::model::{Expr, Problem, SimulateSpec};
use kfgpu::reference::{Scope, evaluate, run};
use kfgpu::report::{Consistency, Verdict};
use kfgpu::simulate::{SimulateError, simulate};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

use super::support::{Linear, matrix, vector};

/// Position and speed with correlated noises; Q has rank 1.
fn model() -> Linear {
    Linear {
        f: matrix([[1.0, 1.0], [0.0, 0.9]]),
        b: DMatrix::zeros(2, 0),
        q: matrix([[0.25, 0.5], [0.5, 1.0]]),
        h: matrix([[1.0, 0.0], [0.5, 0.0]]),
        d: DMatrix::zeros(2, 0),
        offset: vector([100.0, -50.0]),
        r: matrix([[4.0, -1.5], [-1.5, 1.0]]),
        start: Some(vector([1.0, 2.0])),
        p0: matrix([[9.0, 3.0], [3.0, 2.0]]),
        ..Linear::level(0.0, 1.0, 1.0)
    }
}

fn problem(steps: usize, trajectories: usize) -> Problem {
    let mut problem = model().problem();
    problem.simulate = Some(SimulateSpec {
        steps,
        dt: 0.5,
        parameters: Vec::new(),
        x0: None,
        q: None,
        missing: 0.0,
        skip_first: false,
        trajectories,
        seed: 11,
    });
    problem
}

fn spec(problem: &mut Problem) -> &mut SimulateSpec {
    problem.simulate.as_mut().expect("set by problem()")
}

fn draw(problem: &Problem) -> Log {
    simulate(problem, None).expect("the log can be drawn")
}

/// Bits of every number, so that NaN compares too.
fn bits(log: &Log) -> Vec<u64> {
    let rows = log.trajectories.iter().flat_map(|t| (0..t.len()).map(move |k| (t, k)));
    rows.flat_map(|(t, k)| t.z.row(k).iter().chain(t.truth.row(k)).map(|v| v.to_bits())).collect()
}

/// The mean of vectors is `mean` and their covariance `expected`, within five standard errors.
fn check_moments(what: &str, samples: &[DVector<f64>], mean: &DVector<f64>, expected: &DMatrix<f64>) {
    let count = f64::from(u32::try_from(samples.len()).expect("few"));
    let found = samples.iter().sum::<DVector<f64>>() / count;
    let covariance: DMatrix<f64> =
        samples.iter().map(|s| (s - mean) * (s - mean).transpose()).sum::<DMatrix<f64>>() / count;
    for i in 0..mean.len() {
        let error = 5.0 * (expected[(i, i)] / count).sqrt();
        assert!((found[i] - mean[i]).abs() < error, "{what}: mean {found}, expected {mean}");
        for j in 0..mean.len() {
            let variance = expected[(i, i)] * expected[(j, j)] + expected[(i, j)].powi(2);
            let error = 5.0 * (variance / count).sqrt();
            let difference = (covariance[(i, j)] - expected[(i, j)]).abs();
            assert!(difference < error, "{what}: covariance {covariance}, expected {expected}");
        }
    }
}

#[test]
fn noises_have_the_moments_of_the_model() {
    let (model, log) = (model(), draw(&problem(20_000, 1)));
    let t = &log.trajectories[0];
    assert_eq!((t.len(), t.time[3].to_bits()), (20_001, 1.5f64.to_bits()), "steps come after row 0");
    let truth = |k: usize| DVector::from_column_slice(t.truth.row(k));
    let w: Vec<_> = (1..t.len()).map(|k| truth(k) - &model.f * truth(k - 1)).collect();
    check_moments("process noise", &w, &DVector::zeros(2), &model.q);
    let v: Vec<_> =
        (0..t.len()).map(|k| DVector::from_column_slice(t.z.row(k)) - &model.h * truth(k) - &model.offset).collect();
    check_moments("measurement noise", &v, &DVector::zeros(2), &model.r);
}

#[test]
fn initial_states_are_drawn_from_x0_and_p0_or_given() {
    let mut problem = problem(1, 4_000);
    let log = draw(&problem);
    let first: Vec<_> = log.trajectories.iter().map(|t| DVector::from_column_slice(t.truth.row(0))).collect();
    check_moments("initial state", &first, &vector([1.0, 2.0]), &model().p0);
    assert_eq!((log.trajectories[0].id.as_str(), log.trajectories[1].line[0]), ("1", 4), "ids and lines run on");
    spec(&mut problem).x0 = Some(vec![7.0, 8.0]);
    assert_eq!(draw(&problem).trajectories[9].truth.row(0), [7.0, 8.0], "x0 of [simulate] is exact");
}

#[test]
fn gaps_have_their_share_and_change_nothing_else() {
    let (mut with_gaps, whole) = (problem(20_000, 1), draw(&problem(20_000, 1)));
    spec(&mut with_gaps).missing = 0.2;
    spec(&mut with_gaps).skip_first = true;
    let log = draw(&with_gaps);
    let (gappy, whole) = (&log.trajectories[0], &whole.trajectories[0]);
    assert!(gappy.z.row(0).iter().all(|z| z.is_nan()), "row 0 has no measurement");
    let cells = (1..gappy.len()).flat_map(|k| gappy.z.row(k).iter().zip(whole.z.row(k)));
    let missing = cells.filter(|(z, full)| {
        assert!(z.is_nan() || z.to_bits() == full.to_bits(), "a gap moved a measurement");
        z.is_nan()
    });
    let share = f64::from(u32::try_from(missing.count()).expect("few")) / 40_000.0;
    assert!((share - 0.2).abs() < 5.0 * (0.2 * 0.8 / 40_000f64).sqrt(), "share missing is {share}");
}

#[test]
fn the_seed_decides_every_bit_and_a_longer_log_begins_with_the_shorter() {
    let (short, long) = (bits(&draw(&problem(50, 1))), bits(&draw(&problem(80, 1))));
    assert_eq!(short, bits(&draw(&problem(50, 1))), "same seed, same bits");
    assert_eq!(short[..], long[..short.len()], "rows do not depend on the number of steps");
    let other = simulate(&problem(50, 1), Some(12)).expect("drawn");
    assert_ne!(short, bits(&other), "another seed, another log");
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let error = |change: &dyn Fn(&mut Problem)| {
        let mut problem = problem(5, 1);
        change(&mut problem);
        simulate(&problem, None).expect_err("cannot be drawn")
    };
    assert!(matches!(error(&|p| p.simulate = None), SimulateError::NoTable { .. }), "no table");
    let unknown = error(&|p| spec(p).parameters.push(("rr".into(), 1.0)));
    assert!(matches!(unknown, SimulateError::UnknownParameter { .. }), "{unknown}");
    let with_inputs = Linear { b: matrix([[1.0], [0.0]]), ..model() }.problem().model;
    assert_eq!(error(&|p| p.model = with_inputs.clone()), SimulateError::Inputs { count: 1 }, "inputs");
    let indefinite = Linear { q: matrix([[1.0, 2.0], [2.0, 1.0]]), ..model() }.problem().model;
    assert_eq!(error(&|p| p.model = indefinite.clone()), SimulateError::NotCovariance { what: "Q" }, "indefinite Q");
    let from_measurement = Linear { start: None, ..model() }.problem().model;
    assert_eq!(error(&|p| p.model = from_measurement.clone()), SimulateError::NoInitialState, "no x0");
}

#[test]
fn the_true_filter_is_consistent_and_a_wrong_one_is_not() {
    let problem = problem(2_000, 1);
    let log = draw(&problem);
    let verdict = |model: Linear| {
        let problem = model.problem();
        let consistency = Consistency::of(&problem, &log, &[], &run(&problem, &log, &[]).expect("runs"));
        println!("{consistency}");
        consistency.verdict
    };
    assert_eq!(verdict(model()), Verdict::Consistent, "the filter that drew the log");
    assert_eq!(verdict(Linear { r: model().r * 0.5, ..model() }), Verdict::Overconfident, "R too small");
    assert_eq!(verdict(Linear { r: model().r * 2.0, ..model() }), Verdict::Underconfident, "R too large");
}

/// The turning target of `tests/data/nonlinear`, around pi: what is left of each step and of each measurement has the moments
/// of Q and R, and bearings are in [-pi, pi).
#[test]
fn a_nonlinear_model_is_drawn_by_its_formulas() {
    let simulated = "kind = \"cubature\"\n[simulate]\nsteps = 30\ndt = 1\ntrajectories = 150\nseed = 4\nx0 = [-2000, 0, 30, 5, 0.05]";
    let (problem, _) = super::nonlinear::problem("ct", simulated);
    let log = draw(&problem);
    let parameters = problem.parameters.resolve(&problem.parameters.baseline());
    let values = |formulas: &[Expr], x: &[f64]| {
        let scope = Scope { states: x, parameters: &parameters, inputs: &[], dt: 1.0 };
        DVector::from_iterator(formulas.len(), formulas.iter().map(|f| evaluate(f, &scope)))
    };
    let square = |formulas: &[Expr], n: usize| DMatrix::from_column_slice(n, n, values(formulas, &[]).as_slice());
    let (mut steps, mut noises, mut seam) = (Vec::new(), Vec::new(), false);
    for t in &log.trajectories {
        for k in 0..t.len() {
            let x = t.truth.row(k);
            let mut noise = DVector::from_column_slice(t.z.row(k)) - values(&problem.model.h, x);
            assert!((-PI..PI).contains(&t.z.row(k)[1]), "a bearing of {}", t.z.row(k)[1]);
            seam |= noise[1].abs() > PI;
            noise[1] -= TAU * (noise[1] / TAU).round();
            noises.push(noise);
            if k > 0 {
                steps.push(DVector::from_column_slice(x) - values(&problem.model.f, t.truth.row(k - 1)));
            }
        }
    }
    assert!(seam, "some bearing lies on the other side of pi");
    check_moments("process noise", &steps, &DVector::zeros(5), &square(&problem.model.q, 5));
    check_moments("measurement noise", &noises, &DVector::zeros(2), &square(&problem.model.r, 2));
}

/// Where f or h has no value there is no log, and a sentence says where.
#[test]
fn a_nonlinear_model_that_leaves_its_domain_is_told() {
    let simulated = "kind = \"extended\"\n[simulate]\nsteps = 3\ndt = 1\nx0 = [1e200, 0, 0, 0, 0]";
    let (problem, _) = super::nonlinear::problem("ct", simulated);
    assert_eq!(simulate(&problem, None), Err(SimulateError::NotFinite { row: 0 }));
}
