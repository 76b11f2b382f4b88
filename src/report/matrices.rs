//! The tuned filter as matrices.

use std::fmt;

use nalgebra::DMatrix;
use serde::Serialize;

use super::number::short;
use crate::data::{Intervals, Log};
use crate::model::{FilterKind, Problem};
use crate::reference::{self, Steady, Step};

/// Significant digits of an entry: more than any tuned variance has.
const DIGITS: usize = 8;

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
            self.rows.iter().map(|row| row.iter().map(|v| short(*v, DIGITS)).collect()).collect();
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

/// The model's matrices for one candidate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, K")]
pub struct Matrices {
    /// Interval that F, Q and a steady K are for \[s\]: the log's, or its median.
    pub dt: f64,
    /// Transition, n x n, inputs at zero.
    pub F: Matrix,
    /// Measurement, m x n, inputs at zero.
    pub H: Matrix,
    /// Process noise covariance of one step, n x n; where it is adapted, of the first.
    pub Q: Matrix,
    /// Measurement noise covariance, m x m; where it is adapted, of the first row.
    pub R: Matrix,
    /// Gain, n x m; `None` when no row has a complete measurement and the filter does not settle.
    pub K: Option<Matrix>,
    /// Which gain it is.
    pub gain: Gain,
    /// What an adaptive filter does with Q or R; `None` for one that keeps both.
    pub note: Option<&'static str>,
}

/// Which gain is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Gain {
    /// The one the filter settles to on a regular log.
    Steady,
    /// That of the last complete measurement.
    Last,
}

impl Matrices {
    /// The matrices of `candidate`; `last_gain` (n x m) stands in where its filter settles to none.
    #[must_use]
    pub fn of(problem: &Problem, log: &Log, candidate: &[f64], last_gain: Option<DMatrix<f64>>) -> Self {
        let regular = log.regular_dt();
        let dt = regular.or_else(|| Intervals::of(log).map(|dt| dt.median)).unwrap_or(1.0);
        let model = reference::Matrices::of(problem, candidate, dt);
        let steady = regular.filter(|_| !problem.filter.is_adaptive());
        let steady = steady.and_then(|dt| reference::steady_gain(problem, candidate, dt));
        let gain = if steady.is_some() { Gain::Steady } else { Gain::Last };
        let k = steady.map(|Steady { k, .. }| k).or(last_gain);
        Self {
            dt,
            F: (&model.f).into(),
            H: (&model.h).into(),
            Q: (&model.q).into(),
            R: (&model.r).into(),
            K: k.as_ref().map(Matrix::from),
            gain,
            note: adapted(&problem.filter),
        }
    }
}

/// Which of the matrices printed is a start only.
const fn adapted(kind: &FilterKind) -> Option<&'static str> {
    match kind {
        FilterKind::Kalman => None,
        FilterKind::SageHusa { .. } => Some("Q is where each trajectory starts; the filter adapts it"),
        FilterKind::SageHusaR { .. } | FilterKind::Fuzzy { .. } => {
            Some("R is where each trajectory starts; the filter adapts it")
        }
    }
}

/// Keeps the gain of a row where all `m` components are present.
pub(super) fn keep_complete_gain(gain: &mut Option<DMatrix<f64>>, step: &Step, m: usize) {
    if let Some(update) = step.update.as_ref().filter(|update| update.present.len() == m) {
        match gain {
            Some(gain) => gain.copy_from(&update.k),
            None => *gain = Some(update.k.clone()),
        }
    }
}

/// One matrix a line, with its name.
impl fmt::Display for Matrices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = [("F", &self.F), ("H", &self.H), ("Q", &self.Q), ("R", &self.R)];
        for (name, matrix) in all {
            writeln!(f, "{name} = {matrix:4}")?;
        }
        if let Some(k) = &self.K {
            writeln!(f, "K = {k:4}")?;
        }
        if let Some(note) = self.note {
            writeln!(f, "Note: {note}.")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_reads_as_numpy_and_json() {
        let matrix = Matrix::from(&DMatrix::from_row_slice(2, 2, &[1.0, 0.25, 0.0, -1.0 / 3.0]));
        let text = format!("{matrix:4}");
        assert_eq!(text, "[[          1,        0.25],\n     [          0, -0.33333333]]");
        let read: Vec<Vec<f64>> = serde_json::from_str(&text).unwrap();
        assert!((read[1][1] + 1.0 / 3.0).abs() < 1e-8, "pasted text reads back: {text}");
        assert_eq!(serde_json::to_string(&matrix).unwrap(), "[[1.0,0.25],[0.0,-0.3333333333333333]]");
    }
}
