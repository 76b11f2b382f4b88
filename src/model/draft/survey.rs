//! Everything a log holds, before anyone has said which column is what.

use std::collections::HashMap;
use std::io::Read;

use super::roles::{Roles, names_a_trajectory};
use crate::data::{Clock, LogError, Rows};

/// An interval this many times the median one is a gap: what happened in it says nothing about a step.
const JUMP: f64 = 10.0;

/// All columns of a log.
pub(super) struct Survey {
    pub(super) columns: Vec<Column>,
    /// 1-based line of each row.
    pub(super) lines: Vec<u64>,
}

/// One column.
pub(super) struct Column {
    pub(super) name: String,
    pub(super) content: Content,
    /// One value a row, NaN = missing: numbers, seconds of instants, or running numbers of trajectories. Empty for text.
    pub(super) values: Vec<f64>,
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    /// No value so far.
    Empty,
    Numbers,
    /// ISO-8601 times.
    Instants(Clock),
    /// Anything else.
    Text,
    /// Named like a trajectory: any text, numbered in order of appearance.
    Labels(HashMap<Box<str>, usize>),
}

/// Present values of one column in one trajectory, with their times [s].
pub(super) struct Series {
    pub(super) time: Vec<f64>,
    pub(super) value: Vec<f64>,
}

impl Survey {
    pub(super) fn read(reader: &mut dyn Read, source: &str) -> Result<Self, LogError> {
        let mut rows = Rows::open(reader, source)?;
        if rows.header_is_numbers() {
            return Err(LogError::NoHeader { place: rows.header_place() });
        }
        let label = rows.names().iter().position(|name| names_a_trajectory(name));
        let column = |(i, name): (usize, &String)| Column {
            name: name.clone(),
            content: if label == Some(i) { Content::Labels(HashMap::new()) } else { Content::Empty },
            values: Vec::new(),
        };
        let mut columns: Vec<Column> = rows.names().iter().enumerate().map(column).collect();
        let mut lines = Vec::new();
        while rows.advance()? {
            columns.iter_mut().enumerate().for_each(|(i, column)| column.push(&rows, i));
            lines.push(rows.line());
        }
        if lines.is_empty() {
            return Err(LogError::HeaderOnly { file: source.into() });
        }
        Ok(Self { columns, lines })
    }

    /// Rows of each trajectory, in order of appearance.
    pub(super) fn trajectories(&self, labels: Option<usize>) -> Vec<Vec<usize>> {
        let Some(labels) = labels else { return vec![(0..self.lines.len()).collect()] };
        let mut rows: Vec<Vec<usize>> = Vec::new();
        for (row, &label) in self.columns[labels].values.iter().enumerate() {
            let label = label as usize;
            rows.resize_with(rows.len().max(label + 1), Vec::new);
            rows[label].push(row);
        }
        rows
    }

    /// The present values of column `i`, trajectory by trajectory, parted where time jumps.
    pub(super) fn series(&self, i: usize, roles: &Roles) -> Vec<Series> {
        let one = |rows: Vec<usize>| {
            let mut series = Series { time: Vec::new(), value: Vec::new() };
            for (step, &row) in rows.iter().enumerate().filter(|(_, row)| !self.columns[i].values[**row].is_nan()) {
                series.time.push(roles.time.map_or(step as f64, |t| self.columns[t].values[row]));
                series.value.push(self.columns[i].values[row]);
            }
            series
        };
        let whole: Vec<Series> = self.trajectories(roles.trajectory).into_iter().map(one).collect();
        let jump = JUMP * median(whole.iter().flat_map(Series::intervals).collect());
        whole.iter().flat_map(|series| series.parted(jump)).collect()
    }
}

impl Series {
    /// Intervals between values [s].
    pub(super) fn intervals(&self) -> impl Iterator<Item = f64> {
        self.time.windows(2).map(|w| w[1] - w[0])
    }

    fn parted(&self, jump: f64) -> Vec<Self> {
        let ends = self.intervals().enumerate().filter(|(_, dt)| *dt > jump).map(|(k, _)| k + 1);
        let (mut parts, mut start) = (Vec::new(), 0);
        for end in ends.chain([self.time.len()]) {
            parts.push(Self { time: self.time[start..end].to_vec(), value: self.value[start..end].to_vec() });
            start = end;
        }
        parts
    }
}

/// NaN of no values; the upper of the middle two of an even number.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

impl Column {
    fn push(&mut self, rows: &Rows<'_>, i: usize) {
        let value = match &mut self.content {
            Content::Text => return,
            Content::Labels(known) => label(known, rows.cell(i).unwrap_or_default()),
            Content::Numbers => rows.number(i, "").ok(),
            Content::Instants(clock) => clock.read(rows, i).ok(),
            Content::Empty => self.first(rows, i),
        };
        match value {
            Some(value) => self.values.push(value),
            None => (self.content, self.values) = (Content::Text, Vec::new()),
        }
    }

    /// Reads a cell of a column that has had no value yet, and settles its content if there is one.
    fn first(&mut self, rows: &Rows<'_>, i: usize) -> Option<f64> {
        if let Ok(value) = rows.number(i, "") {
            if !value.is_nan() {
                self.content = Content::Numbers;
            }
            return Some(value);
        }
        let mut clock = Clock::Unset;
        let origin = clock.read(rows, i).ok();
        self.content = Content::Instants(clock);
        origin
    }

    /// Whether it holds numbers of which two differ.
    pub(super) fn varies(&self) -> bool {
        let mut present = self.values.iter().filter(|v| !v.is_nan());
        let first = present.next();
        self.content == Content::Numbers && present.any(|v| Some(v) != first)
    }
}

/// The running number of a label; `None` where it is missing.
fn label(known: &mut HashMap<Box<str>, usize>, text: &str) -> Option<f64> {
    if text.is_empty() {
        return None;
    }
    let next = known.len();
    Some(*known.entry(text.into()).or_insert(next) as f64)
}
