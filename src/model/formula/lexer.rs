//! Formula text to tokens.

use crate::model::error::{Cause, Fault};
use crate::model::{Binary, Logical, Span};
use crate::words::shorten;

/// A token.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// What stands in quotes.
    Text(&'a str),
    Operator(Binary),
    Comparison(Logical),
    Open,
    Close,
    Comma,
    End,
}

/// Splits one formula into tokens, one ahead.
pub(super) struct Lexer<'a> {
    text: &'a str,
    position: usize,
}

impl<'a> Lexer<'a> {
    pub(super) const fn new(text: &'a str) -> Self {
        Self { text, position: 0 }
    }

    /// The next token and its bytes in the formula.
    pub(super) fn next(&mut self) -> Result<(Token<'a>, Span), Fault> {
        let rest = self.text[self.position..].trim_start();
        let start = self.text.len() - rest.len();
        let Some(first) = rest.chars().next() else {
            self.position = self.text.len();
            return Ok((Token::End, Span { start, end: start }));
        };
        let (token, length) = match first {
            '0'..='9' | '.' => number(rest, start)?,
            c if c.is_ascii_alphabetic() || c == '_' => {
                let length = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
                (Token::Name(&rest[..length]), length)
            }
            '"' | '\'' => quoted(rest, start)?,
            '<' | '>' | '=' | '!' => comparison(rest, start)?,
            c => (symbol(c, start)?, 1),
        };
        self.position = start + length;
        Ok((token, Span { start, end: self.position }))
    }
}

fn symbol(c: char, start: usize) -> Result<Token<'static>, Fault> {
    Ok(match c {
        '+' => Token::Operator(Binary::Add),
        '-' => Token::Operator(Binary::Subtract),
        '*' => Token::Operator(Binary::Multiply),
        '/' => Token::Operator(Binary::Divide),
        '^' => Token::Operator(Binary::Power),
        '(' => Token::Open,
        ')' => Token::Close,
        ',' => Token::Comma,
        c => {
            let span = Span { start, end: start + c.len_utf8() };
            let found = format!("`{}`", c.escape_debug());
            return Err(Fault::new(span, Cause::Syntax { found, expected: "a number, a name or an operator" }));
        }
    })
}

/// A text in single or double quotes, which has no escapes.
fn quoted(rest: &str, start: usize) -> Result<(Token<'_>, usize), Fault> {
    match rest[1..].split_once(&rest[..1]) {
        Some((inner, _)) => Ok((Token::Text(inner), inner.len() + 2)),
        None => {
            let span = Span { start, end: start + rest.len() };
            Err(Fault::new(span, Cause::UnexpectedEnd { expected: "the closing quote of a file's name" }))
        }
    }
}

/// `<`, `<=`, `>`, `>=`, `==` or `!=`.
fn comparison(rest: &str, start: usize) -> Result<(Token<'static>, usize), Fault> {
    const ALL: [Logical; 6] = [
        Logical::LessOrEqual,
        Logical::GreaterOrEqual,
        Logical::Equal,
        Logical::NotEqual,
        Logical::Less,
        Logical::Greater,
    ];
    if let Some(op) = ALL.into_iter().find(|op| rest.starts_with(op.symbol())) {
        return Ok((Token::Comparison(op), op.symbol().len()));
    }
    let expected = if rest.starts_with('=') { "`==` (a comparison)" } else { "`!=` or `not`" };
    let span = Span { start, end: start + 1 };
    Err(Fault::new(span, Cause::Syntax { found: format!("`{}`", &rest[..1]), expected }))
}

/// `12`, `1.5`, `.5`, `1e-3`. An `e` that no digits follow is left to be a name.
fn number(rest: &str, start: usize) -> Result<(Token<'static>, usize), Fault> {
    let bytes = rest.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') {
        length += 1;
        length += digits(length);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    let text = &rest[..length];
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((Token::Number(value), length)),
        _ => {
            let span = Span { start, end: start + length };
            Err(Fault::new(span, Cause::NotANumber { text: shorten(text) }))
        }
    }
}

impl Token<'_> {
    /// How messages name it.
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Number(value) => format!("the number {value}"),
            Self::Name(name) => format!("`{}`", shorten(name)),
            Self::Text(text) => format!("`\"{}\"`", shorten(text)),
            Self::Operator(op) => format!("`{}`", op.symbol()),
            Self::Comparison(op) => format!("`{}`", op.symbol()),
            Self::Open => "`(`".to_owned(),
            Self::Close => "`)`".to_owned(),
            Self::Comma => "`,`".to_owned(),
            Self::End => "the end".to_owned(),
        }
    }
}
