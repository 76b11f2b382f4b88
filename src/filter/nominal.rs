//! The nominal track of the deviation form: f64, near every candidate's track, the same for all.

use super::rows::Rows;

/// Predicted states of one filter run in f64, one per used row.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    /// The candidate it was run with.
    pub candidate: Vec<f64>,
    /// n values a row, row after row.
    pub(super) states: Vec<f64>,
    /// n.
    pub(super) n: usize,
}

impl Nominal {
    /// From the predicted states of a run with `candidate`: n values for each used row.
    pub(crate) const fn new(candidate: Vec<f64>, states: Vec<f64>, n: usize) -> Self {
        Self { candidate, states, n }
    }

    /// The same candidate on another track, n values for each used row. Any track is exact; a near one costs few digits.
    pub(super) fn on(self, states: Vec<f64>) -> Self {
        Self { states, ..self }
    }

    /// Whether it is a number throughout.
    pub(crate) fn is_finite(&self) -> bool {
        self.states.iter().all(|x| x.is_finite())
    }

    /// The states at a row of the record.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.states[row * self.n..(row + 1) * self.n]
    }

    /// State `i` at every row.
    pub(super) fn at(&self, i: usize) -> Vec<f64> {
        self.states.iter().skip(i).step_by(self.n).copied().collect()
    }

    /// State `i` at the row after every row; 0 after the last of a trajectory, where nothing is predicted any more.
    pub(super) fn next(&self, i: usize, rows: &Rows<'_>) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.states.len() / self.n);
        for span in rows.spans() {
            let last = span.end.saturating_sub(1);
            values.extend(span.map(|row| if row < last { self.states[(row + 1) * self.n + i] } else { 0.0 }));
        }
        values
    }
}
