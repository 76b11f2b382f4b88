//! The log as columns of the record: one value a row, the same for every candidate.
//!
//! A column that never changes is a constant, and equal columns are one: what is constant over the log (dt, the missing
//! pattern, a weight) is folded into the tape without anybody asking for it.

use super::kinds::Kinds;
use crate::tape::{Graph, Id, Leaf};
use std::collections::{BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

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
    /// 1 where so many do.
    Components(usize),
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

impl Key {
    /// Whether a column of 0 and 1 under this key says what happens in a row.
    const fn decides(self) -> bool {
        match self {
            Self::Input(_)
            | Self::Present(_)
            | Self::Measured
            | Self::Components(_)
            | Self::Full(_)
            | Self::AfterGap
            | Self::Weight(..) => true,
            Self::Dt | Self::Measurement(_) | Self::Nominal(_) | Self::NextNominal(_) | Self::Truth(_) => false,
        }
    }
}

/// What became of some values.
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
    /// The rows of a kind of a column over all rows.
    parts: HashMap<(usize, u32), Found>,
    by_hash: HashMap<u64, Vec<u32>>,
    counts: HashMap<(usize, usize), Vec<f64>>,
    pub(super) kinds: Kinds,
    /// The kind whose rows are asked for; all rows without one.
    kind: Option<usize>,
}

impl Columns {
    /// The node of a column, whose values over all used rows are asked for the first time only.
    pub(super) fn node(&mut self, g: &mut Graph, key: Key, values: impl FnOnce() -> Vec<f64>) -> Id {
        let whole = match self.by_key.get(&key) {
            Some(found) => *found,
            None => {
                let found = self.register(values());
                self.by_key.insert(key, found);
                found
            }
        };
        let found = match (self.kind, whole) {
            (Some(kind), Found::Column(column)) => self.part(kind, column),
            _ => whole,
        };
        match found {
            Found::Constant(value) => g.constant(value),
            Found::Column(column) => g.leaf(Leaf::Column(column)),
        }
    }

    /// From now on columns are those of the rows of a kind, where there are several.
    pub(super) fn of_kind(&mut self, kind: usize) {
        self.kind = (self.kinds.len() > 1).then_some(kind);
    }

    /// Number of rows that columns are asked for, of a log with `rows` used ones.
    pub(super) fn rows(&self, rows: usize) -> usize {
        self.kind.map_or(rows, |kind| self.kinds.rows(kind, rows))
    }

    /// From now on columns are those of all rows.
    pub(super) fn of_all(&mut self) {
        self.kind = None;
    }

    /// Parts the rows by what the columns say that happens in them; whether there are several kinds.
    pub(super) fn part_rows(&mut self, rows: usize, operations: usize) -> bool {
        let deciding = self.by_key.iter().filter(|(key, _)| key.decides());
        let columns = deciding.filter_map(|(_, found)| match found {
            Found::Column(column) => Some(*column),
            Found::Constant(_) => None,
        });
        // In the order of their columns, which a map does not keep.
        let columns: BTreeSet<u32> = columns.collect();
        let values = columns.iter().map(|column| self.data[*column as usize].as_slice());
        let decided = |value: &f64| [0.0_f64, 1.0].map(f64::to_bits).contains(&value.to_bits());
        let mut flags: Vec<&[f64]> = values.filter(|values| values.iter().all(decided)).collect();
        // Between rows at one time nothing is predicted.
        let still = self.standing_still();
        flags.extend(still.as_deref());
        self.kinds = Kinds::by_flags(&flags, rows, operations).unwrap_or_default();
        self.kinds.len() > 1
    }

    /// 1 in the rows that another one at the same time follows, 0 in the others; `None` where there are none.
    fn standing_still(&self) -> Option<Vec<f64>> {
        let Some(Found::Column(dt)) = self.by_key.get(&Key::Dt) else { return None };
        let dt = &self.data[*dt as usize];
        let still = |dt: &f64| f64::from(u8::from(*dt <= 0.0));
        dt.iter().any(|dt| *dt <= 0.0).then(|| dt.iter().map(still).collect())
    }

    fn part(&mut self, kind: usize, column: u32) -> Found {
        if let Some(found) = self.parts.get(&(kind, column)) {
            return *found;
        }
        let values = self.kinds.part(kind, &self.data[column as usize]);
        let found = self.register(values);
        self.parts.insert((kind, column), found);
        found
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
        let same = |column: &[f64]| {
            column.len() == values.len() && column.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        if let Some(column) = alike.iter().find(|column| same(&self.data[**column as usize])) {
            return Found::Column(*column);
        }
        #[expect(clippy::cast_possible_truncation, reason = "a record has a handful of columns")]
        let column = self.data.len() as u32;
        alike.push(column);
        self.data.push(values);
        Found::Column(column)
    }

    /// Value of column `column` in the `row`th of its rows.
    pub(super) fn value(&self, column: u32, row: usize) -> f64 {
        self.data[column as usize][row]
    }

    /// Sum over all used rows, `rows` in number, of a key that is known.
    pub(super) fn total(&self, key: Key, rows: usize) -> f64 {
        match self.by_key.get(&key) {
            Some(Found::Column(column)) => self.data[*column as usize].iter().sum(),
            Some(Found::Constant(value)) => value * count(rows),
            None => f64::NAN,
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
            let keys = [Key::Measurement(0), Key::Measurement(1), Key::Dt];
            assert_eq!(keys.map(|key| columns.total(key, 2)), [3.0, 4.0, 1.0]);
        }
        assert_eq!(asked, 4, "in the first round only");
    }
}
