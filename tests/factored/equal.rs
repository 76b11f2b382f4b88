//! In f64 the factors carry what P carries, for every shape of problem; and both are the reference's filter.

use crate::case::Case;
use crate::shapes::{known, shapes};
use kfgpu::evaluate::{Evaluation, Population, Precision, Status};
use kfgpu::filter::Form;
use kfgpu::objective::Kind;
use kfgpu::reference;

fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(1.0)
}

/// Largest relative difference of the usable costs; statuses must agree.
fn worst(case: &Case, found: &Evaluation, expected: &Evaluation) -> f64 {
    let mut worst: f64 = 0.0;
    for i in 0..case.population.len() {
        let candidate = case.population.row(i);
        assert_eq!(found.status(i), expected.status(i), "{}: status of {candidate:?}", case.name);
        for (a, b) in found.costs(i).iter().zip(expected.costs(i)) {
            worst = worst.max(relative(*a, *b));
        }
    }
    worst
}

#[test]
fn factors_equal_the_full_form_in_f64() {
    let mut over = vec![];
    for case in shapes() {
        let full = case.evaluate(Precision::F64, Form::Full);
        let factored = case.evaluate(Precision::F64, Form::Factored);
        let error = worst(&case, &factored, &full);
        println!("{:50} {error:.1e}", case.name);
        if error > 1e-11 {
            over.push(case.name);
        }
    }
    assert!(over.is_empty(), "over 1e-11: {over:?}");
}

/// The reference shares no code with either form.
#[test]
fn factors_equal_the_reference_in_f64() {
    let mut over = vec![];
    for case in shapes() {
        let factored = case.evaluate(Precision::F64, Form::Factored);
        let mut worst: f64 = 0.0;
        for (i, candidate) in case.population.rows().enumerate() {
            let expected = reference::costs(&case.problem, &case.log, candidate);
            assert_eq!(expected.is_ok(), factored.status(i).is_ok(), "{}: status of {candidate:?}", case.name);
            for (found, expected) in factored.costs(i).iter().zip(expected.unwrap_or_default()) {
                worst = worst.max(relative(*found, expected));
            }
        }
        println!("{:50} {worst:.1e}", case.name);
        if worst > 1e-11 {
            over.push(case.name);
        }
    }
    assert!(over.is_empty(), "over 1e-11: {over:?}");
}

/// A perfect sensor (r = 0), a state known from the start (m = 0), no process noise (q = 0), and all of it but one: pivots
/// vanish, and nothing may divide by them.
#[test]
fn vanishing_pivots_stay_exact() {
    for [q, r, m] in [[0.5, 0.0, 0.5], [0.5, 1.0, 0.0], [0.0, 1.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0]] {
        let mut case = known();
        // nees needs P^-1, which is not there.
        case.problem.tune.objectives.retain(|o| o.kind != Kind::Nees);
        case.population = Population::from_rows(3, vec![q, r, m]);
        let expected = reference::costs(&case.problem, &case.log, &[q, r, m]).unwrap();
        for (precision, tolerance) in [(Precision::F64, 1e-12), (Precision::F32, 1e-5)] {
            let found = case.evaluate(precision, Form::Factored);
            for (found, expected) in found.costs(0).iter().zip(&expected) {
                let error = relative(*found, *expected);
                assert!(error < tolerance, "q = {q}, r = {r}, m = {m}: {found} against {expected} in {precision}");
            }
        }
    }
}

/// A candidate whose Q or R is no covariance, and that the reference therefore cannot run, fails in both forms.
#[test]
fn indefinite_candidates_fail() {
    let forms = [Form::Full, Form::Factored];
    let pairs: Vec<(Precision, Form)> =
        [Precision::F32, Precision::F64].into_iter().flat_map(|p| forms.map(|form| (p, form))).collect();
    let mut failed = 0;
    for mut case in shapes().into_iter().filter(|c| c.population.dimension() == 2) {
        for bad in [[-1.0, 1.0], [0.1, -1.0], [-0.05, 0.5], [-0.01, 1.0]] {
            case.population = Population::from_rows(2, bad.to_vec());
            if reference::costs(&case.problem, &case.log, &bad).is_ok() {
                continue;
            }
            failed += 1;
            for (precision, form) in &pairs {
                let status = case.evaluate(*precision, *form).status(0);
                let is_not_positive = status.bits() & Status::NOT_POSITIVE.bits() != 0;
                assert!(is_not_positive, "{}, {bad:?}, {precision}: {status:?}", case.name);
            }
        }
    }
    assert!(failed >= 50, "most of the candidates are meant to fail: {failed}");
}
