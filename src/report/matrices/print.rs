//! Matrices as text.

use std::fmt;

use super::{DIGITS, Entry, Gain, Matrices, Matrix};
use crate::number::short;

/// Rows or columns above which a matrix that is mostly zeros is printed by its other entries.
const LARGE: usize = 6;
/// Characters of a line of such entries.
const LINE: usize = 100;

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(value) => f.pad(&short(*value, DIGITS)),
            Self::Formula { short, .. } => f.pad(short),
        }
    }
}

/// `[[1, 0.5],\n [0, 1]]`, entries aligned, continued lines indented by the width given as `{:width$}`.
impl fmt::Display for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(ToString::to_string).collect()).collect();
        let width = cells.iter().flatten().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let indent = " ".repeat(f.width().unwrap_or(0));
        f.write_str("[")?;
        for (i, row) in cells.iter().enumerate() {
            if i > 0 {
                write!(f, ",\n{indent} ")?;
            }
            let row: Vec<String> = row.iter().map(|cell| format!("{cell:>width$}")).collect();
            write!(f, "[{}]", row.join(", "))?;
        }
        f.write_str("]")
    }
}

impl Matrix {
    /// Whether its zeros would hide the rest.
    fn is_sparse(&self) -> bool {
        let columns = self.rows.first().map_or(0, Vec::len);
        let others = self.rows.iter().flatten().filter(|entry| !entry.is_zero()).count();
        self.rows.len().max(columns) > LARGE && 2 * others <= self.rows.len() * columns
    }

    /// The entries that are not 0, by the names of their rows and columns.
    fn others(&self, rows: &[String], columns: &[String]) -> Vec<String> {
        let name = |names: &[String], i: usize| names.get(i).cloned().unwrap_or_else(|| (i + 1).to_string());
        let entries = self.rows.iter().enumerate().flat_map(|(i, row)| {
            row.iter().enumerate().filter(|(_, entry)| !entry.is_zero()).map(move |(j, entry)| (i, j, entry))
        });
        entries
            .map(|(i, j, entry)| match columns {
                // Of a column the row says it all.
                [] => format!("[{}] {entry}", name(rows, i)),
                columns => format!("[{}, {}] {entry}", name(rows, i), name(columns, j)),
            })
            .collect()
    }
}

/// One matrix a line, with its name; of large ones that are mostly zeros the other entries.
impl fmt::Display for Matrices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, matrix) in self.all().chain(self.K.iter().map(|k| ("K", k))) {
            self.write(f, name, matrix)?;
        }
        match self.gain {
            Gain::Steady => {}
            Gain::Varies => writeln!(f, "K changes from row to row, as {}.", self.why_it_varies())?,
            Gain::Unsettled => writeln!(
                f,
                "K settles to no value: some state has no noise, or is unstable and not seen by the measurements."
            )?,
        }
        if let Some(note) = self.note {
            writeln!(f, "Note: {note}.")?;
        }
        Ok(())
    }
}

impl Matrices {
    fn write(&self, f: &mut fmt::Formatter<'_>, name: &str, matrix: &Matrix) -> fmt::Result {
        if !matrix.is_sparse() {
            return writeln!(f, "{name} = {matrix:indent$}", indent = name.len() + 3);
        }
        let Self { states, measurements, .. } = self;
        let (rows, columns): (&[String], &[String]) = match name {
            "F" | "Q" => (states, states),
            "H" => (measurements, states),
            "R" => (measurements, measurements),
            "K" => (states, measurements),
            "f0" | "f" => (states, &[]),
            _ => (measurements, &[]),
        };
        let of = format!("{} x {}", matrix.rows.len(), matrix.rows.first().map_or(0, Vec::len));
        let others = matrix.others(rows, columns);
        if others.is_empty() {
            return writeln!(f, "{name} ({of}) is 0.");
        }
        write!(f, "{name} ({of}) is 0 but for")?;
        let mut used = LINE;
        for (i, entry) in others.iter().enumerate() {
            let comma = if i + 1 < others.len() { "," } else { "" };
            let width = entry.chars().count() + comma.len() + 1;
            if used + width > LINE {
                write!(f, "\n   ")?;
                used = 3;
            }
            write!(f, " {entry}{comma}")?;
            used += width;
        }
        writeln!(f)
    }

    /// "F and Q do".
    fn why_it_varies(&self) -> String {
        let names: Vec<&str> = self.varies.iter().filter(|name| !matches!(**name, "f0" | "h0")).copied().collect();
        match names.split_last() {
            // The note that follows says what the filter adapts or weighs.
            None if self.of_modes => "the weights of the modes do".to_owned(),
            None => "the adapted covariance does".to_owned(),
            Some((only, [])) => format!("{only} does"),
            Some((last, others)) => format!("{} and {last} do", others.join(", ")),
        }
    }
}
