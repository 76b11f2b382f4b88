//! Tables of results: as text, Markdown, CSV and JSON.

use std::fmt;
use std::io;

use serde::Serialize;
use serde::ser::{SerializeMap as _, SerializeSeq as _, Serializer};

use crate::number::{exact, significant};
use crate::report::TextTable;

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number, and how many significant digits a person is shown. Files hold all of them.
    Number(f64, usize),
    /// A count.
    Count(u64),
    /// Not known, or not reported.
    Empty,
}

impl Cell {
    /// Words.
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Number(value, digits) => f.write_str(&significant(*value, *digits)),
            Self::Count(count) => write!(f, "{count}"),
            Self::Empty => Ok(()),
        }
    }
}

impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => serializer.serialize_str(text),
            Self::Number(value, _) => serializer.serialize_f64(*value),
            Self::Count(count) => serializer.serialize_u64(*count),
            Self::Empty => serializer.serialize_unit(),
        }
    }
}

/// A table with a name for its file and a title for people.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of its file, without ending.
    pub name: &'static str,
    /// What it shows, with what its words mean.
    pub title: String,
    /// Column heads.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub(super) fn new(name: &'static str, title: impl Into<String>, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|c| (*c).to_owned()).collect();
        Self { name, title: title.into(), columns, rows: Vec::new() }
    }

    /// The table as aligned text, without its title.
    #[must_use]
    pub fn text(&self) -> String {
        let cells = self.rows.iter().map(|row| row.iter().map(ToString::to_string).collect());
        TextTable::of_rows(std::iter::once(self.columns.clone()).chain(cells).collect()).to_string()
    }

    /// The table in Markdown, without its title.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let heads = line(self.columns.clone());
        let rule = line(vec!["---".to_owned(); self.columns.len()]);
        let rows = self.rows.iter().map(|row| line(row.iter().map(ToString::to_string).collect()));
        [heads, rule].into_iter().chain(rows).collect()
    }

    /// Writes the table as CSV, numbers with all their digits.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write_csv(&self, out: impl io::Write) -> Result<(), csv::Error> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(&self.columns)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(|cell| match cell {
                Cell::Number(value, _) => exact(*value),
                other => other.to_string(),
            }))?;
        }
        Ok(writer.flush()?)
    }
}

/// A list of objects, one a row, keyed by column heads.
impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.rows.len()))?;
        for row in &self.rows {
            list.serialize_element(&Row(&self.columns, row))?;
        }
        list.end()
    }
}

struct Row<'a>(&'a [String], &'a [Cell]);

impl Serialize for Row<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_map(Some(self.0.len()))?;
        for (column, cell) in self.0.iter().zip(self.1) {
            object.serialize_entry(column, cell)?;
        }
        object.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_table_in_four_forms() {
        let mut table = Table::new("scores", "Scores", &["method", "J", "runs", "paper"]);
        table.rows.push(vec![Cell::text("PIO"), Cell::Number(44.251_234, 4), Cell::Count(30), Cell::Number(0.5, 3)]);
        table.rows.push(vec![Cell::text("PIO+"), Cell::Number(f64::NAN, 4), Cell::Count(7), Cell::Empty]);
        assert_eq!(table.text(), "  method  J      runs  paper\n  PIO     44.25    30  0.500\n  PIO+    NaN       7\n");
        let markdown = "| method | J | runs | paper |\n| --- | --- | --- | --- |\n| PIO | 44.25 | 30 | 0.500 |\n\
                        | PIO+ | NaN | 7 |  |\n";
        assert_eq!(table.markdown(), markdown);
        let mut csv = Vec::new();
        table.write_csv(&mut csv).unwrap();
        assert_eq!(String::from_utf8(csv).unwrap(), "method,J,runs,paper\nPIO,44.251234,30,0.5\nPIO+,NaN,7,\n");
        let json = serde_json::to_string(&table).unwrap();
        assert!(json.contains(r#"{"method":"PIO+","J":null,"runs":7,"paper":null}"#), "{json}");
    }
}
