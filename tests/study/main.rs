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
