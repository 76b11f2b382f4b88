//! The file of a `table` in a formula: a CSV with two columns, x and y.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::model::curve::NoCurve;
use crate::model::error::{Cause, Fault};
use crate::model::{Curve, Span};
use crate::words::shorten;

const MAX_ROWS: usize = 1000;
const MAX_BYTES: u64 = 1 << 20;

/// The curve of a file that is relative to a folder; `span` is its name in the problem file.
pub(super) fn read(folder: &Path, file: &str, span: Span) -> Result<Curve, Fault> {
    let path = folder.join(file);
    let text = text_of(&path).map_err(|problem| table(span, format!("{}: {problem}", path.display())))?;
    curve(file, &text)
        .map_err(|(line, column, problem)| table(span, format!("{}:{line}:{column}: {problem}", path.display())))
}

fn table(span: Span, problem: String) -> Fault {
    Fault::new(span, Cause::Table { problem })
}

fn text_of(path: &Path) -> Result<String, String> {
    let refused = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            "no such file (a path in a formula is relative to the folder of the problem file)".to_owned()
        }
        _ => format!("cannot be read: {error}"),
    };
    // A pipe or a device would be waited for.
    if !std::fs::metadata(path).map_err(refused)?.is_file() {
        return Err("is no file, expected a CSV file with two columns".to_owned());
    }
    let mut bytes = Vec::new();
    File::open(path).map_err(refused)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("has more than {MAX_BYTES} bytes, expected a CSV file with at most {MAX_ROWS} rows"));
    }
    String::from_utf8(bytes).map_err(|_| "is not UTF-8 text, expected a CSV file with two columns".to_owned())
}

/// Line, column (both from 1) and what is wrong there.
type Wrong = (usize, usize, String);

/// A cell without its quotes and spaces, and the column of the line at which it starts.
struct Cell<'a> {
    text: &'a str,
    column: usize,
}

/// The curve of a text: a header, then rows of x and y. `#` begins a comment line.
fn curve(file: &str, text: &str) -> Result<Curve, Wrong> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((first, header)) = lines.next() else {
        return Err((1, 1, "is empty, expected a header and rows of two numbers".to_owned()));
    };
    let separator = [',', ';', '\t'].into_iter().find(|c| header.contains(*c)).unwrap_or(',');
    if pair(first, header, separator)?.iter().all(|cell| cell.text.parse::<f64>().is_ok()) {
        return Err((first, 1, "expected a header, found numbers: add a first line that names the columns".to_owned()));
    }
    let (mut x, mut y, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for (line, row) in lines {
        if x.len() == MAX_ROWS {
            return Err((line, 1, format!("more than {MAX_ROWS} rows: leave some out")));
        }
        let cells = pair(line, row, separator)?;
        let [a, b] = [number(line, &cells[0])?, number(line, &cells[1])?];
        x.push(a);
        y.push(b);
        places.push((line, cells[0].column));
    }
    let last = places.last().copied().unwrap_or((first, 1));
    let values = x.clone();
    Curve::new(file, x, y).map_err(|wrong| match wrong {
        NoCurve::TooFew => (last.0, 1, format!("{} rows, expected at least 2", places.len())),
        NoCurve::NotIncreasing(i) => {
            let (line, column) = places[i];
            (line, column, format!("{} follows {}, expected x to increase from row to row", values[i], values[i - 1]))
        }
        NoCurve::NotFinite => {
            (last.0, 1, "its slopes are not finite: points too close, or numbers too large".to_owned())
        }
    })
}

fn pair(line: usize, row: &str, separator: char) -> Result<[Cell<'_>; 2], Wrong> {
    let mut start = 0;
    let cells: Vec<Cell<'_>> = row
        .split(separator)
        .map(|cell| {
            let text = cell.trim();
            let column = row[..start + cell.len() - cell.trim_start().len()].chars().count() + 1;
            start += cell.len() + separator.len_utf8();
            Cell { text: text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(text), column }
        })
        .collect();
    let found = cells.len();
    cells.try_into().map_err(|_| (line, 1, format!("{found} cells, expected two: x and y")))
}

fn number(line: usize, cell: &Cell<'_>) -> Result<f64, Wrong> {
    let value = cell.text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| (line, cell.column, format!("expected a number, found \"{}\"", shorten(cell.text))))
}
