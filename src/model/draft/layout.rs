//! How a file is written, found by looking at it: separator, header, units, decimal commas.

use crate::data::{Format, LogError, Place, looks_like_an_instant, no_instant};

/// Content lines that are looked at.
const SEEN: usize = 2000;
/// Lines that may stand before the header.
const PREAMBLE: usize = 50;
/// Rows after a row of units that must hold numbers.
const AFTER_UNITS: usize = 20;

/// What was found.
pub(super) struct Layout {
    pub(super) format: Format,
    /// A row of units, one a column.
    pub(super) units: Vec<String>,
    /// What is not as usual, in sentences.
    pub(super) said: Vec<String>,
}

/// A line with something on it.
struct Line<'a> {
    number: u64,
    text: &'a str,
}

impl Layout {
    /// # Errors
    /// [`LogError`]: the first line is no header, or numbers have both decimal points and decimal commas.
    pub(super) fn of(text: &[u8], file: &str) -> Result<Self, LogError> {
        let text = String::from_utf8_lossy(&text[..text.len().min(1 << 22)]);
        let (lines, comments) = lines(text.trim_start_matches('\u{FEFF}'));
        let mut layout = Self { format: Format::default(), units: Vec::new(), said: Vec::new() };
        let Some((separator, at)) = layout.table(&lines, &comments) else { return Ok(layout) };
        let rows: Vec<(u64, Vec<&str>)> =
            lines[at..].iter().map(|line| (line.number, cells(line.text, separator))).collect();
        layout.numbers(&rows, separator, file)?;
        layout.refuse_data_as_header(&rows, file)?;
        layout.units(&rows);
        Ok(layout)
    }

    /// The separator, and where rows begin among the lines (the header's own place, unless that is a comment).
    fn table(&mut self, lines: &[Line<'_>], comments: &[Line<'_>]) -> Option<(char, usize)> {
        let first = lines.first()?;
        let usual = usual_separator(first.text);
        let header = |separator: char| {
            let count = usual_count(&lines[lines.len() / 2..], separator)?;
            let is_header = |(i, line): (usize, &Line<'_>)| {
                let cells = cells(line.text, separator);
                // Behind other lines numbers are no header.
                cells.len() == count && (i == 0 || !cells.iter().all(|cell| reads(&Format::default(), cell)))
            };
            let at = lines.iter().take(PREAMBLE).enumerate().position(is_header)?;
            (count > 1).then_some((count, at))
        };
        let as_usual = header(usual).map(|(count, at)| (usual, count, at));
        let other = [';', '\t', ',', ' '].into_iter().find_map(|s| header(s).map(|(count, at)| (s, count, at)));
        let (separator, count, at) = as_usual.filter(|(.., at)| *at == 0).or(other).or(as_usual)?;
        let mut header = &lines[at];
        // numpy.savetxt writes the header as a comment.
        let named =
            |line: &&Line<'_>| line.number < header.number && cells(uncommented(line.text), separator).len() == count;
        let is_data = cells(header.text, separator).iter().all(|cell| reads(&Format::default(), cell));
        let comment = comments.iter().rfind(named).filter(|_| is_data);
        if at > 0 || comment.is_some() {
            header = comment.unwrap_or(header);
            self.format.header_line = Some(header.number);
            self.said.push(format!("line {0} is taken for the header (header_line = {0})", header.number));
        }
        if separator != usual_separator(uncommented(header.text)) {
            self.format.separator = Some(separator);
            let name = if separator == ' ' { "blanks".to_owned() } else { format!("{separator:?}") };
            self.said.push(format!("cells are parted by {name} (separator = {:?})", separator.to_string()));
        }
        Some((separator, at))
    }

    /// Decimal commas and thousands.
    fn numbers(&mut self, rows: &[(u64, Vec<&str>)], separator: char, file: &str) -> Result<(), LogError> {
        let (mut points, mut commas) = (Vec::new(), Vec::new());
        let (mut either, mut marks) = (None, [0_usize; 3]);
        let kinds = [(false, ','), (true, '.'), (false, '\'')];
        for (line, cells) in rows.iter().skip(1) {
            for &cell in cells.iter().filter(|cell| cell.bytes().any(|b| b.is_ascii_digit())) {
                let read =
                    |decimal_comma, thousands| reads(&Format { decimal_comma, thousands, ..Format::default() }, cell);
                let (point, comma) = (read(false, None), read(true, None));
                let grouped = kinds.map(|(decimal_comma, mark)| cell.contains(mark) && read(decimal_comma, Some(mark)));
                match (point, comma, grouped) {
                    (true, ..) if cell.contains('.') && !grouped[1] => points.push((*line, cell)),
                    (true, ..) => {}
                    // 1,234 is either; 0,123 begins no group.
                    (_, true, [true, ..]) if !cell.trim_start_matches(['-', '+']).starts_with('0') => {
                        either = either.or(Some((*line, cell)));
                    }
                    (_, true, _) => commas.push((*line, cell)),
                    _ => marks.iter_mut().zip(grouped).for_each(|(mark, found)| *mark += usize::from(found)),
                }
            }
        }
        let grouped = (0..3).max_by_key(|&i| (marks[i], 3 - i)).filter(|&i| marks[i] > 0).map(|i| kinds[i]);
        let many = |few: usize, others: usize| few * 20 >= others && few > 0;
        if let (Some((line, with_comma)), Some((at, with_point))) = (commas.first(), points.first())
            && many(commas.len(), points.len())
            && many(points.len(), commas.len())
        {
            let point = Place { file: file.into(), line: *at, column: None };
            let (with_point, with_comma) = ((*with_point).into(), (*with_comma).into());
            return Err(LogError::MixedDecimals { point, with_point, with_comma, line: *line });
        }
        let by_groups = grouped.map(|(decimal_comma, _)| decimal_comma);
        let doubtful = either.filter(|_| grouped.is_none() && commas.is_empty() && points.is_empty());
        self.format.decimal_comma = match by_groups {
            Some(decimal_comma) => decimal_comma,
            None if doubtful.is_some() => separator != ',',
            None => commas.len() > points.len(),
        };
        self.format.thousands = match (grouped, either) {
            (Some((_, mark)), _) => Some(mark),
            (None, Some(_)) if !self.format.decimal_comma => Some(','),
            _ => None,
        };
        self.say_numbers(doubtful);
        Ok(())
    }

    fn say_numbers(&mut self, doubtful: Option<(u64, &str)>) {
        let doubt = doubtful.map_or_else(String::new, |(line, cell)| {
            format!("; {cell:?} in line {line} could be either, so check this")
        });
        if self.format.decimal_comma {
            self.said.push(format!("numbers have decimal commas (decimal = \",\"){doubt}"));
        }
        if let Some(mark) = self.format.thousands {
            let doubt = if self.format.decimal_comma { "" } else { &doubt };
            self.said.push(format!("digits are grouped by {mark:?} (thousands = {:?}){doubt}", mark.to_string()));
        }
    }

    /// A first line that holds values where the next does.
    fn refuse_data_as_header(&self, rows: &[(u64, Vec<&str>)], file: &str) -> Result<(), LogError> {
        let ([(line, header), (_, next), ..], None) = (rows, self.format.header_line) else { return Ok(()) };
        let is_value = |cell: &str| {
            let fractional = cell.contains(['.', ',']) && reads(&self.format, cell);
            fractional || looks_like_an_instant(cell) || no_instant(cell).is_some_and(|reason| !reason.is_empty())
        };
        let both = header.iter().zip(next).find(|(a, b)| is_value(a) && is_value(b));
        // Numbers alone have a sentence of their own.
        let all = header.iter().all(|cell| cell.parse::<f64>().is_ok());
        let Some((cell, _)) = both.filter(|_| !all) else { return Ok(()) };
        let reason = no_instant(cell).unwrap_or_default().into();
        let place = Place { file: file.into(), line: *line, column: None };
        Err(LogError::DataAsHeader { place, found: (*cell).into(), reason })
    }

    /// A first row of texts over numbers.
    fn units(&mut self, rows: &[(u64, Vec<&str>)]) {
        let skipped = usize::from(self.format.header_line.is_none_or(|line| rows.first().is_some_and(|r| r.0 == line)));
        let Some(((line, units), after)) = rows.get(skipped..).and_then(<[_]>::split_first) else { return };
        let is_value = |cell: &str| reads(&self.format, cell) || no_instant(cell).is_none();
        let holds_values = |i: usize| {
            let column = after.iter().take(AFTER_UNITS).filter_map(|(_, cells)| cells.get(i)).filter(|c| !c.is_empty());
            column.clone().next().is_some() && column.clone().all(|cell| is_value(cell))
        };
        let columns: Vec<usize> = (0..units.len()).filter(|&i| holds_values(i)).collect();
        let is_unit = |cell: &str| {
            let nothing = ["", "nan", "na", "n/a", "null", "none", "-", "--"].contains(&cell.to_lowercase().as_str());
            !nothing && !is_value(cell) && cell.chars().count() <= 20
        };
        let all = columns.iter().all(|&i| units[i].is_empty() || is_unit(units[i]));
        if !all || !columns.iter().any(|&i| is_unit(units[i])) {
            return;
        }
        self.format.skip_lines = vec![*line];
        self.units = units.iter().map(|unit| unit.trim_matches(['[', ']', '(', ')']).trim().to_owned()).collect();
        let shown: Vec<&str> = self.units.iter().map(String::as_str).filter(|u| !u.is_empty()).take(6).collect();
        self.said
            .push(format!("line {line} looks like a row of units ({}) and is left out (skip_lines)", shown.join(", ")));
    }
}

/// Lines with content, and comments before the first of them.
fn lines(text: &str) -> (Vec<Line<'_>>, Vec<Line<'_>>) {
    let numbered = (1..).zip(text.lines()).map(|(number, text)| Line { number, text: text.trim() });
    let (mut content, mut comments) = (Vec::new(), Vec::new());
    for line in numbered.filter(|line| !line.text.is_empty()).take(SEEN) {
        if line.text.starts_with('#') { comments.push(line) } else { content.push(line) }
    }
    (content, comments)
}

fn uncommented(text: &str) -> &str {
    text.trim_start_matches('#').trim()
}

/// What [`crate::data::Rows`] takes without being told.
fn usual_separator(header: &str) -> char {
    // Of equals the first.
    [',', ';', '\t'].into_iter().rev().max_by_key(|s| cells(header, *s).len()).unwrap_or(',')
}

/// The number of cells that nine in ten lines have.
fn usual_count(lines: &[Line<'_>], separator: char) -> Option<usize> {
    let mut counts: Vec<usize> = lines.iter().map(|line| cells(line.text, separator).len()).collect();
    counts.sort_unstable();
    let middle = *counts.get(counts.len() / 2)?;
    let same = counts.iter().filter(|count| **count == middle).count();
    (same * 10 >= counts.len() * 9).then_some(middle)
}

/// Cells of a line, without quotes and blanks around them.
fn cells(line: &str, separator: char) -> Vec<&str> {
    let (mut cells, mut quoted, mut start) = (Vec::new(), false, 0);
    for (at, c) in line.char_indices() {
        quoted ^= c == '"';
        let parts = c == separator || (separator == ' ' && c == '\t');
        if parts && !quoted {
            cells.push(&line[start..at]);
            start = at + c.len_utf8();
        }
    }
    cells.push(&line[start..]);
    if separator == ' ' {
        cells.retain(|cell| !cell.is_empty());
    }
    cells.iter().map(|cell| cell.trim().trim_matches('"').trim()).collect()
}

/// Whether a cell is a number in this format.
fn reads(format: &Format, cell: &str) -> bool {
    format.plain(cell).is_some_and(|plain| plain.parse::<f64>().is_ok_and(f64::is_finite))
}
