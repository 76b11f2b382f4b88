//! Candidates as CSV: a header with the names of the searched parameters in any order, then one candidate a line.
//!
//! Input is answered as it comes: a batch is whatever has already arrived (at least one line), so a program that
//! writes one line and waits gets its answer, and a large file is read in batches of bounded size.

use std::io::{BufRead as _, BufReader, Read};

use crate::evaluate::Population;
use anyhow::{Context as _, bail, ensure};

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

impl<R: Read> Candidates<R> {
    /// Reads the header. `names` are the searched parameters in the order of a candidate.
    pub(super) fn open(input: R, source: &str, names: &[&str]) -> anyhow::Result<Self> {
        let names = names.iter().map(ToString::to_string).collect();
        let input = BufReader::with_capacity(BUFFER, input);
        let mut candidates =
            Self { input, source: source.to_owned(), order: Vec::new(), names, line: 0, pending: None };
        let expected = candidates.names.join(",");
        let Some(header) = candidates.next_line()? else {
            bail!("{source}: the file is empty (expected a header with the searched parameters: {expected})");
        };
        candidates.order = candidates.columns(&header)?;
        Ok(candidates)
    }

    /// The candidates that have arrived, at least one; `None` at the end of the input. After a bad line, the
    /// candidates before it come first and the error with the next call.
    pub(super) fn next_batch(&mut self) -> anyhow::Result<Option<Population>> {
        if let Some(error) = self.pending.take() {
            return Err(error);
        }
        let mut batch = Population::new(self.names.len());
        while batch.is_empty() || self.has_arrived() {
            match self.next_candidate() {
                Ok(Some(candidate)) => batch.push(&candidate),
                Ok(None) => break,
                Err(error) if batch.is_empty() => return Err(error),
                Err(error) => {
                    self.pending = Some(error);
                    break;
                }
            }
        }
        Ok((!batch.is_empty()).then_some(batch))
    }

    /// Whether a whole line that is not blank can be read without waiting.
    fn has_arrived(&self) -> bool {
        self.input.buffer().trim_ascii_start().contains(&b'\n')
    }

    fn next_candidate(&mut self) -> anyhow::Result<Option<Vec<f64>>> {
        let Some(text) = self.next_line()? else { return Ok(None) };
        let fields = text.split(',').count();
        let columns = self.order.len();
        let at = self.position();
        ensure!(fields == columns, "{at}: expected {columns} values as in the header, found {fields}");
        let mut candidate = vec![f64::NAN; columns];
        for (field, &parameter) in text.split(',').map(str::trim).zip(&self.order) {
            let name = &self.names[parameter];
            candidate[parameter] = match field.parse::<f64>() {
                Ok(value) if value.is_finite() => value,
                _ => bail!("{at}: column {name:?}: expected a finite number, found {field:?}"),
            };
        }
        Ok(Some(candidate))
    }

    /// The next line that is not blank, without its end.
    fn next_line(&mut self) -> anyhow::Result<Option<String>> {
        loop {
            let mut bytes = Vec::new();
            let read = (&mut self.input).take(LONGEST_LINE).read_until(b'\n', &mut bytes);
            let length = read.with_context(|| format!("cannot read {}", self.source))?;
            if length == 0 {
                return Ok(None);
            }
            self.line += 1;
            let at = self.position();
            let text = String::from_utf8(bytes).ok();
            let text = text.filter(|t| (t.len() as u64) < LONGEST_LINE && !t.contains('\0'));
            let Some(text) = text else { bail!("{at}: expected a line of UTF-8 text, found binary data") };
            let text = text.trim_start_matches('\u{feff}').trim();
            if !text.is_empty() {
                return Ok(Some(text.to_owned()));
            }
        }
    }

    fn columns(&self, header: &str) -> anyhow::Result<Vec<usize>> {
        let at = self.position();
        let expected = self.names.join(", ");
        let mut order = Vec::new();
        for name in header.split(',').map(|field| field.trim().trim_matches('"')) {
            let Some(parameter) = self.names.iter().position(|n| n == name) else {
                bail!(
                    "{at}: unknown column {name:?}{} (expected the searched parameters: {expected})",
                    self.hint(name)
                );
            };
            ensure!(!order.contains(&parameter), "{at}: column {name:?} is named twice (keep one of them)");
            order.push(parameter);
        }
        if let Some(missing) = (0..self.names.len()).find(|i| !order.contains(i)) {
            bail!("{at}: column {:?} is missing (expected the searched parameters: {expected})", self.names[missing]);
        }
        Ok(order)
    }

    fn hint(&self, unknown: &str) -> String {
        let near = self.names.iter().map(|name| (strsim::damerau_levenshtein(name, unknown), name)).min();
        near.filter(|(distance, _)| *distance <= 2)
            .map_or_else(String::new, |(_, name)| format!(", did you mean {name:?}?"))
    }

    fn position(&self) -> String {
        format!("{}:{}", self.source, self.line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives its pieces one a read, as a pipe does.
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

    fn failure(text: &'static str) -> String {
        let read = open(text).and_then(|mut c| {
            while c.next_batch()?.is_some() {}
            Ok(())
        });
        read.unwrap_err().to_string()
    }

    #[test]
    fn columns_may_stand_in_any_order() {
        let batch = open("\u{feff}r, \"q\"\r\n1, 2\r\n\r\n3,4").unwrap().next_batch().unwrap().unwrap();
        assert_eq!(batch, Population::from_rows(2, vec![2.0, 1.0]), "the unfinished last line is its own batch");
        let mut both = open("r,q\n1,2\n3,4\n").unwrap();
        assert_eq!(both.next_batch().unwrap().unwrap(), Population::from_rows(2, vec![2.0, 1.0, 4.0, 3.0]));
        assert!(both.next_batch().unwrap().is_none(), "the end");
    }

    #[test]
    fn what_has_arrived_is_a_batch() {
        let mut candidates =
            Candidates::open(Pieces(vec!["q,r\n", "1,2\n\n", "3,4\n5,6\n"]), "-", &["q", "r"]).unwrap();
        let sizes: Vec<usize> = std::iter::from_fn(|| candidates.next_batch().unwrap()).map(|b| b.len()).collect();
        assert_eq!(sizes, [1, 2]);
    }

    #[test]
    fn candidates_before_a_bad_line_come_first() {
        let mut candidates = open("q,r\n1,2\n3,x\n5,6\n").unwrap();
        assert_eq!(candidates.next_batch().unwrap().map(|b| b.len()), Some(1));
        let error = candidates.next_batch().unwrap_err();
        assert_eq!(error.to_string(), "c.csv:3: column \"r\": expected a finite number, found \"x\"");
    }

    #[test]
    fn bad_input_is_told_with_its_line() {
        let cases = [
            ("", "c.csv: the file is empty"),
            ("q,s\n", "c.csv:1: unknown column \"s\", did you mean \"q\"?"),
            ("q\n", "c.csv:1: column \"r\" is missing"),
            ("q,r,q\n", "c.csv:1: column \"q\" is named twice"),
            ("q,r\n1\n", "c.csv:2: expected 2 values as in the header, found 1"),
            ("q,r\n1,inf\n", "c.csv:2: column \"r\": expected a finite number, found \"inf\""),
            ("q,r\n1,\n", "c.csv:2: column \"r\": expected a finite number, found \"\""),
            ("q,r\n1,\0\n", "c.csv:2: expected a line of UTF-8 text, found binary data"),
        ];
        for (text, expected) in cases {
            let message = failure(text);
            assert!(message.starts_with(expected), "{text:?}: {message}");
        }
    }
}
