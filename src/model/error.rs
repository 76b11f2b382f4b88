//! What can be wrong with a problem file, and where.

use std::fmt;

use super::Span;
use crate::words::shorten;

/// A problem file that cannot be used: one sentence, with line, column and a caret where it has a place.
#[derive(Debug, Clone, PartialEq)]
pub struct ProblemError {
    /// The problem file's name.
    pub file: String,
    /// Where in the file; `None` when the whole file, or its log, is meant.
    pub place: Option<Place>,
    /// What is wrong.
    pub cause: Box<Cause>,
}

/// A range of one line of the problem file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// 1-based line.
    pub line: usize,
    /// 1-based column, in characters.
    pub column: usize,
    /// The line, or the part of a long line around the range.
    pub excerpt: String,
    /// Characters of `excerpt` before the range.
    pub indent: usize,
    /// Characters of `excerpt` in the range, at least one.
    pub width: usize,
}

/// What is wrong with a problem file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message says what it is about")]
pub enum Cause {
    #[error("cannot read the problem file: {message}")]
    Unreadable { message: String },
    #[error("the problem file has {bytes} bytes, and at most {limit} are read (is this really a problem file?)")]
    FileTooLarge { bytes: u64, limit: u64 },
    #[error("the problem file is not UTF-8 text (is this really a problem file?)")]
    NotText,
    #[error("not valid TOML: {message}")]
    Toml { message: String },
    #[error("unknown key `{key}` in {table}{}", suggestion(.nearest.as_deref(), .known))]
    UnknownKey { key: String, table: String, nearest: Option<String>, known: Vec<String> },
    #[error("{table} lacks `{key}`: give {expected}")]
    MissingKey { table: String, key: String, expected: String },
    #[error("`{key}`: expected {expected}, found {found}")]
    WrongType { key: String, expected: String, found: String },
    #[error("`{key}` is {value}: expected {expected}")]
    BadValue { key: String, value: String, expected: String },
    #[error("`{key}` has {found} {}: expected {expected}", if *.found == 1 { "entry" } else { "entries" })]
    WrongCount { key: String, found: usize, expected: String },
    #[error("`{key}` names {what} `{name}`, which does not exist{}", suggestion(.nearest.as_deref(), .known))]
    NoSuch { key: String, what: &'static str, name: String, nearest: Option<String>, known: Vec<String> },
    #[error("the name `{name}` is already {taken}: choose another")]
    NameTaken { name: String, taken: &'static str },
    #[error("`{name}` cannot be a name in formulas: use letters, digits and underscores, not starting with a digit")]
    BadName { name: String },
    #[error("{count} {what}: at most {limit} are allowed")]
    TooMany { count: usize, what: &'static str, limit: usize },

    #[error("a formula of {length} characters: at most {limit} are allowed")]
    FormulaTooLong { length: usize, limit: usize },
    #[error("a formula nested more than {limit} deep (parentheses, calls, signs and powers count)")]
    FormulaTooDeep { limit: usize },
    #[error("a formula that chains more than {limit} operations: split it with parentheses")]
    FormulaChain { limit: usize },
    #[error(
        "a formula compares a comparison: join two with `and`, as in `a < b and b < c`, or put one in parentheses, which \
         is 1 or 0"
    )]
    ComparisonChain,
    #[error("a formula stops short: expected {expected}")]
    UnexpectedEnd { expected: &'static str },
    #[error("a formula has {found} where {expected} was expected")]
    Syntax { found: String, expected: &'static str },
    #[error("`{text}` is not a finite number")]
    NotANumber { text: String },
    #[error("unknown name `{name}`{}", suggestion(.nearest.as_deref(), .known))]
    UnknownName { name: String, nearest: Option<String>, known: Vec<String> },
    #[error("unknown function `{name}`{}", suggestion(.nearest.as_deref(), .known))]
    UnknownFunction { name: String, nearest: Option<String>, known: Vec<String> },
    #[error("`{name}` takes {expected} {}, found {found}", if *.expected == 1 { "argument" } else { "arguments" })]
    ArgumentCount { name: String, expected: usize, found: usize },
    #[error("{what} `{name}` cannot stand in {key}, which may use {allowed}")]
    NotAllowed { what: &'static str, name: String, key: String, allowed: &'static str },
    #[error("{problem}")]
    Table { problem: String },
    #[error("{what} `{name}`, which `{through}` uses, cannot stand in {key}, which may use {allowed}")]
    NotAllowedThrough { what: &'static str, name: String, through: String, key: String, allowed: &'static str },
    #[error("`{name}` cannot be used in its own formula")]
    LetOfItself { name: String },
    #[error("`{name}` is defined further down in [model.let]: move it above what uses it")]
    LetLater { name: String },
    #[error(
        "with this `{name}` the names of [model.let] stand for more than {limit} operations where they are used: use fewer, \
         or shorter ones"
    )]
    LetTooLarge { name: String, limit: usize },
    #[error(
        "`{text}` is not linear in the states, and the {filter} filter needs {key} to be linear (sums of states times \
         parameters, inputs and dt): set `kind` in [filter] to one of {}", others.join(", ")
    )]
    Nonlinear { text: String, key: String, filter: &'static str, others: Vec<String> },

    #[error(
        "`{key}` has {what} at the start ({at}): start elsewhere, or write it so that it has one there (sinc(a) is sin(a)/a, \
         also at a = 0)"
    )]
    NotSmooth { key: String, what: &'static str, at: String },

    #[error(
        "`{key}` is not symmetric: entry [{row}, {column}] differs from [{column}, {row}] (write both alike, or one of them 0)"
    )]
    NotSymmetric { key: String, row: usize, column: usize },
    #[error("`{key}` gives no variance for {names}: name each of them, because this matrix must be positive definite")]
    NoVariance { key: String, names: String },
    #[error("`{key}` is not positive {}definite at the start values: {detail}", if *.semi { "semi" } else { "" })]
    NotPositive { key: String, semi: bool, detail: String },
    #[error("`{key}`: {problem}")]
    Invalid { key: String, problem: String },
    #[error("{problem}")]
    Log { problem: String },
    #[error("`data.validate`: {problem}")]
    Validate { problem: String },
}

/// A cause and the bytes it is about, before the file's name and lines are attached.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    pub(crate) span: Span,
    pub(crate) cause: Box<Cause>,
}

impl Fault {
    pub(crate) fn new(span: Span, cause: impl Into<Box<Cause>>) -> Self {
        Self { span, cause: cause.into() }
    }

    /// "`key`: problem".
    pub(crate) fn invalid(span: Span, key: &str, problem: impl Into<String>) -> Self {
        Self::new(span, Cause::Invalid { key: key.to_owned(), problem: problem.into() })
    }

    pub(crate) fn locate(self, file: &str, text: &str) -> ProblemError {
        ProblemError { file: file.to_owned(), place: Some(Place::of(text, self.span)), cause: self.cause }
    }
}

impl Place {
    /// Characters of a line shown on either side of the range's start.
    const CONTEXT: usize = 100;

    /// Line, column and excerpt of a byte range of `text`; a range over several lines ends with its first line.
    #[must_use]
    pub fn of(text: &str, span: Span) -> Self {
        let start = floor_boundary(text, span.start);
        let end = floor_boundary(text, span.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let before: Vec<char> = text[line_start..start].chars().collect();
        let width = text[start..end.min(line_end)].trim_end().chars().count().clamp(1, Self::CONTEXT);
        let cut = before.len().saturating_sub(Self::CONTEXT);
        let mut excerpt = String::from(if cut > 0 { "... " } else { "" });
        let indent = excerpt.chars().count() + before.len() - cut;
        excerpt.extend(&before[cut..]);
        let rest = text[start..line_end].trim_end();
        excerpt.extend(rest.chars().take(Self::CONTEXT));
        if rest.chars().nth(Self::CONTEXT).is_some() {
            excerpt.push_str(" ...");
        }
        // A tab is one character under one caret.
        let excerpt = excerpt.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let line = text[..line_start].matches('\n').count() + 1;
        Self { line, column: before.len() + 1, excerpt, indent, width }
    }
}

/// The largest character boundary of `text` that is not above `index`.
fn floor_boundary(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0)
}

impl fmt::Display for ProblemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = &self.place else { return write!(f, "{}: {}", self.file, self.cause) };
        writeln!(f, "{}:{}:{}: {}", self.file, place.line, place.column, self.cause)?;
        let number = place.line.to_string();
        let margin = " ".repeat(number.len());
        writeln!(f, "{margin} |")?;
        writeln!(f, "{number} | {}", place.excerpt)?;
        write!(f, "{margin} | {}{}", " ".repeat(place.indent), "^".repeat(place.width))
    }
}

impl std::error::Error for ProblemError {}

impl ProblemError {
    /// About the file as a whole.
    pub(crate) fn whole(file: &str, cause: Cause) -> Self {
        Self { file: file.to_owned(), place: None, cause: cause.into() }
    }
}

/// The known name most like `name`, if any is alike enough to be meant.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    // Jaro-Winkler: slips of a finger measure 0.82 and more (`q_b` for `q_a`, `measurment`), `std` for `seed` 0.75.
    const ALIKE: f64 = 0.8;
    let name: String = name.chars().take(100).collect();
    known
        .into_iter()
        .map(|k| (strsim::jaro_winkler(&name.to_lowercase(), &k.to_lowercase()), k))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| k.to_owned())
}

/// "; did you mean `a`?" or the list of what there is.
pub(super) fn suggestion(nearest: Option<&str>, known: &[String]) -> String {
    const SHOWN: usize = 12;
    let mut list = known.iter().take(SHOWN).map(|k| format!("`{}`", shorten(k))).collect::<Vec<_>>().join(", ");
    if known.len() > SHOWN {
        list += &format!(" and {} more", known.len() - SHOWN);
    }
    match (nearest, known.is_empty()) {
        (Some(nearest), _) => format!(": did you mean `{}`? (known: {list})", shorten(nearest)),
        (None, false) => format!(" (known: {list})"),
        (None, true) => " (there are none)".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(text: &str, start: usize, end: usize) -> Place {
        Place::of(text, Span { start, end })
    }

    #[test]
    fn columns_count_characters() {
        let text = "a = 1\nbé = \"ü + x\"\n";
        let x = text.find('x').unwrap();
        let p = place(text, x, x + 1);
        assert_eq!((p.line, p.column, p.indent, p.width), (2, 11, 10, 1));
        assert_eq!(p.excerpt, "bé = \"ü + x\"");
    }

    #[test]
    fn a_long_line_is_cut_around_the_range() {
        let text = format!("{}!{}", "a".repeat(5000), "b".repeat(5000));
        let p = place(&text, 5000, 5001);
        assert_eq!(p.column, 5001);
        assert_eq!(p.excerpt.chars().nth(p.indent), Some('!'));
        assert!(p.excerpt.len() < 300, "the excerpt is short");
    }

    #[test]
    fn any_range_of_any_text_has_a_place() {
        let text = "é\r\n\tü\n";
        for start in 0..10 {
            for end in 0..10 {
                let p = place(text, start, end);
                assert!(p.line <= 3 && p.width >= 1, "{p:?}");
            }
        }
    }
}
