//! TOML values with their positions, read with one-sentence errors.

use std::collections::HashSet;

use toml::de::{DeTable, DeValue};
use toml::{Spanned, value::Datetime};

use crate::model::error::{Cause, Fault, nearest};
use crate::model::formula::{self, Scope};
use crate::model::{Expr, Span};
use crate::words::shorten;

/// A value, its place, and the key that messages call it by.
#[derive(Debug, Clone)]
pub(super) struct Node<'a> {
    pub(super) value: &'a DeValue<'a>,
    pub(super) span: Span,
    pub(super) key: String,
    text: &'a str,
}

/// A table whose keys have been checked against the known ones.
#[derive(Debug, Clone)]
pub(super) struct Fields<'a> {
    pub(super) entries: Vec<(&'a str, Span, Node<'a>)>,
    pub(super) span: Span,
    pub(super) name: String,
}

impl<'a> Fields<'a> {
    /// The whole document.
    pub(super) fn document(table: &'a DeTable<'a>, text: &'a str, known: &[&str]) -> Result<Self, Fault> {
        Self::new(table, "", Span::default(), text, known)
    }

    /// `table` as named `prefix`, in file order; every key must be one of `known`, unless that is empty.
    fn new(table: &'a DeTable<'a>, prefix: &str, span: Span, text: &'a str, known: &[&str]) -> Result<Self, Fault> {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            let path = if prefix.is_empty() { shorten(name) } else { format!("{prefix}.{}", shorten(name)) };
            let node = Node { value: value.get_ref(), span: span_of(value), key: path, text };
            entries.push((name, span_of(key), node));
        }
        entries.sort_by_key(|(_, span, _)| span.start);
        let name = if prefix.is_empty() { "the problem file".to_owned() } else { format!("[{prefix}]") };
        let fields = Self { entries, span, name };
        fields.check(known)?;
        Ok(fields)
    }

    /// Every key must be one of `known`, unless that is empty.
    pub(super) fn check(&self, known: &[&str]) -> Result<(), Fault> {
        let unknown = self.entries.iter().find(|(key, ..)| !known.is_empty() && !known.contains(key));
        let Some((key, span, _)) = unknown else { return Ok(()) };
        let (nearest, known) = (nearest(key, known.iter().copied()), known.iter().map(|k| (*k).to_owned()).collect());
        let cause = Cause::UnknownKey { key: shorten(key), table: self.name.clone(), nearest, known };
        Err(Fault::new(*span, cause))
    }

    pub(super) fn get(&self, key: &str) -> Option<&Node<'a>> {
        self.entries.iter().find(|(name, ..)| *name == key).map(|(.., node)| node)
    }

    /// The value under `key`, or an error that says what to give.
    pub(super) fn need(&self, key: &str, expected: &str) -> Result<&Node<'a>, Fault> {
        self.get(key).ok_or_else(|| {
            let cause =
                Cause::MissingKey { table: self.name.clone(), key: key.to_owned(), expected: expected.to_owned() };
            Fault::new(self.span, cause)
        })
    }

    /// `read` of the value under `key`, if it is there.
    pub(super) fn optional<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Node<'a>) -> Result<T, Fault>,
    ) -> Result<Option<T>, Fault> {
        self.get(key).map(read).transpose()
    }
}

impl<'a> Node<'a> {
    pub(super) fn fault(&self, cause: Cause) -> Fault {
        Fault::new(self.span, cause)
    }

    /// The file's own text at `span`.
    pub(super) fn source(&self, span: Span) -> &'a str {
        self.text.get(span.start..span.end).unwrap_or("")
    }

    pub(super) fn invalid(&self, problem: impl Into<String>) -> Fault {
        Fault::invalid(self.span, &self.key, problem)
    }

    pub(super) fn wrong_type(&self, expected: &str) -> Fault {
        let found = describe(self.value);
        self.fault(Cause::WrongType { key: self.key.clone(), expected: expected.to_owned(), found })
    }

    pub(super) fn bad_value(&self, value: impl ToString, expected: impl Into<String>) -> Fault {
        let (key, value, expected) = (self.key.clone(), value.to_string(), expected.into());
        self.fault(Cause::BadValue { key, value, expected })
    }

    pub(super) fn wrong_count(&self, found: usize, expected: impl Into<String>) -> Fault {
        self.fault(Cause::WrongCount { key: self.key.clone(), found, expected: expected.into() })
    }

    pub(super) fn string(&self) -> Result<&'a str, Fault> {
        self.value.as_str().ok_or_else(|| self.wrong_type("a string"))
    }

    /// A string that is not empty.
    pub(super) fn name(&self) -> Result<String, Fault> {
        match self.string()? {
            "" => Err(self.bad_value("empty", "a name")),
            name => Ok(name.to_owned()),
        }
    }

    pub(super) fn boolean(&self) -> Result<bool, Fault> {
        self.value.as_bool().ok_or_else(|| self.wrong_type("true or false"))
    }

    /// A finite number.
    pub(super) fn number(&self) -> Result<f64, Fault> {
        let value = match self.value {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(_) => self.integer_value().map(as_f64),
            _ => return Err(self.wrong_type("a number")),
        };
        value
            .filter(|v: &f64| v.is_finite())
            .ok_or_else(|| self.bad_value(shorten(self.source(self.span)), "a finite number"))
    }

    /// A number above 0.
    pub(super) fn positive(&self) -> Result<f64, Fault> {
        let value = self.number()?;
        if value > 0.0 { Ok(value) } else { Err(self.bad_value(value, "a number above 0")) }
    }

    /// A whole number from `low` to `high`.
    pub(super) fn integer(&self, low: u64, high: u64) -> Result<u64, Fault> {
        let DeValue::Integer(integer) = self.value else { return Err(self.wrong_type("a whole number")) };
        let value = self.integer_value().and_then(|v| u64::try_from(v).ok());
        value.filter(|v| (low..=high).contains(v)).ok_or_else(|| {
            let expected = match high {
                u64::MAX => format!("a whole number from {low}"),
                _ => format!("a whole number from {low} to {high}"),
            };
            self.bad_value(shorten(integer.as_str()), expected)
        })
    }

    /// A whole number from `low` to `high`, as a count.
    pub(super) fn count(&self, low: u32, high: u32) -> Result<usize, Fault> {
        let value = self.integer(low.into(), high.into())?;
        usize::try_from(value).map_err(|_| self.bad_value(value, "a smaller number"))
    }

    fn integer_value(&self) -> Option<i128> {
        let integer = self.value.as_integer()?;
        i128::from_str_radix(integer.as_str(), integer.radix()).ok()
    }

    /// The entries of a list; messages call them `key[1]`, `key[2]`, ...
    pub(super) fn list(&self, expected: &str) -> Result<Vec<Self>, Fault> {
        let array = self.value.as_array().ok_or_else(|| self.wrong_type(expected))?;
        Ok((1..)
            .zip(array.iter())
            .map(|(i, entry)| Self {
                value: entry.get_ref(),
                span: span_of(entry),
                key: format!("{}[{i}]", self.key),
                text: self.text,
            })
            .collect())
    }

    /// A list of different names, at least one.
    pub(super) fn names(&self, expected: &str) -> Result<Vec<String>, Fault> {
        let nodes = self.list(expected)?;
        let mut names = Vec::with_capacity(nodes.len());
        let mut seen = HashSet::with_capacity(nodes.len());
        for node in &nodes {
            let name = node.name()?;
            if !seen.insert(name.clone()) {
                return Err(node.invalid(format!("`{}` is listed twice", shorten(&name))));
            }
            names.push(name);
        }
        if names.is_empty() { Err(self.wrong_count(0, expected)) } else { Ok(names) }
    }

    /// A table with these keys; any keys if `known` is empty.
    pub(super) fn table(&self, expected: &str, known: &[&str]) -> Result<Fields<'a>, Fault> {
        let table = self.value.as_table().ok_or_else(|| self.wrong_type(expected))?;
        Fields::new(table, &self.key, self.span, self.text, known)
    }

    /// A number or a formula in a string; spans are byte ranges of the file.
    pub(super) fn formula(&self, scope: Scope<'_>) -> Result<Expr, Fault> {
        let scope = Scope { key: &self.key, ..scope };
        match self.value {
            DeValue::String(content) => {
                let offset = self.offset(content);
                let map = |span: Span| match offset {
                    Some(offset) => Span { start: offset + span.start, end: offset + span.end },
                    None => self.span,
                };
                let parsed = formula::parse(content, scope);
                let mut expr = parsed.map_err(|fault| Fault::new(map(fault.span), fault.cause))?;
                expr.map_spans(&map);
                Ok(expr)
            }
            DeValue::Integer(_) | DeValue::Float(_) => {
                let mut expr = Expr::number(self.number()?);
                expr.span = self.span;
                Ok(expr)
            }
            _ => Err(self.wrong_type("a number or a formula in quotes")),
        }
    }

    /// One formula per label; `what` says of what.
    pub(super) fn formulas(&self, labels: &[String], what: &str, scope: Scope<'_>) -> Result<Vec<Expr>, Fault> {
        let entries = self.list("a list of formulas")?;
        if entries.len() != labels.len() {
            let expected = format!("{}, one per {what} ({})", labels.len(), labels.join(", "));
            return Err(self.wrong_count(entries.len(), expected));
        }
        entries.iter().map(|entry| entry.formula(scope)).collect()
    }

    /// Where a part of the content of this string stands in the file; the whole string where escapes are in the way.
    pub(super) fn within(&self, content: &str, start: usize, length: usize) -> Span {
        self.offset(content).map_or(self.span, |offset| Span { start: offset + start, end: offset + start + length })
    }

    /// The byte of the file at which a string's content starts; `None` where escapes make the two differ.
    fn offset(&self, content: &str) -> Option<usize> {
        let raw = self.source(self.span);
        let quotes = if raw.starts_with("\"\"\"") || raw.starts_with("'''") { 3 } else { 1 };
        let inner = raw.get(quotes..raw.len().checked_sub(quotes)?)?;
        // A line break right after the opening quotes of a multi-line string is no content.
        let skipped = inner.len().checked_sub(content.len())?;
        (inner.get(skipped..)? == content && (skipped == 0 || quotes == 3))
            .then_some(self.span.start + quotes + skipped)
    }
}

fn span_of<T>(value: &Spanned<T>) -> Span {
    let range = value.span();
    Span { start: range.start, end: range.end }
}

#[expect(clippy::cast_precision_loss, reason = "a whole number in a problem file is meant as the nearest f64")]
const fn as_f64(value: i128) -> f64 {
    value as f64
}

fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(s) => format!("the string \"{}\"", shorten(s)),
        DeValue::Integer(i) => format!("the number {}", shorten(i.as_str())),
        DeValue::Float(x) => format!("the number {}", shorten(x.as_str())),
        DeValue::Boolean(b) => format!("{b}"),
        DeValue::Datetime(Datetime { .. }) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}
