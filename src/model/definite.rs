//! Whether covariances are covariances at the start values.

use nalgebra::DMatrix;

use super::error::Cause;
use super::{Expr, Problem, Symbol};

/// Eigenvalues of Q down to minus this share of the largest count as rounding.
const ROUNDING: f64 = 1e-12;

/// P0 and R positive definite, Q positive semidefinite (where it has no dt); otherwise the key and what is wrong.
///
/// A `factored` matrix M M' is never indefinite, but may round to a singular one: that is left to each candidate's status.
pub(super) fn check(problem: &Problem, factored: &[&str]) -> Result<(), (&'static str, Box<Cause>)> {
    let model = &problem.model;
    let values = problem.parameters.resolve(&problem.parameters.baseline());
    for (key, matrix, labels) in [("P0", &model.p0, &model.states), ("R", &model.r, &model.measurements)] {
        let matrix = evaluate(matrix, labels.len(), &values, f64::NAN);
        if let Some(detail) = defect(&matrix, labels, factored.contains(&key)) {
            return Err((key, Cause::NotPositive { key: format!("model.{key}"), semi: false, detail }.into()));
        }
    }
    if model.q.iter().any(|q| q.mentions(|s| s == Symbol::Dt)) {
        return Ok(());
    }
    check_process_noise(problem, f64::NAN).map_err(|cause| ("Q", cause))
}

/// Q positive semidefinite at the start values for the interval `dt`.
pub(super) fn check_process_noise(problem: &Problem, dt: f64) -> Result<(), Box<Cause>> {
    let model = &problem.model;
    let values = problem.parameters.resolve(&problem.parameters.baseline());
    let matrix = evaluate(&model.q, model.states.len(), &values, dt);
    match defect(&matrix, &model.states, true) {
        None => Ok(()),
        Some(detail) => Err(Cause::NotPositive { key: "model.Q".to_owned(), semi: true, detail }.into()),
    }
}

fn evaluate(matrix: &[Expr], n: usize, values: &[f64], dt: f64) -> DMatrix<f64> {
    let value = |symbol| match symbol {
        Symbol::Parameter(i) => values.get(i).copied().unwrap_or(f64::NAN),
        Symbol::Dt => dt,
        Symbol::State(_) | Symbol::Input(_) => f64::NAN,
    };
    DMatrix::from_row_iterator(n, n, matrix.iter().map(|e| e.evaluate(&value)))
}

/// What keeps a symmetric matrix from being positive (semi)definite.
fn defect(matrix: &DMatrix<f64>, labels: &[String], semi: bool) -> Option<String> {
    let n = labels.len();
    for row in 0..n {
        for column in 0..n {
            let value = matrix[(row, column)];
            if !value.is_finite() {
                return Some(format!("entry [{}, {}] is {value}, not a finite number", row + 1, column + 1));
            }
        }
        let variance = matrix[(row, row)];
        if variance < 0.0 || (variance <= 0.0 && !semi) {
            let expected = if semi { "0 or more" } else { "above 0" };
            return Some(format!("the variance of `{}` is {variance}, expected {expected}", labels[row]));
        }
    }
    if !semi {
        return matrix.clone().cholesky().is_none().then(|| advice(smallest(matrix)));
    }
    let largest = matrix.diagonal().amax();
    let least = smallest(matrix);
    (least < -ROUNDING * largest * f64::from(u32::try_from(n).unwrap_or(u32::MAX))).then(|| advice(least))
}

fn smallest(matrix: &DMatrix<f64>) -> f64 {
    matrix.symmetric_eigenvalues().min()
}

fn advice(eigenvalue: f64) -> String {
    format!("its smallest eigenvalue is {eigenvalue:.3e} (make the off-diagonal entries smaller)")
}
