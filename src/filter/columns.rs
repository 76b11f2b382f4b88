//! The log as columns of the record: one value a row, the same for every candidate.
//!
//! A column that never changes is a constant, and equal columns are one: what is constant over the log (dt, the missing
//! pattern, a weight) is folded into the tape without anybody asking for it.

use crate::data::{Log, Trajectory};
use crate::model::{Problem, Start};
use crate::tape::{Graph, Id, Leaf, Node};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

/// The rows a filter runs over, trajectory after trajectory.
#[derive(Debug, Clone)]
pub(crate) struct Rows<'a> {
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

    /// Number of used rows.
    pub(super) fn len(&self) -> usize {
        self.log.trajectories.iter().zip(&self.first).map(|(t, first)| t.len() - first).sum()
    }

    /// The last `window` rows of each trajectory that update the filter, those before `skip` left out.
    pub(crate) fn last_measured(&self, skip: usize, window: usize) -> Window {
        let mut measured = vec![Vec::new(); self.log.trajectories.len()];
        for place in self.places().filter(|place| place.k >= skip && place.components() > 0) {
            measured[place.index].push(place.k);
        }
        let begin =
            |rows: &Vec<usize>| rows.get(rows.len().saturating_sub(window.max(1))).copied().unwrap_or(usize::MAX);
        Window(measured.iter().map(begin).collect())
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

/// For each trajectory the row from which its window of last measured rows begins.
pub(crate) struct Window(Vec<usize>);

impl Window {
    /// Whether a row stands in the window (rows without a measurement may stand between those that count).
    pub(crate) fn contains(&self, place: Place<'_>) -> bool {
        place.k >= self.0[place.index]
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

/// What a column holds. A column is filled once, however often a step is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// Interval to the next row.
    Dt,
    /// An input.
    Input(usize),
    /// A measurement, 0 where it is missing.
    Measurement(usize),
    /// 1 where a measurement updates the filter.
    Present(usize),
    /// 1 where any does.
    Measured,
    /// 1 where a measurement is present and the buffer of an adaptive filter full.
    Full(usize),
    /// 1 from the first gap of a trajectory on.
    AfterGap,
    /// A state of the nominal.
    Nominal(usize),
    /// The same, one row later.
    NextNominal(usize),
    /// The truth of a state, 0 where unknown.
    Truth(usize),
    /// What scorer number `.0` weighs its rows by, in the order it asks.
    Weight(usize, usize),
}

/// What became of the values of a key.
#[derive(Debug, Clone, Copy)]
enum Found {
    Constant(f64),
    Column(u32),
}

/// Columns registered so far; data that repeats is stored once.
#[derive(Debug, Default)]
pub(super) struct Columns {
    data: Vec<Vec<f64>>,
    by_key: HashMap<Key, Found>,
    by_hash: HashMap<u64, Vec<u32>>,
    counts: HashMap<(usize, usize), Vec<f64>>,
}

impl Columns {
    /// The node of a column, whose values are asked for the first time only.
    pub(super) fn node(&mut self, g: &mut Graph, key: Key, values: impl FnOnce() -> Vec<f64>) -> Id {
        let found = match self.by_key.get(&key) {
            Some(found) => *found,
            None => {
                let found = self.register(values());
                self.by_key.insert(key, found);
                found
            }
        };
        match found {
            Found::Constant(value) => g.constant(value),
            Found::Column(column) => g.leaf(Leaf::Column(column)),
        }
    }

    fn register(&mut self, values: Vec<f64>) -> Found {
        match values.first() {
            None => return Found::Constant(0.0),
            Some(first) if values.iter().all(|v| v.to_bits() == first.to_bits()) => return Found::Constant(*first),
            Some(_) => {}
        }
        let mut hasher = DefaultHasher::new();
        values.iter().for_each(|v| v.to_bits().hash(&mut hasher));
        let alike = self.by_hash.entry(hasher.finish()).or_default();
        let equal = |c: &&u32| self.data[**c as usize].iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits());
        if let Some(column) = alike.iter().find(equal) {
            return Found::Column(*column);
        }
        #[expect(clippy::cast_possible_truncation, reason = "a record has a handful of columns")]
        let column = self.data.len() as u32;
        alike.push(column);
        self.data.push(values);
        Found::Column(column)
    }

    /// Value of column `column` at row `row` of the record.
    pub(super) fn value(&self, column: u32, row: usize) -> f64 {
        self.data[column as usize][row]
    }

    /// Sum over all `rows` of a node that is a column or a constant.
    pub(super) fn sum(&self, g: &Graph, id: Id, rows: usize) -> f64 {
        match g.node(id) {
            Node::Leaf(Leaf::Column(column)) => self.data[column as usize].iter().sum(),
            _ => g.value(id).unwrap_or(f64::NAN) * count(rows),
        }
    }

    /// What scorer `of.0` counts as its `of.1`th number, one a trajectory; counted the first time only.
    pub(super) fn counts(&mut self, of: (usize, usize), counts: impl FnOnce() -> Vec<f64>) -> Vec<f64> {
        self.counts.entry(of).or_insert_with(counts).clone()
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of rows stay far below 2^53")]
const fn count(rows: usize) -> f64 {
    rows as f64
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "the same bits are meant")]
    use super::*;

    #[test]
    fn a_column_is_filled_once_and_equal_ones_are_one() {
        let (mut columns, mut asked) = (Columns::default(), 0);
        for _ in 0..3 {
            // Every round of tracing has a graph of its own.
            let mut g = Graph::default();
            let mut node = |key, values: &[f64]| {
                columns.node(&mut g, key, || {
                    asked += 1;
                    values.to_vec()
                })
            };
            let (z, equal) = (node(Key::Measurement(0), &[1.0, 2.0]), node(Key::Weight(1, 1), &[1.0, 2.0]));
            let (other, constant) = (node(Key::Measurement(1), &[1.0, 3.0]), node(Key::Dt, &[0.5, 0.5]));
            assert!(z == equal && z != other, "by content");
            assert_eq!((g.value(constant), g.value(z)), (Some(0.5), None), "what never changes is a number");
            assert_eq!([z, other, constant].map(|id| columns.sum(&g, id, 2)), [3.0, 4.0, 1.0]);
        }
        assert_eq!(asked, 4, "in the first round only");
    }
}
