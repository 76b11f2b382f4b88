//! The tape against the f64 reference, over every example and every log shape: costs, status and ranking.

mod cases;

use cases::{Case, cases};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Population, Precision};
use kfgpu::objective::Kind;
use kfgpu::reference;

fn evaluate(case: &Case, precision: Precision) -> Evaluation {
    let options = CpuOptions { precision, threads: None };
    let mut evaluator =
        CpuEvaluator::new(&case.problem, &case.log, options).unwrap_or_else(|error| panic!("{}: {error}", case.name));
    evaluator.evaluate(&case.population)
}

/// Worst error of a cost against the reference, in units of what semantics.md promises for its kind.
fn worst(case: &Case, evaluation: &Evaluation, tolerance: impl Fn(Kind, f64) -> f64) -> f64 {
    let mut worst: f64 = 0.0;
    for (i, candidate) in case.population.rows().enumerate() {
        let expected = reference::costs(&case.problem, &case.log, candidate);
        let Ok(expected) = expected else {
            assert!(
                !evaluation.status(i).is_ok(),
                "{}: the reference fails candidate {i}, the tape does not",
                case.name
            );
            continue;
        };
        assert!(evaluation.status(i).is_ok(), "{}: the tape fails candidate {i}: {candidate:?}", case.name);
        for ((objective, cost), expected) in case.problem.tune.objectives.iter().zip(evaluation.costs(i)).zip(expected)
        {
            let error = (cost - expected).abs() / tolerance(objective.kind, expected);
            if std::env::var_os("KFGPU_PARITY_PRINT").is_some() && error > 1.0 {
                println!("{} {i} {candidate:?} {}: {cost} against {expected}", case.name, objective.name());
            }
            worst = worst.max(error);
        }
    }
    worst
}

#[test]
fn f64_lanes_equal_the_reference() {
    let mut failed = Vec::new();
    for case in cases() {
        let evaluation = evaluate(&case, Precision::F64);
        let error = worst(&case, &evaluation, |_, expected| 1e-10 * expected.abs().max(1.0));
        println!("{:40} f64 {:.1e} of 1e-10", case.name, error);
        if error > 1.0 {
            failed.push(case.name.clone());
        }
    }
    assert!(failed.is_empty(), "over 1e-10: {failed:?}");
}

/// The promise of semantics.md: nll per step, f1, rmse, f2.
#[test]
fn f32_lanes_keep_the_promise() {
    let mut failed = Vec::new();
    for case in cases().into_iter().filter(|c| c.single) {
        let rows = case.log.rows() as f64;
        let evaluation = evaluate(&case, Precision::F32);
        let error = worst(&case, &evaluation, |kind, expected| match kind {
            Kind::Nll => 1e-5 * rows * (expected / rows).abs().max(1.0),
            Kind::Mismatch => 1e-3,
            Kind::Nis | Kind::Nees => 1e-4 * (1.0 + expected),
            _ => 1e-5 * expected,
        });
        println!("{:40} f32 {:.1e} of the promise", case.name, error);
        if error > 1.0 {
            failed.push(case.name.clone());
        }
    }
    assert!(failed.is_empty(), "promise broken: {failed:?}");
}

#[test]
fn populations_may_be_cut_and_shuffled() {
    for case in cases() {
        let whole = evaluate(&case, Precision::F64);
        let d = case.population.dimension();
        let options = CpuOptions { precision: Precision::F64, threads: std::num::NonZero::new(1) };
        let mut evaluator = CpuEvaluator::new(&case.problem, &case.log, options).unwrap();
        for size in [1, 7, 16, 200] {
            for (chunk, first) in [(size, 0), (size, 31)] {
                let n = case.population.len();
                let reversed: Vec<usize> = (first..(first + chunk).min(n)).rev().collect();
                let values = reversed.iter().flat_map(|i| case.population.row(*i).to_vec()).collect();
                let part = evaluator.evaluate(&Population::from_rows(d, values));
                for (at, i) in reversed.iter().enumerate() {
                    let bits = |costs: &[f64]| costs.iter().map(|c| c.to_bits()).collect::<Vec<_>>();
                    assert_eq!(
                        bits(part.costs(at)),
                        bits(whole.costs(*i)),
                        "{}: candidate {i} in blocks of {size}",
                        case.name
                    );
                }
            }
        }
    }
}
