//! The tuned filter as matrices.

use std::fmt;

use nalgebra::DMatrix;
use serde::Serialize;

use super::number::significant;

/// A matrix as nested lists: what JSON and NumPy read.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Matrix {
    rows: Vec<Vec<f64>>,
}

impl From<&DMatrix<f64>> for Matrix {
    fn from(matrix: &DMatrix<f64>) -> Self {
        Self { rows: matrix.row_iter().map(|row| row.iter().copied().collect()).collect() }
    }
}

/// `[[1, 0.5],\n [0, 1]]`, entries aligned, continued lines indented by the width given as `{:width$}`.
impl fmt::Display for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(|v| significant_or_integer(*v)).collect()).collect();
        let width = cells.iter().flatten().map(String::len).max().unwrap_or(0);
        let indent = " ".repeat(f.width().unwrap_or(0));
        f.write_str("[")?;
        for (i, row) in cells.iter().enumerate() {
            if i > 0 {
                write!(f, ",\n{indent} ")?;
            }
            let row: Vec<String> = row.iter().map(|cell| format!("{cell:>width$}")).collect();
            write!(f, "[{}]", row.join(", "))?;
        }
        f.write_str("]")
    }
}

/// Eight digits are more than any tuned variance has; whole numbers stay whole.
fn significant_or_integer(value: f64) -> String {
    if value.fract().abs() <= 0.0 && value.abs() < 1e9 { format!("{value}") } else { significant(value, 8) }
}

/// The model's matrices for one candidate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, K")]
pub struct Matrices {
    /// Interval that F and Q are for [s].
    pub dt: f64,
    /// Transition, n x n.
    pub F: Matrix,
    /// Measurement, m x n.
    pub H: Matrix,
    /// Process noise covariance of one step, n x n.
    pub Q: Matrix,
    /// Measurement noise covariance, m x m.
    pub R: Matrix,
    /// Gain of the last row with a measurement, n x m; the steady gain where the model and the log are regular.
    pub K: Option<Matrix>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_reads_as_numpy_and_json() {
        let matrix = Matrix::from(&DMatrix::from_row_slice(2, 2, &[1.0, 0.25, 0.0, -1.0 / 3.0]));
        let text = format!("{matrix:4}");
        assert_eq!(text, "[[          1,  0.25000000],\n     [          0, -0.33333333]]");
        let read: Vec<Vec<f64>> = serde_json::from_str(&text).unwrap();
        assert_eq!(read[1][1], -0.333_333_33, "pasted text reads back");
        assert_eq!(serde_json::to_string(&matrix).unwrap(), "[[1.0,0.25],[0.0,-0.3333333333333333]]");
    }
}
