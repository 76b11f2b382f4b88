//! Whole studies of shipped problems, with the CPU evaluator and the f64 reference, against known optima.

use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use kfgpu::data::{Log, simulate};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Precision};
use kfgpu::model::{Problem, TuneSpec};
use kfgpu::reference;
use kfgpu::study::{self, Judge, Outcome, StopReason, Study};

fn open(name: &str) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let problem = Problem::open(&folder.join(name)).expect("a problem");
    let log = if problem.data.file.is_some() {
        Log::open(&problem.data, &folder)
    } else {
        Ok(simulate(&problem, None).expect("a log"))
    };
    (problem, log.expect("a log"))
}

fn tune((problem, log): &(Problem, Log), spec: &TuneSpec, options: CpuOptions) -> Outcome {
    let evaluator = |options| CpuEvaluator::new(problem, log, options).expect("traced");
    let mut searcher = evaluator(options);
    let mut polisher = evaluator(CpuOptions { precision: Precision::F64, ..options });
    let oracle = |candidate: &[f64]| reference::costs(problem, log, candidate).ok();
    let judge = Judge { oracle: &oracle, polisher: Some(&mut polisher) };
    let study = Study { parameters: &problem.parameters, tune: spec };
    study::run(&study, &mut searcher, judge, &mut [], &AtomicBool::new(false)).expect("an outcome")
}

/// The exact optimum of the local level model with a1 = 0, P1 = 1e7 is (15099.687, 1468.501), nll 641.5855783461.
#[test]
fn nile_reaches_the_known_optimum() {
    let case = open("nile.toml");
    let precisions = [Precision::F64, Precision::F32];
    for (algorithm, precision) in ["pso", "pio+"].into_iter().flat_map(|name| precisions.map(|p| (name, p))) {
        for seed in 0..3 {
            let spec = TuneSpec { algorithm: algorithm.to_owned(), seed, ..case.0.tune.clone() };
            let outcome = tune(&case, &spec, CpuOptions { precision, threads: None });
            let winner = outcome.winner.expect("a winner");
            let (nll, gap) = (winner.objectives[0], winner.certificate.largest_relative_gap);
            println!("{algorithm} {precision} seed {seed}: nll {nll:.10} at {:.3?}, gap {gap:.1e}", winner.candidate);
            assert_eq!(outcome.stop, StopReason::Generations);
            assert!((641.585_578_346..=641.585_578_347).contains(&nll), "{algorithm} {precision} seed {seed}: {nll}");
            for (found, known) in winner.candidate.iter().zip([15099.687, 1468.501]) {
                assert!(
                    (found / known - 1.0).abs() < 1e-5,
                    "{algorithm} {precision} seed {seed}: {found}, not {known}"
                );
            }
            assert!(winner.certificate.order_held);
            assert!(
                gap < if precision == Precision::F64 { 1e-14 } else { 1e-7 },
                "7e-16 and 1.7e-8 measured, {gap:e} found"
            );
        }
    }
}

/// Optima that other programs found (tests/data/README.md): nll, and parameters to the digits given there.
const OPTIMA: [(&str, f64, &[f64]); 3] = [
    ("missing_years", 192.991_876_497, &[59.166_105, 12.834_858, 0.654_779]),
    ("regression", 266.117_403_131, &[1.270_677, 0.038_019_97, 0.005_087_30, 0.000_863_76]),
    ("hedge_ratio", 328.483_199_070, &[1.124_442e-5, 0.048_542_6]),
];

fn open_data(name: &str) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let problem = Problem::open(&folder.join(format!("{name}.toml"))).expect("a problem");
    let log = Log::open(&problem.data, &folder).expect("a log");
    (problem, log)
}

/// nll is flat at its optimum: what polish leaves of the parameters is some 1e-4 where of nll it is 1e-6.
fn expect_nll(name: &str, found: f64, known: f64) {
    assert!((found - known).abs() < 1e-5, "{name}: nll {found}, and another program found {known}");
}

#[test]
fn optima_of_other_programs_are_reached() {
    for (name, nll, parameters) in OPTIMA {
        let case = open_data(name);
        let outcome = tune(&case, &case.0.tune, CpuOptions { precision: Precision::F64, threads: None });
        let winner = outcome.winner.expect("a winner");
        expect_nll(name, winner.objectives[0], nll);
        for (found, known) in winner.candidate.iter().zip(parameters) {
            assert!((found / known - 1.0).abs() < 1e-3, "{name}: {:?}, not {parameters:?}", winner.candidate);
        }
    }
}

/// By their lower factors, whose signs are free.
#[test]
fn full_covariances_of_another_program_are_reached() {
    let case = open_data("two_cameras");
    let outcome = tune(&case, &case.0.tune, CpuOptions { precision: Precision::F64, threads: None });
    let winner = outcome.winner.expect("a winner");
    expect_nll("two_cameras", winner.objectives[0], 1583.109_420_232);
    let [q, r] = [&winner.candidate[..3], &winner.candidate[3..]];
    let product = |l: &[f64]| [l[0] * l[0], l[0] * l[1], l[1] * l[1] + l[2] * l[2]];
    let known = [[2.934_43, 2.405_52, 3.287_82], [10.106_47, -2.541_38, 3.277_36]];
    for (found, known) in [product(q), product(r)].iter().flatten().zip(known.iter().flatten()) {
        assert!((found / known - 1.0).abs() < 2e-3, "{:?}: {found}, not {known}", winner.candidate);
    }
}

/// One seed gives one result, whatever the number of threads.
#[test]
fn threads_change_no_bit() {
    let case = open("rocket.toml");
    for precision in [Precision::F64, Precision::F32] {
        let with = |threads| {
            let spec = TuneSpec { population: 100, generations: 10, ..case.0.tune.clone() };
            let outcome = tune(&case, &spec, CpuOptions { precision, threads: NonZero::new(threads) });
            let history: Vec<_> = outcome.history.iter().map(|row| (row.best, row.median, row.failed)).collect();
            (outcome.winner.expect("a winner"), outcome.baseline, history)
        };
        assert_eq!(with(1), with(3), "{precision}");
    }
}
