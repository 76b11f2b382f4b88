//! Text tables with aligned columns.

use std::fmt;

/// Rows of text; the first is the header. Columns of numbers are aligned right, others left.
#[derive(Debug, Clone, Default)]
pub struct TextTable {
    rows: Vec<Vec<String>>,
}

impl TextTable {
    /// A table with this header.
    #[must_use]
    pub fn new<const N: usize>(header: [&str; N]) -> Self {
        Self { rows: vec![header.map(str::to_owned).to_vec()] }
    }

    /// A table of these rows, the header first.
    #[must_use]
    pub const fn of_rows(rows: Vec<Vec<String>>) -> Self {
        Self { rows }
    }

    /// Appends a row; missing cells stay empty.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        self.rows.push(row.to_vec());
    }

    fn column(&self, c: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().map(move |row| row.get(c).map_or("", String::as_str))
    }

    fn is_numeric(&self, c: usize) -> bool {
        let mut cells = self.column(c).skip(1).filter(|cell| !cell.is_empty()).peekable();
        cells.peek().is_some()
            && cells.all(|cell| cell.starts_with(|first: char| first.is_ascii_digit() || first == '-'))
    }
}

impl fmt::Display for TextTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A column without a single cell under its header says nothing.
        let shown: Vec<(usize, usize, bool)> = (0..self.rows.first().map_or(0, Vec::len))
            .filter(|&c| self.column(c).skip(1).any(|cell| !cell.is_empty()))
            .map(|c| (c, self.column(c).map(|cell| cell.chars().count()).max().unwrap_or(0), self.is_numeric(c)))
            .collect();
        for row in &self.rows {
            let mut line = String::from(" ");
            for &(c, width, numeric) in &shown {
                let cell = row.get(c).map_or("", String::as_str);
                line.push_str(&if numeric { format!(" {cell:>width$} ") } else { format!(" {cell:<width$} ") });
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_right_aligned_and_empty_columns_left_out() {
        let mut table = TextTable::new(["parameter", "unit", "tuned"]);
        table.push(["q".into(), String::new(), "1468.5".into()]);
        table.push(["sigma".into(), String::new(), "-2".into()]);
        assert_eq!(table.to_string(), "  parameter   tuned\n  q          1468.5\n  sigma          -2\n");
    }
}
