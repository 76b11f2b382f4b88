//! What is promised of a cost, and how far costs are from it.

use crate::case::{Case, Costs, Refusal};
use kfgpu::evaluate::{Evaluation, Precision, Status};
use kfgpu::objective::Kind;

/// What f64 promises: 1e-10 of a cost, or of 1 where it is smaller.
pub(crate) fn double(case: &Case, kind: Kind, expected: f64) -> f64 {
    kind.resolution(Precision::F64, expected, case.log.rows())
}

/// What f32 promises (semantics.md): nll per step, f1, rmse, f2. `distance` is held to what rmse is, `nis` and `nees`,
/// which nobody promised, to 1e-4.
pub(crate) fn single(case: &Case, kind: Kind, expected: f64) -> f64 {
    kind.resolution(Precision::F32, expected, case.log.rows())
}

/// Sentences on candidates whose status is not what the reference says: bit for bit, where it knows the bit.
pub(crate) fn unequal_status(case: &Case, costs: &Costs, evaluation: &Evaluation) -> Vec<String> {
    let equal = |i: usize| match (&costs[i], evaluation.status(i)) {
        (Ok(_), status) => status.is_ok(),
        (Err(Refusal::NotPositive), status) => status == Status::NOT_POSITIVE,
        (Err(Refusal::Amplified), _) => true,
        (Err(Refusal::NotFinite), status) => [Status::NOT_POSITIVE, Status::NOT_FINITE].contains(&status),
    };
    let unequal = (0..costs.len()).filter(|i| !equal(*i));
    let describe = |i: usize| {
        let (candidate, status, found) = (case.population.row(i), evaluation.status(i), evaluation.costs(i));
        format!("{}: candidate {i} {candidate:?}: lanes {status:?} {found:?}, reference {:?}", case.name, costs[i])
    };
    unequal.map(describe).collect()
}

/// Worst error of any cost in units of its promise.
pub(crate) fn worst(case: &Case, costs: &Costs, evaluation: &Evaluation, promise: fn(&Case, Kind, f64) -> f64) -> f64 {
    let mut worst: f64 = 0.0;
    for (i, expected) in costs.iter().enumerate() {
        let candidate = case.population.row(i);
        let Ok(expected) = expected else { continue };
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
pub(crate) fn misplaced(
    case: &Case,
    costs: &Costs,
    evaluation: &Evaluation,
    promise: fn(&Case, Kind, f64) -> f64,
) -> usize {
    let usable: Vec<usize> = (0..costs.len()).filter(|i| costs[*i].is_ok()).collect();
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
