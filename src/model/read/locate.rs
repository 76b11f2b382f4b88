//! Where a key's value stands, for errors that are found after reading.

use toml::de::DeTable;

use crate::model::Span;

/// The value at `path`, or of the longest part of it that exists.
pub(crate) fn locate(text: &str, path: &[&str]) -> Span {
    let mut span = Span::default();
    let Ok(document) = DeTable::parse(text) else { return span };
    let mut table = Some(document.get_ref());
    for key in path {
        let Some(value) = table.and_then(|t| t.get(*key)) else { break };
        span = Span { start: value.span().start, end: value.span().end };
        table = value.get_ref().as_table();
    }
    span
}
