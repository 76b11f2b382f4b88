//! The tape against the f64 reference, over the whole registry and every log shape: costs, status, ranking and bits.
//!
//! `cargo test --test parity -- --nocapture` prints the table of errors; `budget.csv` keeps it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the table of errors is a result")]

mod bits;
mod budget;
mod case;
mod cases;
mod logs;
mod long;

use case::{Case, Costs, Double, Single};
use kfgpu::evaluate::{BuildError, CpuEvaluator, CpuOptions, Evaluation, Evaluator, Precision};
use kfgpu::filter::TraceError;
use kfgpu::objective::Kind;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Every case with the reference's costs.
fn cases() -> &'static [(Case, Costs)] {
    static CASES: OnceLock<Vec<(Case, Costs)>> = OnceLock::new();
    CASES.get_or_init(|| {
        let with_costs = |case: Case| {
            let costs = case.reference();
            (case, costs)
        };
        cases::all().into_par_iter().map(with_costs).collect()
    })
}

fn build(case: &Case, precision: Precision) -> Result<CpuEvaluator, BuildError> {
    CpuEvaluator::new(&case.problem, &case.log, CpuOptions { precision, threads: std::num::NonZero::new(1) })
}

fn evaluate(case: &Case, precision: Precision) -> Evaluation {
    build(case, precision).unwrap_or_else(|error| panic!("{}: {error}", case.name)).evaluate(&case.population)
}

/// What f64 promises: 1e-10 of a cost, or of 1 where it is smaller.
fn double(_: &Case, _: Kind, expected: f64) -> f64 {
    1e-10 * expected.abs().max(1.0)
}

/// What f32 promises (semantics.md): nll per step, f1, rmse, f2. `distance` is held to what rmse is, `nis` and `nees`,
/// which nobody promised, to 1e-4.
fn single(case: &Case, kind: Kind, expected: f64) -> f64 {
    let rows = case.log.rows() as f64;
    match kind {
        Kind::Nll => 1e-5 * rows * (expected / rows).abs().max(1.0),
        Kind::Mismatch => 1e-3,
        Kind::Nis | Kind::Nees | Kind::NisMean => 1e-4 * (1.0 + expected),
        Kind::MseInnovation | Kind::Rmse | Kind::Distance => 1e-5 * expected,
    }
}

/// Sentences on candidates that one side fails and the other does not.
fn unequal_status(case: &Case, costs: &Costs, evaluation: &Evaluation) -> Vec<String> {
    let unequal = (0..costs.len()).filter(|i| evaluation.status(*i).is_ok() != costs[*i].is_some());
    let describe = |i: usize| {
        let (candidate, status, found) = (case.population.row(i), evaluation.status(i), evaluation.costs(i));
        format!("{}: candidate {i} {candidate:?}: lanes {status:?} {found:?}, reference {:?}", case.name, costs[i])
    };
    unequal.map(describe).collect()
}

/// Worst error of any cost in units of its promise.
fn worst(case: &Case, costs: &Costs, evaluation: &Evaluation, promise: fn(&Case, Kind, f64) -> f64) -> f64 {
    let mut worst: f64 = 0.0;
    for (i, expected) in costs.iter().enumerate() {
        let candidate = case.population.row(i);
        let Some(expected) = expected else { continue };
        for ((objective, cost), expected) in case.problem.tune.objectives.iter().zip(evaluation.costs(i)).zip(expected)
        {
            let error = (cost - expected).abs() / promise(case, objective.kind, *expected);
            if std::env::var_os("KFGPU_PARITY_PRINT").is_some() && error > 1.0 {
                println!("{} {i} {candidate:?} {}: {cost} against {expected}", case.name, objective.name());
            }
            worst = worst.max(error);
        }
    }
    worst
}

/// Pairs of candidates whose order the lanes turn round although the reference puts more than the promise between them.
fn misplaced(case: &Case, costs: &Costs, evaluation: &Evaluation, promise: fn(&Case, Kind, f64) -> f64) -> usize {
    let usable: Vec<usize> = (0..costs.len()).filter(|i| costs[*i].is_some()).collect();
    let mut found = 0;
    for (objective, k) in case.problem.tune.objectives.iter().zip(0..) {
        let expected = |i: usize| costs[i].as_ref().map_or(f64::NAN, |c| c[k]);
        for &a in &usable {
            let clear = |b: &&usize| expected(**b) - expected(a) > promise(case, objective.kind, expected(**b));
            let turned = |b: &&usize| evaluation.costs(**b)[k] <= evaluation.costs(a)[k];
            found += usable.iter().filter(clear).filter(turned).count();
        }
    }
    found
}

/// What a precision does to a case.
struct Finding {
    error: f64,
    misplaced: usize,
    unequal: Vec<String>,
}

fn findings(precision: Precision, promise: fn(&Case, Kind, f64) -> f64) -> Vec<(&'static Case, Finding)> {
    let find = |(case, costs): &'static (Case, Costs)| {
        let evaluation = evaluate(case, precision);
        let error = worst(case, costs, &evaluation, promise);
        let misplaced = misplaced(case, costs, &evaluation, promise);
        (case, Finding { error, misplaced, unequal: unequal_status(case, costs, &evaluation) })
    };
    let within = |c: &&(Case, Costs)| precision == Precision::F64 || c.0.single != Single::Refused;
    cases().par_iter().filter(within).map(find).collect()
}

/// Prints the table of a precision, holds it to the promise where `promised`, and to its record.
fn judge(precision: Precision, promise: fn(&Case, Kind, f64) -> f64, promised: fn(&Case) -> bool) {
    let (mut wrong, mut measured) = (Vec::new(), Vec::new());
    for (case, finding) in findings(precision, promise) {
        let Finding { error, misplaced, unequal } = finding;
        println!("{:60} {precision} {error:.1e} of the promise, {misplaced} pairs misplaced", case.name);
        if promised(case) {
            if error.is_nan() || error > 1.0 || misplaced > 0 {
                wrong.push(format!("{}: {error:.2e} times the promise, {misplaced} pairs misplaced", case.name));
            }
            wrong.extend(unequal);
        }
        measured.push((case.name.clone(), error));
    }
    wrong.extend(budget::compare(&precision.to_string(), &measured));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn f64_lanes_equal_the_reference() {
    judge(Precision::F64, double, |case| case.double == Double::Promised);
}

#[test]
fn f32_lanes_keep_the_promise_and_the_ranking() {
    judge(Precision::F32, single, |case| case.single == Single::Promised);
}

#[test]
fn what_single_precision_cannot_hold_is_refused() {
    let refused: Vec<&Case> = cases().iter().map(|(c, _)| c).filter(|c| c.single == Single::Refused).collect();
    assert!(refused.len() >= 2, "a parameter times irregular dt, and one times an input");
    for case in refused {
        let error = build(case, Precision::F32).err();
        assert!(
            matches!(error, Some(BuildError::Trace(TraceError::NeedsF64 { .. }))),
            "{}: {error:?}, not a request for f64",
            case.name
        );
    }
}
