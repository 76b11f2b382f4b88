//! The shipped problems through the reference: file, log, filter and verdict together.

use kfgpu::data::Log;
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{costs, run, score};
use kfgpu::report::{Consistency, Verdict};
use kfgpu::simulate::simulate;
use std::path::Path;

use super::support::close;

fn example(name: &str) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let problem = Problem::open(&folder.join(name)).expect("the example is valid");
    let log = if problem.data.file.is_some() {
        Log::open(&problem.data, &folder).expect("its log is valid")
    } else {
        simulate(&problem, None).expect("its log can be drawn")
    };
    (problem, log)
}

fn consistency(problem: &Problem, log: &Log, candidate: &[f64]) -> Consistency {
    Consistency::of(problem, log, candidate, &run(problem, log, candidate).expect("runs"))
}

/// statsmodels 0.15.0 and pykalman 0.11.2, as in `values.rs`, now from the files that users run.
#[test]
fn log_likelihoods_of_the_shipped_files() {
    let (nile, log) = example("nile.toml");
    let order = nile.parameters.names();
    let candidate: Vec<f64> = order.iter().map(|n| if *n == "sigma2_eps" { 15_099.0 } else { 1_469.1 }).collect();
    close(costs(&nile, &log, &candidate).expect("runs")[0], 641.585_578_459_4, 2e-10);
    for (file, expected) in [("robot.toml", 3_373.013_527_43), ("robot_em.toml", 3_189.452_517_86)] {
        let (problem, log) = example(file);
        let candidate = problem.parameters.baseline();
        let run = run(&problem, &log, &candidate).expect("runs");
        close(score(&problem, &log, &run, &[Objective::new(Kind::Nll)])[0], expected, 2e-7);
    }
}

/// Smallest nll over the second parameter (log scale, golden section) with the first fixed by the caller.
fn best_q(problem: &Problem, log: &Log, candidate: impl Fn(f64) -> Vec<f64>) -> f64 {
    let cost = |exponent: f64| costs(problem, log, &candidate(10f64.powf(exponent))).expect("runs")[0];
    let (mut low, mut high) = (-3.0, 3.0);
    for _ in 0..40 {
        let (a, b) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        if cost(a) < cost(b) { high = b } else { low = a }
    }
    10f64.powf(0.5 * (low + high))
}

/// A search for likelihood drives r to its bound and the mean NIS to 1, yet constant velocity is wrong for this log.
#[test]
fn constant_velocity_is_not_called_consistent_on_the_uav() {
    let (problem, log) = example("uav_gps_cv.toml");
    let q_first = problem.parameters.names()[0] == "q";
    let candidate = |r: f64| move |q: f64| if q_first { vec![q, r] } else { vec![r, q] };
    let at = |r: f64| {
        let tuned = candidate(r)(best_q(&problem, &log, candidate(r)));
        (costs(&problem, &log, &tuned).expect("runs")[0], tuned)
    };
    let lower = problem.parameters.searched().find(|(p, _)| p.name == "r").expect("r is searched").1.min;
    let (bound, inside) = (at(lower), at(1e-1));
    assert!(bound.0 < inside.0, "the likelihood prefers the bound: nll {} against {}", bound.0, inside.0);
    let found = consistency(&problem, &log, &bound.1);
    println!("{found}");
    let in_band = found.nis_low < found.nis_mean && found.nis_mean < found.nis_high;
    assert!(in_band, "mean NIS {} alone looks consistent", found.nis_mean);
    assert_eq!(found.verdict, Verdict::InnovationsCorrelated, "{found}");
    assert!(found.findings.iter().any(|f| f.verdict == Verdict::ParameterAtBound), "r is at its bound: {found}");
    let json = serde_json::to_value(&found).expect("plain data");
    assert_eq!(json["verdict"], "innovations_correlated", "the word that programs read");
    assert!(["nis_mean", "nis_low", "nis_high"].iter().all(|key| json[key].is_number()), "{json}");
    let lag_1 = found.whiteness.iter().map(|w| w.lag_1()).fold(f64::MIN, f64::max);
    assert!((lag_1 - 0.74).abs() < 0.05, "lag-1 autocorrelation {lag_1}");
}

/// The rocket's filter starts 10 m, 50 m/s and 20 m/s^2 off with a P0 that does not allow for it; its Q and R are true.
#[test]
fn a_wrong_start_is_told_from_wrong_noise() {
    let (problem, log) = example("rocket.toml");
    assert_eq!(log.rows(), 201, "200 steps after row 0");
    let found = consistency(&problem, &log, &[3.0]);
    assert_eq!((found.verdict, found.findings.len()), (Verdict::WrongStart, 1), "{found}");
    assert!(found.findings[0].advice.contains("P0 is too small for this x0, and Q and R fit"), "{found}");
    let worse = consistency(&problem, &log, &[0.5]);
    assert_eq!(worse.verdict, Verdict::Overconfident, "{worse}");
    assert!(worse.findings[0].advice.contains("Q or R is too small"), "{worse}");
}

/// Durbin and Koopman's conclusion on the Nile: the local level model fits.
#[test]
fn the_nile_is_consistent_at_its_optimum() {
    let (problem, log) = example("nile.toml");
    let found = consistency(&problem, &log, &[15_099.687, 1_468.501]);
    assert_eq!(found.verdict, Verdict::Consistent, "{found}");
}

#[test]
fn a_log_without_measurements_is_not_called_consistent() {
    let (problem, mut log) = example("nile.toml");
    log.trajectories[0].time.truncate(1);
    let mut empty = kfgpu::data::Table::new(1);
    empty.push(&[f64::NAN]);
    log.trajectories[0].z = empty;
    let found = consistency(&problem, &log, &problem.parameters.baseline());
    assert_eq!(found.verdict, Verdict::NothingMeasured, "{found}");
}
