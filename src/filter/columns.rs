//! The log as columns of the record: one value a row, the same for every candidate.
//!
//! A column that never changes is a constant, and equal columns are one: what is constant over the log (dt, the missing
//! pattern, a weight) is folded into the tape without anybody asking for it.

use crate::data::{Log, Trajectory};
use crate::model::{Problem, Start};
use crate::tape::{Graph, Id, Leaf};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

/// The rows a filter runs over, trajectory after trajectory.
#[derive(Debug, Clone)]
pub(super) struct Rows<'a> {
    pub(super) log: &'a Log,
    /// For each trajectory its first used row (rows before a start from a measurement are skipped).
    pub(super) first: Vec<usize>,
    /// Whether x0 comes from the measurement of the first used row, which then gets no update.
    pub(super) from_measurement: bool,
}

impl<'a> Rows<'a> {
    pub(super) fn new(problem: &Problem, log: &'a Log) -> Self {
        let from_measurement = problem.model.x0 == Start::Measurement;
        let start = |t: &Trajectory| (0..t.len()).find(|k| t.is_complete(*k)).unwrap_or(t.len());
        let first = log.trajectories.iter().map(|t| if from_measurement { start(t) } else { 0 }).collect();
        Self { log, first, from_measurement }
    }

    /// The rows of each trajectory, counted over the whole record.
    pub(super) fn spans(&self) -> Vec<Range<usize>> {
        let mut next = 0;
        let lengths = self.log.trajectories.iter().zip(&self.first).map(|(t, first)| t.len() - first);
        lengths
            .map(|length| {
                next += length;
                next - length..next
            })
            .collect()
    }

    /// For each trajectory the interval after its first used row \[s\]; 1 where it has no row.
    pub(super) fn first_intervals(&self) -> Vec<f64> {
        let trajectories = self.log.trajectories.iter().zip(&self.first);
        trajectories.map(|(t, first)| if *first < t.len() { interval(t, *first) } else { 1.0 }).collect()
    }

    /// Every used row of every trajectory.
    pub(super) fn places(&self) -> impl Iterator<Item = Place<'_>> {
        let trajectories = self.log.trajectories.iter().zip(&self.first).enumerate();
        let from_measurement = self.from_measurement;
        trajectories.flat_map(move |(index, (trajectory, &first))| {
            (first..trajectory.len()).map(move |k| Place {
                trajectory,
                index,
                k,
                is_start: from_measurement && k == first,
            })
        })
    }
}

/// One row of one trajectory.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(super) trajectory: &'a Trajectory,
    /// Which trajectory.
    pub(crate) index: usize,
    /// Row, counted from the trajectory's first row in the log.
    pub(crate) k: usize,
    /// Whether x0 comes from this row, which therefore gets no update.
    is_start: bool,
}

impl Place<'_> {
    /// Whether measurement `i` is present and updates the filter.
    pub(crate) fn present(&self, i: usize) -> bool {
        !self.is_start && !self.trajectory.z.row(self.k)[i].is_nan()
    }

    /// Number of present components.
    pub(crate) fn components(&self) -> usize {
        (0..self.trajectory.z.columns()).filter(|i| self.present(*i)).count()
    }

    /// Truth of column `i`, NaN where unknown.
    pub(crate) fn truth(&self, i: usize) -> f64 {
        self.trajectory.truth.row(self.k)[i]
    }

    /// Interval to the next row [s]; after the last row, where nothing is predicted any more, the one before it.
    pub(super) fn dt(&self) -> f64 {
        interval(self.trajectory, self.k)
    }
}

fn interval(t: &Trajectory, k: usize) -> f64 {
    t.dt(k).or_else(|| t.dt(k.checked_sub(1)?)).unwrap_or(1.0)
}

/// Columns registered so far; data that repeats is stored once.
#[derive(Debug, Default)]
pub(super) struct Columns {
    data: Vec<Vec<f64>>,
    by_hash: HashMap<u64, Vec<u32>>,
}

impl Columns {
    /// The node of a column.
    pub(super) fn node(&mut self, g: &mut Graph, values: Vec<f64>) -> Id {
        match values.first() {
            None => return g.constant(0.0),
            Some(first) if values.iter().all(|v| v.to_bits() == first.to_bits()) => return g.constant(*first),
            Some(_) => {}
        }
        let mut hasher = DefaultHasher::new();
        values.iter().for_each(|v| v.to_bits().hash(&mut hasher));
        let alike = self.by_hash.entry(hasher.finish()).or_default();
        let equal = |c: &&u32| self.data[**c as usize].iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits());
        if let Some(column) = alike.iter().find(equal) {
            return g.leaf(Leaf::Column(*column));
        }
        #[expect(clippy::cast_possible_truncation, reason = "a record has a handful of columns")]
        let column = self.data.len() as u32;
        alike.push(column);
        self.data.push(values);
        g.leaf(Leaf::Column(column))
    }

    /// Value of column `column` at row `row` of the record.
    pub(super) fn value(&self, column: u32, row: usize) -> f64 {
        self.data[column as usize][row]
    }
}
