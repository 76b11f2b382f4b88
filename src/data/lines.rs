//! A reader that hands out one line at a time, so that whoever parses it never runs ahead of the line it is on.

use std::io::{self, BufRead, BufReader, Read};

use super::{Format, LogError, Place};

/// No honest row is longer; without a limit a binary file would be read whole in search of a line end.
const LONGEST_LINE: u64 = 1 << 20;

/// Lines of a text, with their numbers. As a [`Read`] it returns bytes of one line per call, so after a record was
/// parsed [`Self::number`] and [`Self::text`] are those of the record's last line.
pub(super) struct Lines<'a> {
    file: Box<str>,
    inner: BufReader<&'a mut dyn Read>,
    line: Vec<u8>,
    taken: usize,
    number: u64,
    ended: bool,
    /// The line that the header is on, if it is known; lines before it are left out, and it is no comment.
    header: u64,
    /// Whether any number of blanks is one separator; what is read is then another text than the line.
    blanks: bool,
    fed: Vec<u8>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(reader: &'a mut dyn Read, file: &str, format: &Format) -> Self {
        let inner = BufReader::new(reader);
        let (header, blanks) = (format.header_line.unwrap_or(0), format.separator == Some(' '));
        let (line, fed) = (Vec::new(), Vec::new());
        Self { file: file.into(), inner, line, taken: 0, number: 0, ended: false, header, blanks, fed }
    }

    /// Number of the current line, from 1; at the end one more than the last.
    pub(super) const fn number(&self) -> u64 {
        self.number
    }

    /// The current line and its `\n` (added where the last line has none), whatever was already taken of it.
    pub(super) fn text(&self) -> &[u8] {
        &self.line
    }

    pub(super) fn place(&self) -> Place {
        Place { file: self.file.clone(), line: self.number, column: None }
    }

    /// Moves to the next line that is neither blank nor a comment; false at the end.
    pub(super) fn advance_to_content(&mut self) -> Result<bool, LogError> {
        while self.advance()? {
            let text = self.line.trim_ascii();
            if !text.is_empty() && !text.starts_with(b"#") && self.number >= self.header {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn advance(&mut self) -> Result<bool, LogError> {
        if self.ended {
            return Ok(false);
        }
        self.line.clear();
        self.taken = 0;
        let read = (&mut self.inner).take(LONGEST_LINE + 1).read_until(b'\n', &mut self.line);
        let read = read.map_err(|error| match error.kind() {
            io::ErrorKind::IsADirectory => LogError::Directory { file: self.file.clone() },
            _ => LogError::Io { file: self.file.clone(), error },
        })?;
        self.number += 1;
        if read == 0 {
            self.ended = true;
            return Ok(false);
        }
        if self.number == 1 && self.line.starts_with(b"\xEF\xBB\xBF") {
            self.line.drain(..3);
        }
        if let Some(found) = self.binary() {
            return Err(LogError::Binary { place: self.place(), found });
        }
        if !self.line.ends_with(b"\n") {
            self.line.push(b'\n');
        }
        if self.number == self.header
            && let Some(mark) =
                self.line.iter().position(|b| !b.is_ascii_whitespace()).filter(|&i| self.line[i] == b'#')
        {
            self.line[mark] = b' ';
        }
        if self.blanks {
            part_by_one_blank(&self.line, &mut self.fed);
        }
        Ok(true)
    }

    /// What the parser gets of the current line.
    fn content(&self) -> &[u8] {
        if self.blanks { &self.fed } else { &self.line }
    }

    fn binary(&self) -> Option<&'static str> {
        if self.number == 1 && (self.line.starts_with(b"\xFF\xFE") || self.line.starts_with(b"\xFE\xFF")) {
            return Some("UTF-16");
        }
        if self.line.contains(&0) {
            return Some("a zero byte");
        }
        (self.line.len() as u64 > LONGEST_LINE).then_some("a line of more than a mebibyte")
    }
}

impl Read for Lines<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.taken == self.content().len() && !self.advance().map_err(io::Error::other)? {
            return Ok(0);
        }
        let count = out.len().min(self.content().len() - self.taken);
        out[..count].copy_from_slice(&self.content()[self.taken..self.taken + count]);
        self.taken += count;
        Ok(count)
    }
}

/// One blank for any number of blanks and tabs outside quotes, none at either end.
fn part_by_one_blank(line: &[u8], out: &mut Vec<u8>) {
    out.clear();
    let (mut quoted, mut pending) = (false, false);
    for &byte in line.trim_ascii() {
        quoted ^= byte == b'"';
        if matches!(byte, b' ' | b'\t') && !quoted {
            pending = true;
            continue;
        }
        if std::mem::take(&mut pending) {
            out.push(b' ');
        }
        out.push(byte);
    }
    out.push(b'\n');
}
