//! Tables of results: as aligned text, Markdown, CSV and JSON.

use std::fmt;
use std::io;

use serde::Serialize;
use serde::ser::{SerializeMap as _, SerializeSeq as _, Serializer};

use crate::number::{exact, significant};

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
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::text(text)
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

/// Rows under column heads. As text and Markdown a column without a single cell is left out, and one of numbers is
/// aligned right.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Name of its file, without ending; may be empty.
    pub name: &'static str,
    /// What it shows, with what its words mean; may be empty.
    pub title: String,
    /// Column heads.
    pub columns: Vec<String>,
    /// Rows; cells that one lacks at its end are empty.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub(crate) fn new(name: &'static str, title: impl Into<String>, columns: &[&str]) -> Self {
        Self { name, title: title.into(), ..Self::of(columns.iter().copied()) }
    }

    /// A table without rows, name and title.
    pub(crate) fn of<C: Into<String>>(columns: impl IntoIterator<Item = C>) -> Self {
        Self { columns: columns.into_iter().map(Into::into).collect(), ..Self::default() }
    }

    /// Appends a row.
    pub(crate) fn push<C: Into<Cell>>(&mut self, row: impl IntoIterator<Item = C>) {
        self.rows.push(row.into_iter().map(Into::into).collect());
    }

    /// The table without these columns.
    pub(crate) fn without(&self, heads: &[&str]) -> Self {
        let kept: Vec<usize> =
            (0..self.columns.len()).filter(|c| !heads.contains(&self.columns[*c].as_str())).collect();
        let row = |row: &Vec<Cell>| kept.iter().map(|c| row.get(*c).cloned().unwrap_or(Cell::Empty)).collect();
        Self {
            columns: kept.iter().map(|c| self.columns[*c].clone()).collect(),
            rows: self.rows.iter().map(row).collect(),
            ..self.clone()
        }
    }

    /// Heads and cells of the columns that are shown, by column; whether each is of numbers.
    fn shown(&self, text: impl Fn(&str) -> String) -> Vec<(Vec<String>, bool)> {
        let is_number = |cell: &String| cell.starts_with(|first: char| first.is_ascii_digit() || first == '-');
        let column = |(c, head): (usize, &String)| {
            let cells: Vec<String> =
                self.rows.iter().map(|row| row.get(c).map_or_else(String::new, ToString::to_string)).collect();
            let mut filled = cells.iter().filter(|cell| !cell.is_empty()).peekable();
            filled.peek()?;
            let is_numeric = filled.all(is_number);
            Some((std::iter::once(head).chain(&cells).map(|cell| text(cell)).collect(), is_numeric))
        };
        self.columns.iter().enumerate().filter_map(column).collect()
    }

    /// The table in Markdown, without its title; no cell is markup but for code in backticks.
    #[must_use]
    pub fn markdown(&self) -> String {
        let shown = self.shown(escaped);
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let row = |k: usize| line(shown.iter().map(|(cells, _)| cells[k].as_str()).collect());
        let rule = line(shown.iter().map(|(_, is_numeric)| if *is_numeric { "---:" } else { "---" }).collect());
        [row(0), rule].into_iter().chain((1..=self.rows.len()).map(row)).collect()
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

/// The table as aligned text, without its title.
impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = self.shown(str::to_owned);
        let widths: Vec<usize> =
            shown.iter().map(|(cells, _)| cells.iter().map(|c| c.chars().count()).max().unwrap_or(0)).collect();
        for k in 0..=self.rows.len() {
            let mut line = String::from(" ");
            for ((cells, is_numeric), width) in shown.iter().zip(&widths) {
                let cell = &cells[k];
                line += &if *is_numeric { format!(" {cell:>width$} ") } else { format!(" {cell:<width$} ") };
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Text on one line of Markdown in which nothing is markup but `code`.
pub(crate) fn escaped(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    // Backticks come in pairs; one without another is a character.
    let paired = (parts.len() - 1) / 2 * 2;
    let mut escaped = String::with_capacity(text.len());
    for (i, part) in parts.iter().enumerate() {
        if i > 0 {
            escaped += if i <= paired { "`" } else { "\\`" };
        }
        let is_code = i % 2 == 1 && i < paired;
        let mut characters = part.chars().peekable();
        while let Some(c) = characters.next() {
            let opens_tag = |next: &char| next.is_ascii_alphabetic() || ['/', '!', '?'].contains(next);
            let is_markup = match c {
                '|' => true,
                _ if is_code => false,
                '<' => characters.peek().is_some_and(opens_tag),
                '>' => escaped.is_empty(),
                _ => ['\\', '*', '_', '[', ']', '#', '~', '$', '&'].contains(&c),
            };
            escaped.extend(is_markup.then_some('\\'));
            escaped.push(if c.is_control() { ' ' } else { c });
        }
    }
    escaped
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
        table.push([Cell::text("PIO"), Cell::Number(44.251_234, 4), Cell::Count(30), Cell::Number(0.5, 3)]);
        table.push([Cell::text("PIO+"), Cell::Number(f64::NAN, 4), Cell::Count(7), Cell::Empty]);
        assert_eq!(
            table.to_string(),
            "  method  J      runs  paper\n  PIO     44.25    30  0.500\n  PIO+    NaN       7\n"
        );
        let markdown = "| method | J | runs | paper |\n| --- | --- | ---: | ---: |\n| PIO | 44.25 | 30 | 0.500 |\n\
                        | PIO+ | NaN | 7 |  |\n";
        assert_eq!(table.markdown(), markdown);
        let mut csv = Vec::new();
        table.write_csv(&mut csv).unwrap();
        assert_eq!(String::from_utf8(csv).unwrap(), "method,J,runs,paper\nPIO,44.251234,30,0.5\nPIO+,NaN,7,\n");
        let json = serde_json::to_string(&table).unwrap();
        assert!(json.contains(r#"{"method":"PIO+","J":null,"runs":7,"paper":null}"#), "{json}");
    }

    #[test]
    fn numbers_are_right_aligned_and_empty_columns_left_out() {
        let mut table = Table::of(["parameter", "unit", "tuned"]);
        table.push(["q", "", "1468.5"]);
        table.push(["sigma", "", "-2"]);
        assert_eq!(table.to_string(), "  parameter   tuned\n  q          1468.5\n  sigma          -2\n");
        let markdown = "| parameter | tuned |\n| --- | ---: |\n| q | 1468.5 |\n| sigma | -2 |\n";
        assert_eq!(table.markdown(), markdown);
    }

    #[test]
    fn nothing_of_the_users_is_markup_but_code() {
        assert_eq!(escaped("a|b_c*d`e\n<f> & [g]"), "a\\|b\\_c\\*d\\`e \\<f> \\& \\[g\\]");
        assert_eq!(escaped("> `a_b|c` _ <= `d"), "\\> `a_b\\|c` \\_ <= \\`d");
    }
}
