//! Tables from items: a column is a head and what it shows of an item.

use super::statistics::quantile;
use super::{Cell, Table};

type Show<'a, T> = Box<dyn Fn(&T) -> Cell + 'a>;

/// Columns over items of one type, one a row.
pub(super) struct Columns<'a, T>(Vec<(String, Show<'a, T>)>);

impl<'a, T> Columns<'a, T> {
    pub(super) const fn new() -> Self {
        Self(Vec::new())
    }

    pub(super) fn cell(mut self, head: impl Into<String>, show: impl Fn(&T) -> Cell + 'a) -> Self {
        self.0.push((head.into(), Box::new(show)));
        self
    }

    pub(super) fn words<W: Into<String>>(self, head: &str, of: impl Fn(&T) -> W + 'a) -> Self {
        self.cell(head, move |item| Cell::text(of(item)))
    }

    /// Whole numbers; nothing where there is none.
    pub(super) fn count<N: Into<Option<u64>>>(self, head: &str, of: impl Fn(&T) -> N + 'a) -> Self {
        self.cell(head, move |item| of(item).into().map_or(Cell::Empty, Cell::Count))
    }

    /// Numbers, of which people are shown so many digits; nothing where there is none.
    pub(super) fn number<N: Into<Option<f64>>>(
        self,
        head: impl Into<String>,
        digits: usize,
        of: impl Fn(&T) -> N + 'a,
    ) -> Self {
        self.cell(head, move |item| of(item).into().map_or(Cell::Empty, |value| Cell::Number(value, digits)))
    }

    /// Several numbers of an item, each under its head.
    pub(super) fn numbers<const N: usize>(
        mut self,
        heads: [&str; N],
        digits: usize,
        of: impl Fn(&T) -> [f64; N] + Copy + 'a,
    ) -> Self {
        for (i, head) in heads.into_iter().enumerate() {
            self = self.number(head, digits, move |item| of(item)[i]);
        }
        self
    }

    /// Quantiles of numbers that an item has, each under its head.
    pub(super) fn quantiles<const N: usize>(
        self,
        heads: [&str; N],
        shares: [f64; N],
        digits: usize,
        of: impl Fn(&T) -> Vec<f64> + Copy + 'a,
    ) -> Self {
        self.numbers(heads, digits, move |item| shares.map(|share| quantile(&of(item), share)))
    }

    /// The table of these items.
    pub(super) fn table(
        &self,
        name: &'static str,
        title: impl Into<String>,
        items: impl IntoIterator<Item = T>,
    ) -> Table {
        let heads: Vec<&str> = self.0.iter().map(|(head, _)| head.as_str()).collect();
        let mut table = Table::new(name, title, &heads);
        table.rows = items.into_iter().map(|item| self.0.iter().map(|(_, show)| show(&item)).collect()).collect();
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_an_item_and_nothing_where_there_is_none() {
        let columns = Columns::new()
            .words("name", |(name, _): &(&str, f64)| *name)
            .number("x", 3, |(_, x)| *x)
            .number("root", 3, |(_, x)| (*x >= 0.0).then(|| x.sqrt()))
            .numbers(["twice", "thrice"], 2, |(_, x)| [2.0 * x, 3.0 * x])
            .count("letters", |(name, _)| name.len() as u64);
        let table = columns.table("made-up", "Made up", [("four", 4.0), ("minus", -1.0)]);
        assert_eq!(table.columns, ["name", "x", "root", "twice", "thrice", "letters"]);
        let number = |value, digits| Cell::Number(value, digits);
        let first = [number(4.0, 3), number(2.0, 3), number(8.0, 2), number(12.0, 2), Cell::Count(4)];
        assert_eq!((&table.rows[0][0], &table.rows[0][1..]), (&Cell::text("four"), &first[..]));
        assert_eq!((&table.rows[1][2], table.rows.len()), (&Cell::Empty, 2));
    }
}
