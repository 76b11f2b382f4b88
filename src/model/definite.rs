//! What is a covariance, and whether those of a problem are at the start values.

use nalgebra::DMatrix;

use super::error::Cause;
use super::{Binary, Expr, ExprKind, Model, Problem, Symbol};

/// What a semidefinite matrix may lack, as a share of each variance: the rounding of its entries.
pub(crate) const ROUNDING: f64 = 1e-12;

/// The rule for Q (`semi`), R and P0, of candidates too: every pivot of A = L D L' is above 0. For a semidefinite matrix
/// the variances are first raised by [`ROUNDING`] of themselves, and one of 0 may stand where nothing correlates with it;
/// that is the same in any units, of one state or of all.
pub(crate) fn is_covariance(matrix: &DMatrix<f64>, semi: bool) -> bool {
    let n = matrix.nrows();
    let mut rest = matrix.clone();
    if semi {
        (0..n).for_each(|j| rest[(j, j)] *= 1.0 + ROUNDING);
    }
    for j in 0..n {
        let pivot = rest[(j, j)];
        if semi && pivot.abs() <= 0.0 && (j + 1..n).all(|i| rest[(i, j)].abs() <= 0.0) {
            continue;
        }
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        for i in j + 1..n {
            let share = rest[(i, j)] / pivot;
            (j + 1..=i).for_each(|k| rest[(i, k)] -= share * rest[(k, j)]);
        }
    }
    true
}

/// Whether every candidate's R or P0 must be positive definite: M M' may be singular (its innovations tell), and what has
/// no parameter was judged when the problem was read.
pub(crate) fn must_be_definite(matrix: &[Expr]) -> bool {
    let has_parameter = |entry: &Expr| entry.mentions(|s| matches!(s, Symbol::Parameter(_)));
    matrix.iter().any(has_parameter) && !is_product(matrix)
}

/// Whether a matrix (row-major) is written as M M', which is semidefinite whatever M is.
pub(crate) fn is_product(matrix: &[Expr]) -> bool {
    let n = matrix.len().isqrt();
    let rows: Option<Vec<Vec<&Expr>>> = (0..n)
        .map(|i| products(&matrix[i * n + i])?.into_iter().map(|(a, b)| a.same(b).then_some(a)).collect())
        .collect();
    let Some(rows) = rows else { return false };
    let same = |i: usize, j: usize| {
        let Some(products) = products(&matrix[i * n + j]) else { return false };
        products.len() == rows[i].len().min(rows[j].len())
            && products.iter().zip(rows[i].iter().zip(&rows[j])).all(|((a, b), (x, y))| a.same(x) && b.same(y))
    };
    (0..n).all(|i| (0..i).all(|j| same(i, j) && matrix[i * n + j].same(&matrix[j * n + i])))
}

/// The factors of a sum of products.
fn products(entry: &Expr) -> Option<Vec<(&Expr, &Expr)>> {
    match &entry.kind {
        ExprKind::Binary(Binary::Add, a, b) => {
            let mut all = products(a)?;
            all.extend(products(b)?);
            Some(all)
        }
        ExprKind::Binary(Binary::Multiply, a, b) => Some(vec![(a, b)]),
        _ => None,
    }
}

/// The path of a matrix that is no covariance, and what is wrong with it.
pub(super) type Wrong = (Vec<String>, Box<Cause>);

/// P0 and R positive definite, Q positive semidefinite (where it has no dt); otherwise the path of what is wrong, and how. M M'
/// may be singular.
pub(super) fn check(problem: &Problem) -> Result<(), Wrong> {
    let (model, values) = (&problem.model, problem.parameters.resolve(&problem.parameters.baseline()));
    let judge = |matrix: &[Expr], labels: &[String], (path, key): (Vec<String>, String)| {
        // M M' of a sensor has to be definite beside others: R as a whole is no product.
        let semi = is_product(matrix) && (key == "model.P0" || problem.data.sensors.len() < 2);
        let matrix = evaluate(matrix, labels.len(), &values, f64::NAN);
        match defect(&matrix, labels, semi) {
            None => Ok(()),
            Some(detail) => Err((path, Box::new(Cause::NotPositive { key, semi: false, detail }))),
        }
    };
    judge(&model.p0, &model.states, place(None, "P0"))?;
    if problem.data.sensors.is_empty() {
        for (mode, model) in numbered(problem) {
            judge(&model.r, &model.measurements, place(mode, "R"))?;
        }
    }
    // R of all sensors is block diagonal.
    for ((i, sensor), range) in problem.data.sensors.iter().enumerate().zip(problem.data.sensor_ranges()) {
        let m = model.measurements.len();
        let block: Vec<Expr> =
            range.clone().flat_map(|row| range.clone().map(move |column| model.r[row * m + column].clone())).collect();
        let path = ["sensor", &i.to_string(), "R"].map(str::to_owned).to_vec();
        judge(&block, &sensor.columns, (path, format!("sensor[{}].R", i + 1)))?;
    }
    let without_dt = |model: &Model| !model.q.iter().any(|q| q.mentions(|s| s == Symbol::Dt));
    let known = |(_, model): &(Option<usize>, &Model)| without_dt(model);
    numbered(problem).filter(known).try_for_each(|model| check_process_noise_of(problem, model, f64::NAN))
}

/// Q positive semidefinite at the start values for the interval `dt`.
pub(super) fn check_process_noise(problem: &Problem, dt: f64) -> Result<(), Wrong> {
    numbered(problem).try_for_each(|model| check_process_noise_of(problem, model, dt))
}

fn check_process_noise_of(problem: &Problem, (mode, model): (Option<usize>, &Model), dt: f64) -> Result<(), Wrong> {
    let values = problem.parameters.resolve(&problem.parameters.baseline());
    let matrix = evaluate(&model.q, model.states.len(), &values, dt);
    let Some(detail) = defect(&matrix, &model.states, true) else { return Ok(()) };
    let (path, key) = place(mode, "Q");
    Err((path, Cause::NotPositive { key, semi: true, detail }.into()))
}

/// The path to a key of `[model]` or of a mode, and the name that messages call it by.
fn place(mode: Option<usize>, key: &str) -> (Vec<String>, String) {
    match mode {
        None => (["model", key].map(str::to_owned).to_vec(), format!("model.{key}")),
        Some(i) => (["mode", &i.to_string(), key].map(str::to_owned).to_vec(), format!("mode[{}].{key}", i + 1)),
    }
}

/// The models of the filter with the numbers of their modes.
fn numbered(problem: &Problem) -> impl Iterator<Item = (Option<usize>, &Model)> {
    let modes = !problem.modes.is_empty();
    problem.models().enumerate().map(move |(i, model)| (modes.then_some(i), model))
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
    (!is_covariance(matrix, semi)).then(|| {
        let least = matrix.symmetric_eigenvalues().min();
        format!("its smallest eigenvalue is {least:.3e} (make the off-diagonal entries smaller)")
    })
}

#[cfg(test)]
mod tests {
    use super::is_covariance;
    use nalgebra::DMatrix;

    fn judged(entries: &[f64]) -> [bool; 2] {
        let matrix = DMatrix::from_row_slice(entries.len().isqrt(), entries.len().isqrt(), entries);
        [is_covariance(&matrix, false), is_covariance(&matrix, true)]
    }

    #[test]
    fn definite_semidefinite_and_neither() {
        assert_eq!(judged(&[2.0, 1.0, 1.0, 2.0]), [true, true]);
        assert_eq!(judged(&[1.0, 1.0, 1.0, 1.0]), [false, true], "of rank 1");
        assert_eq!(judged(&[0.0, 0.0, 0.0, 1.0]), [false, true], "a state without noise");
        assert_eq!(judged(&[0.0, 1e-9, 1e-9, 1.0]), [false, false], "which cannot correlate");
        assert_eq!(judged(&[1.0, 2.0, 2.0, 1.0]), [false, false], "indefinite");
        assert_eq!(judged(&[0.0]), [false, true]);
        assert_eq!(judged(&[-1e-300]), [false, false], "a variance below 0 in any unit");
        assert_eq!((judged(&[f64::NAN]), judged(&[f64::INFINITY])), ([false; 2], [false; 2]));
    }

    /// The noise of a piecewise constant acceleration has rank 1 and entries that round, in whatever units.
    #[test]
    fn rounding_and_units_do_not_matter() {
        for (dt, [a, b, c]) in [(0.1, [1.0, 1.0, 1.0]), (1.0 / 3.0, [1e12, 1e-9, 1.0]), (0.007, [1e-30, 1e30, 1e7])] {
            let g: [f64; 3] = [0.5 * dt * dt * a, dt * b, c];
            let of_rank_1: Vec<f64> = (0..9).map(|k| g[k / 3] * g[k % 3]).collect();
            assert!(judged(&of_rank_1)[1], "dt = {dt}");
            let mut less = of_rank_1.clone();
            less[4] *= 1.0 - 1e-9;
            assert!(!judged(&less)[1], "a correlation above 1, dt = {dt}");
        }
    }
}
