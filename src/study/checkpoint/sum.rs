//! The hash that identities are taken by.

use sha2::{Digest as _, Sha256};

use crate::data::Table;

/// A hash that is written to; whatever has no fixed length is told with its length.
pub(super) struct Sum(Sha256);

impl Sum {
    pub(super) fn new() -> Self {
        Self(Sha256::new())
    }

    pub(super) fn digest(self) -> [u8; 32] {
        self.0.finalize().into()
    }

    pub(super) fn number(&mut self, number: u64) {
        self.0.update(number.to_le_bytes());
    }

    /// Missing values are all the same.
    pub(super) fn value(&mut self, value: f64) {
        self.number(if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() });
    }

    pub(super) fn text(&mut self, text: &str) {
        self.number(text.len() as u64);
        self.0.update(text);
    }

    pub(super) fn names(&mut self, names: &[String]) {
        self.number(names.len() as u64);
        names.iter().for_each(|name| self.text(name));
    }

    pub(super) fn table(&mut self, table: &Table, rows: usize) {
        self.number(table.columns() as u64);
        (0..rows).for_each(|k| table.row(k).iter().for_each(|value| self.value(*value)));
    }
}
