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
mod many;
mod promise;
mod robust;

use case::{Case, Costs, Double, Single};
use kfgpu::evaluate::{BuildError, CpuEvaluator, CpuOptions, Evaluation, Evaluator, Precision};
use kfgpu::objective::Kind;
use promise::{double, misplaced, single, unequal_status, worst};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Set, only cases whose name begins so are run.
const ONLY: &str = "KFGPU_PARITY_ONLY";

/// Every case with the reference's costs.
fn cases() -> &'static [(Case, Costs)] {
    static CASES: OnceLock<Vec<(Case, Costs)>> = OnceLock::new();
    CASES.get_or_init(|| {
        let with_costs = |case: Case| {
            let costs = case.reference();
            (case, costs)
        };
        let only = std::env::var(ONLY).unwrap_or_default();
        let mut cases = cases::all();
        cases.retain(|case| case.name.starts_with(&only));
        cases.into_par_iter().map(with_costs).collect()
    })
}

fn build(case: &Case, precision: Precision) -> Result<CpuEvaluator, BuildError> {
    CpuEvaluator::new(&case.problem, &case.log, CpuOptions { precision, threads: std::num::NonZero::new(1) })
}

fn evaluate(case: &Case, precision: Precision) -> Evaluation {
    build(case, precision).unwrap_or_else(|error| panic!("{}: {error}", case.name)).evaluate(&case.population)
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
    assert!(refused.len() >= 2, "after gaps that are too long for it");
    for case in refused {
        let error = build(case, Precision::F32).err();
        assert!(
            matches!(&error, Some(BuildError::Trace(error)) if error.needs_f64()),
            "{}: {error:?}, not a request for f64",
            case.name
        );
    }
}
