//! Robust updates, every kind around every sort of filter: lanes of both precisions against the reference.

use crate::case::{Case, Refusal};
use crate::cases::robust::every;
use crate::evaluate;
use crate::promise::{double, single, unequal_status, worst};
use kfgpu::evaluate::Precision;
use kfgpu::reference::amplification;
use rayon::prelude::*;

#[test]
fn robust_updates_are_those_of_the_reference() {
    let wrong: Vec<String> = every(|_| true).par_iter().flat_map(judge).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Sentences on what is wrong with a case.
fn judge(case: &Case) -> Vec<String> {
    let mut costs = case.reference();
    let failed = costs.iter().filter(|costs| costs.is_err()).count();
    let mut wrong = Vec::new();
    if failed > 3 {
        wrong.push(format!("{}: {failed} candidates fail: {:?}", case.name, costs.iter().find(|c| c.is_err())));
    }
    let found = evaluate(case, Precision::F64);
    wrong.extend(unequal_status(case, &costs, &found));
    let exact = worst(case, &costs, &found, double);
    // Single precision promises nothing of a filter that has lost its track, where rounding decides which rows it rejects.
    let mut lost = 0;
    for (candidate, costs) in case.population.rows().zip(&mut costs) {
        let grows = amplification(&case.problem, &case.log, candidate).map_or(f64::INFINITY, |found| found);
        if costs.is_ok() && grows >= 1.0 {
            (*costs, lost) = (Err(Refusal::NotFinite), lost + 1);
        }
    }
    let rounded = worst(case, &costs, &evaluate(case, Precision::F32), single);
    println!("{:40} {exact:.1e} of the promise in f64, {rounded:.1e} in f32; {lost} amplify", case.name);
    // Under a diffuse start correntropy weighs its first rows by exp(-NIS / 2 k^2) of a NIS that P0 alone decides: 12 times the promise.
    let single = if case.name.starts_with("correntropy, climb, diffuse") { 20.0 } else { 1.0 };
    for (precision, error, limit) in [(Precision::F64, exact, 1.0), (Precision::F32, rounded, single)] {
        if error.is_nan() || error > limit {
            wrong.push(format!("{}: {precision} {error:.2e} times the promise", case.name));
        }
    }
    if lost > 6 {
        wrong.push(format!("{}: {lost} candidates amplify rounding", case.name));
    }
    wrong
}
