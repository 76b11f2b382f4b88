//! Everything a log holds, before anyone has said which column is what.

use std::collections::HashMap;

use super::names::names_a_trajectory;
use crate::data::{Clock, Format, LogError, Place, Rows, TimeUnit, looks_like_an_instant, no_instant};

/// Cells that are no number in a column of numbers are kept up to this many.
const ODD: usize = 100;
/// Words of rows that sum up those before.
#[rustfmt::skip]
const SUMMARIES: [&str; 14] = [
    "mean", "average", "avg", "sum", "total", "min", "max", "std", "stddev", "median", "count", "mittelwert", "summe",
    "moyenne",
];

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
    /// The first cells of another kind than the rest of the column.
    pub(super) odd: Vec<Odd>,
    /// How many there are.
    odds: usize,
    /// Whether every instant is a date without a time of day.
    pub(super) dates: bool,
}

/// A cell of another kind than its column.
pub(super) struct Odd {
    row: usize,
    pub(super) place: Place,
    pub(super) text: Box<str>,
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    /// No value so far.
    Empty,
    Numbers,
    /// Dates or clock times.
    Instants(Clock),
    /// Anything else.
    Text,
    /// Named like a trajectory: any text, numbered in order of appearance.
    Labels(HashMap<Box<str>, usize>),
}

impl Survey {
    pub(super) fn read(mut text: &[u8], source: &str, format: &Format) -> Result<Self, LogError> {
        let mut rows = Rows::open(&mut text, source, format)?;
        if rows.header_is_numbers() {
            return Err(LogError::NoHeader { place: rows.header_place() });
        }
        let label = rows.names().iter().position(|name| names_a_trajectory(name));
        let column = |(i, name): (usize, &String)| Column {
            name: name.clone(),
            content: if label == Some(i) { Content::Labels(HashMap::new()) } else { Content::Empty },
            values: Vec::new(),
            odd: Vec::new(),
            odds: 0,
            dates: true,
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
        columns.iter_mut().for_each(Column::settle);
        Ok(Self { columns, lines })
    }

    /// Leaves out rows that sum up the others: those that say so, and the last ones with text among numbers. Gives their
    /// lines, and a sentence.
    pub(super) fn without_summaries(&mut self) -> Option<(Vec<u64>, String)> {
        let odd = |row: usize| {
            let cells = self.columns.iter().filter(|c| c.content != Content::Text).flat_map(|c| &c.odd);
            cells.filter(move |odd| odd.row == row)
        };
        let says_so = |text: &str| SUMMARIES.contains(&text.to_lowercase().trim_end_matches([':', '.']));
        let last = (0..self.lines.len()).rev().take_while(|&row| odd(row).next().is_some()).count();
        let last = self.lines.len() - if last > 8 { 0 } else { last };
        let is_summary = |row: usize| odd(row).any(|odd| row >= last || says_so(&odd.text));
        let candidates = self.columns.iter().flat_map(|c| &c.odd).map(|odd| odd.row);
        let mut rows: Vec<usize> = candidates.filter(|&row| is_summary(row)).collect();
        rows.sort_unstable();
        rows.dedup();
        let first = odd(*rows.first()?).next()?;
        let lines: Vec<u64> = rows.iter().map(|&row| self.lines[row]).collect();
        let more = if lines.len() > 1 { format!(" and {} more", lines.len() - 1) } else { String::new() };
        let said = format!(
            "line {}{more} looks like a row that sums up the others ({:?} among numbers) and is left out (skip_lines)",
            lines[0], first.text
        );
        for &row in rows.iter().rev() {
            self.lines.remove(row);
            for column in self.columns.iter_mut() {
                column.odd.retain(|odd| odd.row != row);
                if row < column.values.len() {
                    column.values.remove(row);
                }
            }
        }
        Some((lines, said))
    }
}

impl Column {
    fn push(&mut self, rows: &Rows<'_>, i: usize) {
        let text = rows.cell(i).unwrap_or("\u{FFFD}");
        if let Content::Labels(known) = &mut self.content {
            match label(known, text) {
                Some(value) => self.values.push(value),
                None => (self.content, self.values) = (Content::Text, Vec::new()),
            }
            return;
        }
        if Rows::is_missing(text) {
            return self.values.push(f64::NAN);
        }
        let value = match &mut self.content {
            Content::Text | Content::Labels(_) => None,
            Content::Numbers => rows.number(i, "").ok(),
            Content::Instants(clock) => clock.read(rows, i).ok(),
            Content::Empty => self.first(rows, i),
        };
        if value.is_none() && self.odd.len() < ODD {
            self.odd.push(Odd { row: self.values.len(), place: rows.place(i), text: text.chars().take(60).collect() });
        }
        self.odds += usize::from(value.is_none());
        self.dates &= !text.contains([':', 'T']);
        self.values.push(value.unwrap_or(f64::NAN));
    }

    /// Reads a cell of a column that has had no value yet, and settles its content if there is one.
    fn first(&mut self, rows: &Rows<'_>, i: usize) -> Option<f64> {
        if let Ok(value) = rows.number(i, "") {
            self.content = Content::Numbers;
            return Some(value);
        }
        let mut clock = Clock::new(TimeUnit::Second);
        let origin = clock.read(rows, i).ok()?;
        self.content = Content::Instants(clock);
        Some(origin)
    }

    /// A column with no more values than odd cells is text.
    fn settle(&mut self) {
        let values = self.values.iter().filter(|v| !v.is_nan()).count();
        if !matches!(self.content, Content::Labels(_)) && self.odds > 0 && self.odds >= values {
            self.content = Content::Text;
        }
        if self.content == Content::Text {
            self.values = Vec::new();
        }
    }

    /// The first cell that keeps the column from being what it mostly is.
    pub(super) fn flaw(&self) -> Option<&Odd> {
        self.odd.first().filter(|_| self.content != Content::Text)
    }

    /// Whether it is text with the look of times that cannot be read: the first such cell.
    pub(super) fn unreadable_time(&self) -> Option<&Odd> {
        let timely =
            |odd: &&Odd| looks_like_an_instant(&odd.text) || no_instant(&odd.text).is_some_and(|r| !r.is_empty());
        let all = self.odd.iter().filter(timely).count();
        self.odd.iter().find(timely).filter(|_| self.content == Content::Text && 2 * all > self.odd.len())
    }

    /// Whether it holds numbers of which two differ.
    pub(super) fn varies(&self) -> bool {
        let mut present = self.values.iter().filter(|v| !v.is_nan());
        let first = present.next();
        self.content == Content::Numbers && self.odd.is_empty() && present.any(|v| Some(v) != first)
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
