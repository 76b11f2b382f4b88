//! Delimited text as a header and a stream of rows, with the exact place of every cell.

use std::io::Read;

use csv::ByteRecord;

use super::lines::Lines;
use super::{LogError, Place};
use crate::words;

/// Spellings of a missing value, besides NaN.
const MISSING: [&str; 3] = ["", "na", "null"];

/// The rows of a CSV text. Holds one row at a time.
pub(crate) struct Rows<'a> {
    file: Box<str>,
    header_line: u64,
    names: Vec<String>,
    delimiter: u8,
    csv: csv::Reader<Lines<'a>>,
    record: ByteRecord,
}

impl<'a> Rows<'a> {
    /// Reads up to the end of the header. The delimiter is the one of `,` `;` tab that the header has most of.
    pub(crate) fn open(reader: &'a mut dyn Read, file: &str) -> Result<Self, LogError> {
        let mut lines = Lines::new(reader, file);
        if !lines.advance_to_content()? {
            return Err(LogError::Empty { file: file.into() });
        }
        let delimiter = sniff(lines.text());
        let csv = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .comment(Some(b'#'))
            .has_headers(false)
            .flexible(true)
            .from_reader(lines);
        let mut rows =
            Self { file: file.into(), header_line: 0, names: Vec::new(), delimiter, csv, record: ByteRecord::new() };
        rows.next_record()?;
        rows.header_line = rows.line();
        for i in 0..rows.record.len() {
            let name = rows.cell(i)?.to_owned();
            if let Some(first) = rows.names.iter().position(|n| *n == name && !n.is_empty()) {
                let (place, column) = (rows.place(i), shorten(&name));
                return Err(LogError::DuplicateColumn { place, column, first: first + 1, second: i + 1 });
            }
            rows.names.push(name);
        }
        Ok(rows)
    }

    /// Names of the header's columns.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Where the header is.
    pub(crate) fn header_place(&self) -> Place {
        Place { file: self.file.clone(), line: self.header_line, column: None }
    }

    /// Whether every name of the header is a number, so that the first row of data was taken for it.
    pub(crate) fn header_is_numbers(&self) -> bool {
        self.names.iter().all(|name| name.parse::<f64>().is_ok())
    }

    /// Reads the next row; false at the end.
    pub(crate) fn advance(&mut self) -> Result<bool, LogError> {
        loop {
            if !self.next_record()? {
                return Ok(false);
            }
            if self.record.len() == self.names.len() && !self.is_skipped() {
                return Ok(true);
            }
            if !self.is_skipped() {
                return Err(self.ragged());
            }
        }
    }

    /// Line on which the current row starts.
    pub(crate) fn line(&self) -> u64 {
        self.csv.get_ref().number() - self.breaks() as u64
    }

    /// Cell `i` of the current row without surrounding blanks.
    pub(crate) fn cell(&self, i: usize) -> Result<&str, LogError> {
        let bytes = self.record.get(i).unwrap_or_default();
        std::str::from_utf8(bytes).map(str::trim).map_err(|_| LogError::NotUtf8 { place: self.place(i) })
    }

    /// Whether a cell's text stands for a missing value.
    pub(crate) fn is_missing(text: &str) -> bool {
        MISSING.iter().any(|m| text.eq_ignore_ascii_case(m)) || text.parse::<f64>().is_ok_and(f64::is_nan)
    }

    /// Cell `i` as a finite number, NaN if missing; `remedy` ends the message where it is neither.
    pub(crate) fn number(&self, i: usize, remedy: &'static str) -> Result<f64, LogError> {
        let text = self.cell(i)?;
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ if Self::is_missing(text) => Ok(f64::NAN),
            Ok(_) => {
                let (place, column) = (self.place(i), self.name(i));
                Err(LogError::Infinite { place, column, found: shorten(text), remedy })
            }
            Err(_) => {
                let comma = text.replacen(',', ".", 1).parse::<f64>().is_ok();
                let remedy = if comma { "write a decimal point" } else { remedy };
                let (place, column) = (self.place(i), self.name(i));
                Err(LogError::NotNumber { place, column, found: shorten(text), remedy })
            }
        }
    }

    /// Name of column `i`, for messages.
    pub(crate) fn name(&self, i: usize) -> Box<str> {
        shorten(self.names.get(i).map(String::as_str).unwrap_or_default())
    }

    /// Where cell `i` of the current row is; a row of several lines has no character column.
    pub(crate) fn place(&self, i: usize) -> Place {
        let raw = self.csv.get_ref().text();
        let column = (self.breaks() == 0).then(|| character(raw, self.delimiter, i)).flatten();
        Place { file: self.file.clone(), line: self.line(), column }
    }

    fn next_record(&mut self) -> Result<bool, LogError> {
        self.csv.read_byte_record(&mut self.record).map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(error) => match error.downcast::<LogError>() {
                Ok(own) => own,
                Err(error) => LogError::Io { file: self.file.clone(), error },
            },
            other => LogError::Io { file: self.file.clone(), error: std::io::Error::other(format!("{other:?}")) },
        })
    }

    /// Line breaks inside quoted cells of the current row.
    fn breaks(&self) -> usize {
        self.record.as_slice().iter().filter(|&&b| b == b'\n').count()
    }

    /// A line of blanks, or a comment after blanks: the parser below skips only wholly empty lines and a leading `#`.
    fn is_skipped(&self) -> bool {
        let text = self.csv.get_ref().text().trim_ascii_start();
        self.breaks() == 0 && (text.is_empty() || text.starts_with(b"#"))
    }

    fn ragged(&self) -> LogError {
        let hint = if self.breaks() > 0 { " (is a quote left open?)" } else { "" };
        let place = Place { column: None, ..self.place(0) };
        LogError::Ragged { place, found: self.record.len(), expected: self.names.len(), hint }
    }
}

/// A cell in a message.
pub(super) fn shorten(text: &str) -> Box<str> {
    words::shorten(text).into()
}

fn sniff(header: &[u8]) -> u8 {
    let mut quoted = false;
    let mut counts = [(b',', 0), (b';', 0), (b'\t', 0)];
    for &byte in header {
        quoted ^= byte == b'"';
        for (delimiter, count) in &mut counts {
            *count += usize::from(!quoted && byte == *delimiter);
        }
    }
    // max_by_key keeps the last of equals: reversed, the comma wins a tie.
    counts.iter().rev().max_by_key(|(_, count)| *count).map_or(b',', |(delimiter, _)| *delimiter)
}

/// 1-based character at which the content of cell `i` starts in a line.
fn character(line: &[u8], delimiter: u8, i: usize) -> Option<usize> {
    let (mut cell, mut quoted, mut opening) = (0, false, true);
    for (at, &byte) in line.iter().enumerate() {
        let is_blank = byte.is_ascii_whitespace() && !matches!(byte, b'\r' | b'\n') && byte != delimiter;
        if cell == i && !is_blank {
            let characters = line[..at].iter().filter(|&&b| b & 0xC0 != 0x80).count();
            return Some(characters + 1);
        }
        if byte == b'"' && (opening || quoted) {
            quoted = !quoted;
        }
        opening = byte == delimiter && !quoted;
        cell += usize::from(opening);
    }
    None
}
