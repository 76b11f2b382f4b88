//! Tapes as text, and what they cost.

use super::codes::{Binary, Unary};
use super::straight_line::{Argument, Code, Operation, Tape};
use std::fmt::{self, Display, Formatter};

/// Operation counts of a tape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// + - * /, one each, fused ones as many as they stand for; the figure that peers are compared by.
    pub flops: usize,
    /// Divisions among them.
    pub divisions: usize,
    /// Comparisons (min, max, select), signs, square roots and other functions.
    pub others: usize,
    /// Plain copies.
    pub copies: usize,
    /// Operations as the machines see them: a fused pair is one.
    pub operations: usize,
}

impl Tape {
    /// What one run of the tape costs.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let mut counts = Counts { operations: self.operations.len(), ..Counts::default() };
        for operation in &self.operations {
            match operation.code {
                Code::Copy => counts.copies += 1,
                Code::Binary(Binary::Add | Binary::Subtract | Binary::Multiply) => counts.flops += 1,
                Code::Binary(Binary::Divide) => {
                    counts.flops += 1;
                    counts.divisions += 1;
                }
                Code::MultiplyAdd | Code::MultiplySubtract | Code::SubtractProduct => counts.flops += 2,
                Code::Dot => counts.flops += 3,
                Code::DotAdd => counts.flops += 4,
                Code::MultiplyPositive => {
                    counts.flops += 1;
                    counts.others += 1;
                }
                Code::Unary(_) | Code::Binary(_) | Code::Select => counts.others += 1,
            }
        }
        counts
    }
}

impl Display for Counts {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { flops, divisions, others, copies, operations } = self;
        write!(
            f,
            "{flops} flops ({divisions} divisions), {others} comparisons and functions, {copies} copies; {operations} operations with pairs fused"
        )
    }
}

/// How registers and scalars are called in a listing.
#[derive(Debug, Clone, Copy)]
pub struct Names<'a> {
    /// Names of the first registers; the rest are `r12`.
    pub registers: &'a [String],
    /// Names of the scalars.
    pub scalars: &'a [String],
}

impl Names<'_> {
    fn of(&self, argument: Argument) -> String {
        let (names, index, letter) = match argument {
            Argument::Register(r) => (self.registers, r as usize, 'r'),
            Argument::Scalar(s) => (self.scalars, s as usize, 's'),
        };
        names.get(index).cloned().unwrap_or_else(|| format!("{letter}{index}"))
    }

    /// One operation as text.
    #[must_use]
    pub fn line(&self, operation: &Operation) -> String {
        let to = self.of(Argument::Register(operation.register));
        let [a, b, c, d, e] = operation.arguments.map(|argument| self.of(argument));
        let value = match operation.code {
            Code::Copy => a,
            Code::Unary(Unary::Negate) => format!("-{a}"),
            Code::Unary(op) => format!("{}({a})", op.row().name),
            Code::Binary(op) if op.row().is_sign() => format!("{a} {} {b}", op.row().name),
            Code::Binary(op) => format!("{}({a}, {b})", op.row().name),
            Code::Select => format!("{a} > 0 ? {b} : {c}"),
            Code::MultiplyAdd => format!("{a} * {b} + {c}"),
            Code::MultiplySubtract => format!("{a} * {b} - {c}"),
            Code::SubtractProduct => format!("{c} - {a} * {b}"),
            Code::Dot => format!("{a} * {b} + {c} * {d}"),
            Code::DotAdd => format!("{a} * {b} + {e} + {c} * {d}"),
            Code::MultiplyPositive => format!("{a} * positive({b})"),
        };
        format!("{to} = {value}")
    }
}
