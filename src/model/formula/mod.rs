//! The formula language: `+ - * / ^`, comparisons, `and`, `or`, `not`, parentheses, `if`, the functions of [`Function::ALL`],
//! `pi`, and names.
//!
//! ```text
//! formula = both { "or" both }
//! both    = inverse { "and" inverse }
//! inverse = "not" inverse | compare
//! compare = sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ("-" | "+") signed | power          so -a^2 = -(a^2)
//! power   = atom [ "^" signed ]                 so a^b^c = a^(b^c) and a^-1 = a^(-1)
//! atom    = number | name | function "(" formula { "," formula } ")" | "(" formula ")"
//!         | "table" "(" text "," formula ")"        a text in single or double quotes: a file
//! ```
//!
//! Formulas are data: no side effects, bounded length, bounded depth.

mod lexer;
mod parser;
mod scope;
mod table;

#[cfg(test)]
mod tests;

pub(crate) use parser::parse;
pub(crate) use scope::{Let, Names, Place as FormulaPlace, Scope, is_name, reserved};

#[cfg(doc)]
use super::Function;

/// Characters of one formula.
pub(super) const MAX_LENGTH: usize = 10_000;
/// Depth of parentheses, calls, signs and powers.
pub(super) const MAX_NESTING: usize = 100;
/// Depth of the tree of one formula, which a chain such as `a + b + c + ...` reaches too. Every later stage may recurse.
pub(super) const MAX_DEPTH: usize = 500;
