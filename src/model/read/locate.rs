//! Where a key's value stands, for errors that are found after reading.

use toml::de::{DeTable, DeValue};

use crate::model::Span;

/// The value at `path`, whose parts are keys of tables and indices of lists, or of the longest part of it that exists.
pub(crate) fn locate(text: &str, path: &[impl AsRef<str>]) -> Span {
    let mut span = Span::default();
    let Ok(document) = DeTable::parse(text) else { return span };
    let Some((first, rest)) = path.split_first() else { return span };
    let mut next = document.get_ref().get(first.as_ref());
    let mut rest = rest.iter();
    while let Some(value) = next {
        span = Span { start: value.span().start, end: value.span().end };
        let Some(key) = rest.next() else { break };
        next = match value.get_ref() {
            DeValue::Table(table) => table.get(key.as_ref()),
            DeValue::Array(array) => key.as_ref().parse().ok().and_then(|i: usize| array.get(i)),
            _ => None,
        };
    }
    span
}
