//! Candidates as CSV: a header with the names of the searched parameters in any order, then one candidate a line.
//!
//! Input is answered as it comes: a batch is whatever has already arrived (at least one line), so a program that
//! writes one line and waits gets its answer, and a large file is read in batches of bounded size.

use std::io::{BufRead as _, BufReader, Read};

use anyhow::{Context as _, bail, ensure};

use crate::evaluate::Population;
use crate::words::{listed, shorten};

/// Bytes read at once; also what bounds a batch.
const BUFFER: usize = 1 << 20;
/// Longest line that is taken for text.
const LONGEST_LINE: u64 = 1 << 20;

/// Reads batches of candidates.
#[derive(Debug)]
pub(super) struct Candidates<R> {
    input: BufReader<R>,
    source: String,
    /// Searched parameter of each column.
    order: Vec<usize>,
    names: Vec<String>,
    line: u64,
    /// An error met behind candidates that are to be answered first.
    pending: Option<anyhow::Error>,
}

/// What has arrived.
#[derive(Debug, PartialEq)]
pub(super) struct Batch {
    /// Every candidate that can be scored, in order.
    pub(super) candidates: Population,
    /// One entry a line: the number of the line, and why it is no candidate.
    pub(super) lines: Vec<(u64, Result<(), String>)>,
}

impl<R: Read> Candidates<R> {
    /// Reads the header. `names` are the searched parameters in the order of a candidate.
    pub(super) fn open(input: R, source: &str, names: &[&str]) -> anyhow::Result<Self> {
        let names = names.iter().map(ToString::to_string).collect();
        let input = BufReader::with_capacity(BUFFER, input);
        let mut candidates =
            Self { input, source: source.to_owned(), order: Vec::new(), names, line: 0, pending: None };
        let Some(header) = candidates.next_line()? else {
            let expected = listed(&candidates.names);
            bail!("{source}: the file is empty (expected a header with the searched parameters: {expected})");
        };
        let at = candidates.position(candidates.line);
        let header = header.map_err(|problem| anyhow::anyhow!("{at}: {problem}"))?;
        candidates.order = candidates.columns(&header)?;
        Ok(candidates)
    }

    /// The lines that have arrived, at least one; `None` at the end of the input. After an error of reading, the lines
    /// before it come first and the error with the next call.
    pub(super) fn next_batch(&mut self) -> anyhow::Result<Option<Batch>> {
        if let Some(error) = self.pending.take() {
            return Err(error);
        }
        let mut batch = Batch { candidates: Population::new(self.names.len()), lines: Vec::new() };
        while batch.lines.is_empty() || self.has_arrived() {
            match self.next_line() {
                Ok(Some(text)) => {
                    let candidate = text.and_then(|text| self.candidate(&text));
                    let read = candidate.map(|candidate| batch.candidates.push(&candidate));
                    batch.lines.push((self.line, read));
                }
                Ok(None) => break,
                Err(error) if batch.lines.is_empty() => return Err(error),
                Err(error) => {
                    self.pending = Some(error);
                    break;
                }
            }
        }
        Ok((!batch.lines.is_empty()).then_some(batch))
    }

    /// `file:line`.
    pub(super) fn position(&self, line: u64) -> String {
        format!("{}:{line}", self.source)
    }

    /// Whether a whole line that is not blank can be read without waiting.
    fn has_arrived(&self) -> bool {
        self.input.buffer().trim_ascii_start().contains(&b'\n')
    }

    /// The candidate of a line, or what is wrong with it.
    fn candidate(&self, text: &str) -> Result<Vec<f64>, String> {
        let fields = text.split(',').count();
        let columns = self.order.len();
        if fields != columns {
            return Err(format!("expected {columns} values as in the header, found {fields}"));
        }
        let mut candidate = vec![f64::NAN; columns];
        for (field, &parameter) in text.split(',').map(str::trim).zip(&self.order) {
            let name = shorten(&self.names[parameter]);
            candidate[parameter] = match field.parse::<f64>() {
                Ok(value) if value.is_finite() => value,
                _ => return Err(format!("column {name:?}: expected a finite number, found {:?}", shorten(field))),
            };
        }
        Ok(candidate)
    }

    /// The next line that is not blank, without its end, or why it is none.
    fn next_line(&mut self) -> anyhow::Result<Option<Result<String, String>>> {
        loop {
            let mut bytes = Vec::new();
            let read = (&mut self.input).take(LONGEST_LINE).read_until(b'\n', &mut bytes);
            let length = read.with_context(|| format!("cannot read {}", self.source))?;
            if length == 0 {
                return Ok(None);
            }
            self.line += 1;
            if length as u64 == LONGEST_LINE && !bytes.ends_with(b"\n") {
                self.input.skip_until(b'\n').with_context(|| format!("cannot read {}", self.source))?;
                return Ok(Some(Err(format!("expected a line of fewer than {LONGEST_LINE} bytes"))));
            }
            let text = String::from_utf8(bytes).ok().filter(|text| !text.contains('\0'));
            let Some(text) = text else {
                return Ok(Some(Err("expected a line of UTF-8 text, found binary data".to_owned())));
            };
            let text = text.trim_start_matches('\u{feff}').trim();
            if !text.is_empty() {
                return Ok(Some(Ok(text.to_owned())));
            }
        }
    }

    fn columns(&self, header: &str) -> anyhow::Result<Vec<usize>> {
        let at = self.position(self.line);
        let expected = listed(&self.names);
        let mut order = Vec::new();
        for name in header.split(',').map(|field| field.trim().trim_matches('"')) {
            let shown = shorten(name);
            let Some(parameter) = self.names.iter().position(|n| n == name) else {
                let hint = self.hint(name);
                bail!("{at}: unknown column {shown:?}{hint} (expected the searched parameters: {expected})");
            };
            ensure!(!order.contains(&parameter), "{at}: column {shown:?} is named twice (keep one of them)");
            order.push(parameter);
        }
        if let Some(missing) = (0..self.names.len()).find(|i| !order.contains(i)) {
            let missing = shorten(&self.names[missing]);
            bail!("{at}: column {missing:?} is missing (expected the searched parameters: {expected})");
        }
        Ok(order)
    }

    fn hint(&self, unknown: &str) -> String {
        let unknown = shorten(unknown);
        let near = self.names.iter().map(|name| (strsim::damerau_levenshtein(name, &unknown), name)).min();
        near.filter(|(distance, _)| *distance <= 2)
            .map_or_else(String::new, |(_, name)| format!(", did you mean {:?}?", shorten(name)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives its pieces one a read, as a pipe does.
    #[derive(Debug)]
    struct Pieces(Vec<&'static str>);

    impl Read for Pieces {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            if self.0.is_empty() {
                return Ok(0);
            }
            let piece = self.0.remove(0).as_bytes();
            into[..piece.len()].copy_from_slice(piece);
            Ok(piece.len())
        }
    }

    fn open(text: &'static str) -> anyhow::Result<Candidates<Pieces>> {
        Candidates::open(Pieces(vec![text]), "c.csv", &["q", "r"])
    }

    fn population(values: &[f64]) -> Population {
        Population::from_rows(2, values.to_vec())
    }

    #[test]
    fn columns_may_stand_in_any_order() {
        let batch = open("\u{feff}r, \"q\"\r\n1, 2\r\n\r\n3,4").unwrap().next_batch().unwrap().unwrap();
        assert_eq!(batch.candidates, population(&[2.0, 1.0]), "the unfinished last line is its own batch");
        let mut both = open("r,q\n1,2\n3,4\n").unwrap();
        assert_eq!(both.next_batch().unwrap().unwrap().candidates, population(&[2.0, 1.0, 4.0, 3.0]));
        assert!(both.next_batch().unwrap().is_none(), "the end");
    }

    #[test]
    fn what_has_arrived_is_a_batch() {
        let mut candidates =
            Candidates::open(Pieces(vec!["q,r\n", "1,2\n\n", "3,4\n5,6\n"]), "-", &["q", "r"]).unwrap();
        let sizes: Vec<usize> =
            std::iter::from_fn(|| candidates.next_batch().unwrap()).map(|b| b.lines.len()).collect();
        assert_eq!(sizes, [1, 2]);
    }

    #[test]
    fn a_line_that_is_no_candidate_keeps_its_place() {
        let mut candidates = open("q,r\n1,2\n3,x\n\n5,6\n7\n").unwrap();
        let Batch { candidates: read, lines } = candidates.next_batch().unwrap().unwrap();
        assert_eq!(read, population(&[1.0, 2.0, 5.0, 6.0]));
        let why: Vec<_> = lines.iter().map(|(line, read)| (*line, read.as_ref().err().map(String::as_str))).collect();
        let expected = [
            (2, None),
            (3, Some("column \"r\": expected a finite number, found \"x\"")),
            (5, None),
            (6, Some("expected 2 values as in the header, found 1")),
        ];
        assert_eq!(why, expected);
    }

    #[test]
    fn every_kind_of_junk_is_told() {
        let endless = "1".repeat(3 << 20) + "\n1,2\n";
        let cases = [
            ("1,inf\n", "column \"r\": expected a finite number, found \"inf\""),
            ("NaN,1\n", "column \"q\": expected a finite number, found \"NaN\""),
            ("1,\n", "column \"r\": expected a finite number, found \"\""),
            (",\n", "column \"q\": expected a finite number, found \"\""),
            ("1,2,3\n", "expected 2 values as in the header, found 3"),
            ("1,\0\n", "expected a line of UTF-8 text, found binary data"),
            (endless.leak(), "expected a line of fewer than 1048576 bytes"),
        ];
        for (text, expected) in cases {
            let whole = format!("q,r\n{text}3,4\n");
            let mut candidates = Candidates::open(whole.as_bytes(), "c.csv", &["q", "r"]).unwrap();
            let mut lines = Vec::new();
            while let Some(batch) = candidates.next_batch().unwrap() {
                lines.extend(batch.lines);
            }
            assert_eq!(lines[0], (2, Err(expected.to_owned())));
            assert!(lines.len() > 1 && lines[1..].iter().all(|(_, read)| read.is_ok()), "{expected}: what follows");
        }
    }

    #[test]
    fn a_bad_header_is_told_with_its_line() {
        let cases = [
            ("", "c.csv: the file is empty"),
            ("q,s\n", "c.csv:1: unknown column \"s\", did you mean \"q\"?"),
            ("q\n", "c.csv:1: column \"r\" is missing"),
            ("q,r,q\n", "c.csv:1: column \"q\" is named twice"),
            ("q,\0\n", "c.csv:1: expected a line of UTF-8 text, found binary data"),
        ];
        for (text, expected) in cases {
            let message = open(text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{text:?}: {message}");
        }
    }
}
