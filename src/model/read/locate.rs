//! Where a key's value stands, for errors that are found after reading.

use toml::de::{DeArray, DeTable, DeValue};

use crate::model::Span;

/// The value at `path`, or of the longest part of it that exists; entries of lists are counted from 0.
pub(crate) fn locate(text: &str, path: &[&str]) -> Span {
    let mut span = Span::default();
    let Ok(document) = DeTable::parse(text) else { return span };
    let mut rest = path.iter();
    let mut found = rest.next().and_then(|key| document.get_ref().get(*key));
    while let Some(value) = found {
        span = Span { start: value.span().start, end: value.span().end };
        let Some(key) = rest.next() else { break };
        let entry = |list: &'_ DeArray<'_>| key.parse().ok().filter(|i: &usize| *i < list.len());
        found = match value.get_ref() {
            DeValue::Table(table) => table.get(*key),
            DeValue::Array(list) => entry(list).and_then(|i| list.get(i)),
            _ => None,
        };
    }
    span
}
