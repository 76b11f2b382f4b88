//! The units in which a filter computes: powers of two near the sizes of its states and measurements.
//!
//! Variances in A^2 of a sensor in nA, or in squared cents of a fund, leave the range of f32, and products of a few of them
//! that of f64. A power of two changes no digit, so a filter in other units has the same bits, and totals are given back in
//! the user's units exactly. Ordinary problems stay in their own.

use super::covariance::Symmetric;
use crate::tape::{Graph, Id};

/// State j is computed in units of 2^`states[j]`, measurement i in units of 2^`measurements[i]`, of the problem's own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units {
    /// One exponent a state.
    pub states: Vec<i32>,
    /// One exponent a measurement.
    pub measurements: Vec<i32>,
}

impl Units {
    /// The problem's own.
    #[must_use]
    pub fn own(states: usize, measurements: usize) -> Self {
        Self { states: vec![0; states], measurements: vec![0; measurements] }
    }

    /// Whether they are the problem's own.
    #[must_use]
    pub fn are_own(&self) -> bool {
        self.states.iter().chain(&self.measurements).all(|exponent| *exponent == 0)
    }

    /// A matrix that takes states to what has the units `to`, for the filter.
    pub(super) fn map(&self, g: &mut Graph, rows: &[Vec<Id>], to: &[i32]) -> Vec<Vec<Id>> {
        let row = |(row, unit): (&Vec<Id>, &i32)| {
            row.iter().zip(&self.states).map(|(entry, state)| g.scale(*entry, state - unit)).collect()
        };
        rows.iter().zip(to).map(row).collect()
    }
}

/// Values that have `units`, for the filter.
pub(super) fn scaled(g: &mut Graph, values: &[Id], units: &[i32]) -> Vec<Id> {
    values.iter().zip(units).map(|(value, unit)| g.scale(*value, -unit)).collect()
}

/// The covariance of values that have `units`, for the filter.
pub(super) fn covariance(g: &mut Graph, matrix: &Symmetric, units: &[i32]) -> Symmetric {
    Symmetric::from_fn(units.len(), |i, j| g.scale(matrix.at(i, j), -units[i] - units[j]))
}
