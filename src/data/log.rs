//! The log as every later stage sees it: trajectories in the order of time, missing values as NaN.

use std::collections::TryReserveError;

use super::Times;

/// A measurement log, split into trajectories.
///
/// Columns of every trajectory's tables follow the name lists here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Log {
    /// Where it came from, for messages: a file name, `<stdin>` or `<simulated>`.
    pub source: String,
    /// Names of the `m` measurement columns.
    pub measurements: Vec<String>,
    /// Names of the input columns.
    pub inputs: Vec<String>,
    /// Names of the **states** (not columns) that truth is given for, in table order.
    pub truth: Vec<String>,
    /// The trajectories, in order of first appearance.
    pub trajectories: Vec<Trajectory>,
    /// What its times count, from where, and how its file writes them.
    pub times: Times,
    /// For each measurement the length of its range over the rows that a filter is tuned on, where those are others than
    /// these.
    pub ranges: Option<Vec<f64>>,
}

/// One run or target: rows in the order of time, which rows of different sensors may share.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The value of the trajectory column; empty when the log has none.
    pub id: String,
    /// Time of each row, in [`Times::unit`] (seconds unless told otherwise); 0, 1, 2, ... when the log has no time
    /// column.
    pub time: Vec<f64>,
    /// Measurements, rows x m; NaN = missing.
    pub z: Table,
    /// Inputs, rows x inputs; NaN is allowed in the last row only (nothing follows it).
    pub u: Table,
    /// True states, rows x truth; NaN = unknown.
    pub truth: Table,
    /// 1-based line of each row in the source, for messages.
    pub line: Vec<u64>,
}

/// A dense row-major table of numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    columns: usize,
    values: Vec<f64>,
}

impl Table {
    /// An empty table of `columns` columns.
    #[must_use]
    pub const fn new(columns: usize) -> Self {
        Self { columns, values: Vec::new() }
    }

    /// Number of columns.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Appends a row.
    ///
    /// # Panics
    /// If `row` is not `columns` long.
    pub fn push(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.columns, "a row has one value per column");
        self.values.extend_from_slice(row);
    }

    /// Row `k`, `columns` long.
    #[must_use]
    pub fn row(&self, k: usize) -> &[f64] {
        &self.values[k * self.columns..(k + 1) * self.columns]
    }

    /// The first `rows` rows.
    pub(super) fn first(&self, rows: usize) -> Self {
        Self { columns: self.columns, values: self.values[..rows * self.columns].to_vec() }
    }

    /// Fills the gaps of column `i` with the value before each, or the first there is; 0 where there is none at all.
    pub(super) fn hold(&mut self, i: usize) {
        let mut last = self.column(i).find(|value| !value.is_nan()).unwrap_or(0.0);
        for value in self.values.iter_mut().skip(i).step_by(self.columns.max(1)) {
            if value.is_nan() {
                *value = last;
            }
            last = *value;
        }
    }

    /// Column `i` from the first row to the last.
    pub fn column(&self, i: usize) -> impl Iterator<Item = f64> {
        self.values.chunks_exact(self.columns.max(1)).filter_map(move |row| row.get(i).copied())
    }
}

impl Trajectory {
    /// Number of rows.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether it has no row at all.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Interval from row `k` to row `k + 1`, in the unit of the times; 0 where both have one time, `None` at the last row.
    ///
    /// It is rounded to the last decimal that the trajectory's times can hold in f64, so that a log sampled every 0.1 s
    /// has one interval and not three that differ by rounding (from which kfgpu would compute one F and Q a row).
    #[must_use]
    pub fn dt(&self, k: usize) -> Option<f64> {
        let difference = self.time.get(k + 1)? - self.time[k];
        let largest = self.time[0].abs().max(self.time[self.time.len() - 1].abs());
        // Each time is off by half a place of the largest at most, so their difference by less than half a unit.
        let unit = 10f64.powi((-(2.0 * f64::EPSILON * largest).log10()).floor().clamp(0.0, 22.0) as i32);
        let rounded = (difference * unit).round() / unit;
        Some(if rounded > 0.0 { rounded } else { difference })
    }

    /// Whether every measurement of row `k` is present.
    #[must_use]
    pub fn is_complete(&self, k: usize) -> bool {
        self.z.row(k).iter().all(|z| !z.is_nan())
    }

    /// Takes the memory of so many more rows, or says that there is none.
    pub(crate) fn reserve(&mut self, rows: usize) -> Result<(), TryReserveError> {
        self.time.try_reserve_exact(rows)?;
        self.line.try_reserve_exact(rows)?;
        let tables = [&mut self.z, &mut self.u, &mut self.truth];
        tables.into_iter().try_for_each(|table| table.values.try_reserve_exact(rows.saturating_mul(table.columns)))
    }

    /// The first `rows` rows.
    pub(crate) fn first(&self, rows: usize) -> Self {
        Self {
            id: self.id.clone(),
            time: self.time[..rows].to_vec(),
            z: self.z.first(rows),
            u: self.u.first(rows),
            truth: self.truth.first(rows),
            line: self.line[..rows].to_vec(),
        }
    }

    /// Gives back memory kept for rows that never came.
    pub(super) fn shrink(&mut self) {
        self.time.shrink_to_fit();
        self.line.shrink_to_fit();
        for table in [&mut self.z, &mut self.u, &mut self.truth] {
            table.values.shrink_to_fit();
        }
    }
}

impl Log {
    /// Total number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.trajectories.iter().map(Trajectory::len).sum()
    }

    /// The log with these trajectories in place of its own.
    pub(crate) fn with(&self, trajectories: Vec<Trajectory>) -> Self {
        Self {
            source: self.source.clone(),
            measurements: self.measurements.clone(),
            inputs: self.inputs.clone(),
            truth: self.truth.clone(),
            trajectories,
            times: self.times.clone(),
            ranges: self.ranges.clone(),
        }
    }

    /// For each measurement the length of its range over the rows that a filter is tuned on, in its unit; 1 where it has no
    /// two different values.
    #[must_use]
    pub fn ranges(&self) -> Vec<f64> {
        let range = |i: usize| {
            let values = self.trajectories.iter().flat_map(|t| t.z.column(i)).filter(|z| !z.is_nan());
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
            if high > low { high - low } else { 1.0 }
        };
        self.ranges.clone().unwrap_or_else(|| (0..self.measurements.len()).map(range).collect())
    }

    /// The one interval of the whole log, or `None` if intervals differ by more than one part in 1e9, one is 0 or there are
    /// none.
    #[must_use]
    pub fn regular_dt(&self) -> Option<f64> {
        let mut intervals = self.trajectories.iter().flat_map(|t| (0..t.len()).filter_map(|k| t.dt(k)));
        let first = intervals.next().filter(|first| *first > 0.0)?;
        intervals.all(|dt| (dt - first).abs() <= 1e-9 * first).then_some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every(dt: f64, start: f64, rows: usize) -> Trajectory {
        let time: Vec<f64> = (0..rows).map(|k| start + k as f64 * dt).collect();
        let tables = || Table::new(0);
        Trajectory { id: String::new(), line: vec![0; rows], time, z: tables(), u: tables(), truth: tables() }
    }

    #[test]
    fn rounding_of_times_makes_no_new_intervals() {
        // 100 Hz in Unix time: f64 holds such a time to 2e-7 s only.
        for (dt, start) in [(0.1, 0.0), (0.01, 1.7e9), (1e-3, 12.345), (60.0, 4e8), (1.0, 1871.0)] {
            let t = every(dt, start, 1000);
            assert!((0..999).all(|k| t.dt(k) == Some(dt)), "every {dt} s from {start} s: {:?}", t.dt(7));
        }
    }

    #[test]
    fn true_differences_stay() {
        let mut t = every(0.1, 0.0, 3);
        t.time[2] = 0.2003;
        assert_eq!((t.dt(0), t.dt(1)), (Some(0.1), Some(0.1003)), "irregular is irregular");
        let mut t = every(1e-2, 1.7e9, 3);
        t.time[2] = 1.7e9 + 0.023_456;
        assert_eq!(t.dt(1), Some(0.013_456), "microseconds of Unix time");
        let mut t = every(1e-12, 0.0, 3);
        t.time[2] = 2.345_678_9e-12;
        assert_eq!(t.dt(1), Some(1.345_678_9e-12), "picoseconds");
    }
}
