//! Delimited text as a header and a stream of rows, with the exact place of every cell.

use std::borrow::Cow;
use std::io::Read;

use csv::ByteRecord;

use super::lines::Lines;
use super::{Format, LogError, Place};
use crate::words;

/// Spellings of a missing value, besides NaN.
const MISSING: [&str; 3] = ["", "na", "null"];

/// The rows of a CSV text. Holds one row at a time.
pub(crate) struct Rows<'a> {
    file: Box<str>,
    header_line: u64,
    names: Vec<String>,
    delimiter: u8,
    format: Format,
    csv: csv::Reader<Lines<'a>>,
    record: ByteRecord,
    /// Whether a row has been read.
    begun: bool,
}

impl<'a> Rows<'a> {
    /// Reads up to the end of the header. Unless `format` names a separator, it is the one of `,` `;` tab that the header
    /// has most of.
    pub(crate) fn open(reader: &'a mut dyn Read, file: &str, format: &Format) -> Result<Self, LogError> {
        let mut lines = Lines::new(reader, file, format);
        let found = lines.advance_to_content()?;
        match format.header_line {
            Some(line) if !found || lines.number() != line => {
                return Err(LogError::NoHeaderLine { file: file.into(), line });
            }
            _ if !found => return Err(LogError::Empty { file: file.into() }),
            _ => {}
        }
        let named = format.separator.and_then(|c| u8::try_from(c).ok());
        let delimiter = named.unwrap_or_else(|| sniff(lines.text()));
        let csv = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .comment(Some(b'#'))
            .has_headers(false)
            .flexible(true)
            .from_reader(lines);
        let (file, format, record) = (file.into(), format.clone(), ByteRecord::new());
        let mut rows = Self { file, header_line: 0, names: Vec::new(), delimiter, format, csv, record, begun: false };
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
            if self.is_skipped() || self.is_left_out()? {
                continue;
            }
            if self.record.len() != self.names.len() {
                return Err(self.ragged());
            }
            self.begun = true;
            return Ok(true);
        }
    }

    /// Whether `skip_lines` names the current row, which must then not be one of numbers.
    fn is_left_out(&self) -> Result<bool, LogError> {
        if self.format.skip_lines.binary_search(&self.line()).is_err() {
            return Ok(false);
        }
        let mut texts = (0..self.record.len()).map(|i| self.cell(i).unwrap_or("?")).filter(|t| !Self::is_missing(t));
        let numbers = |text: &str| self.plain(text).is_some_and(|plain| plain.parse::<f64>().is_ok());
        let is_row = texts.clone().next().is_some() && texts.all(numbers);
        if is_row { Err(LogError::SkippedNumbers { place: self.place(0) }) } else { Ok(true) }
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
        match self.plain(text).and_then(|plain| plain.parse::<f64>().ok()) {
            Some(value) if value.is_finite() => Ok(value),
            _ if Self::is_missing(text) => Ok(f64::NAN),
            Some(_) => {
                let (place, column) = (self.place(i), self.name(i));
                Err(LogError::Infinite { place, column, found: shorten(text), remedy })
            }
            None => {
                let remedy = self.advice(text).unwrap_or(remedy);
                let (place, column) = (self.place(i), self.name(i));
                Err(LogError::NotNumber { place, column, found: shorten(text), remedy })
            }
        }
    }

    /// As [`Format::plain`].
    pub(crate) fn plain<'t>(&self, text: &'t str) -> Option<Cow<'t, str>> {
        self.format.plain(text)
    }

    /// What to do about a number of another country than the format's.
    pub(crate) fn advice(&self, text: &str) -> Option<&'static str> {
        let reads = |decimal_comma, mark| {
            let format = Format { decimal_comma, thousands: mark, ..Format::default() };
            format.plain(text).is_some_and(|plain| plain.parse::<f64>().is_ok())
        };
        match &self.format {
            Format { decimal_comma: true, .. } if reads(false, None) => {
                Some("a decimal point, and [data] says decimal = \",\"")
            }
            Format { decimal_comma: false, .. } if reads(true, None) => {
                Some("a decimal comma: give decimal = \",\" in [data], or write a decimal point")
            }
            _ if reads(true, Some('.')) => Some(
                "digits grouped by points, and a decimal comma: give thousands = \".\" and decimal = \",\" in [data]",
            ),
            _ if reads(false, Some(',')) => Some("digits grouped by commas: give thousands = \",\" in [data]"),
            _ if reads(false, Some('\'')) => Some("digits grouped by ': give thousands = \"'\" in [data]"),
            _ if reads(self.format.decimal_comma, Some(' ')) => {
                Some("digits grouped by blanks: give thousands = \" \" in [data]")
            }
            _ => None,
        }
    }

    /// Whether a text is a number but for its decimal comma.
    pub(crate) fn has_decimal_comma(text: &str) -> bool {
        text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok()
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
        let more = self.record.len() > self.names.len();
        let digits = |cell: &[u8]| !cell.is_empty() && cell.iter().all(|b| b.is_ascii_digit() || *b == b'-');
        let hint = if self.breaks() > 0 {
            " (is a quote left open?)"
        } else if more && self.delimiter == b',' && self.record.iter().all(digits) {
            " (decimal commas? part the cells by ; or put numbers in quotes, and give decimal = \",\" in [data])"
        } else if more
            && !self.begun
            && self.record.iter().next_back().is_some_and(|last| !last.trim_ascii().is_empty())
        {
            " (do lines stand before the header? give `header_line` in [data])"
        } else {
            ""
        };
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
    if delimiter == b' ' {
        return word(line, i);
    }
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

/// 1-based character at which word `i` starts in a line whose words are parted by blanks.
fn word(line: &[u8], i: usize) -> Option<usize> {
    let (mut next, mut quoted, mut inside) = (0, false, false);
    for (at, &byte) in line.iter().enumerate() {
        let is_blank = byte.is_ascii_whitespace() && !quoted;
        if !is_blank && !inside {
            if next == i {
                return Some(line[..at].iter().filter(|&&b| b & 0xC0 != 0x80).count() + 1);
            }
            next += 1;
        }
        inside = !is_blank;
        quoted ^= byte == b'"';
    }
    None
}
