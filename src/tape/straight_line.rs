//! A tape, as machines read it: operations on registers and scalars.

use super::codes::{Binary, Unary};
use super::graph::Id;

/// A straight line of operations on registers (one value a candidate) and scalars (one value for all).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tape {
    /// The operations, in order.
    pub operations: Vec<Operation>,
    /// Number of registers they use, inputs included.
    pub registers: usize,
    /// The graph nodes whose values the caller provides as scalars, in order.
    pub scalars: Vec<Id>,
}

/// `register = code(arguments)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operation {
    /// What is computed.
    pub code: Code,
    /// Where the result goes.
    pub register: u16,
    /// As many as [`Code::arity`] says; the rest are [`Argument::NONE`].
    pub arguments: [Argument; 5],
}

/// Where an operand comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Argument {
    /// A register.
    Register(u16),
    /// A scalar.
    Scalar(u16),
}

impl Argument {
    /// Fills unused places.
    pub const NONE: Self = Self::Scalar(u16::MAX);
}

/// A straight line with more values than its operations can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the filter's formulas become {registers} candidate values and {scalars} numbers at a time, and at most {} of each fit: \
     shorten the formulas or take fewer states",
    Self::LIMIT
)]
pub struct TooLarge {
    /// Registers needed.
    pub registers: usize,
    /// Scalars needed.
    pub scalars: usize,
}

impl TooLarge {
    /// How many of each fit.
    pub const LIMIT: usize = u16::MAX as usize;
}

/// Operation codes. Fused operations round as often, and in the same order, as the plain ones they stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Code {
    /// a.
    Copy,
    /// op(a).
    Unary(Unary),
    /// a op b.
    Binary(Binary),
    /// b where a > 0, else c.
    Select,
    /// a * b + c.
    MultiplyAdd,
    /// a * b - c.
    MultiplySubtract,
    /// c - a * b.
    SubtractProduct,
    /// a * b + c * d.
    Dot,
    /// (a * b + e) + c * d.
    DotAdd,
    /// a * b where b > 0, else 0.
    MultiplyPositive,
}

impl Code {
    /// Number of arguments.
    #[must_use]
    pub const fn arity(self) -> usize {
        match self {
            Self::Copy | Self::Unary(_) => 1,
            Self::Binary(_) | Self::MultiplyPositive => 2,
            Self::Select | Self::MultiplyAdd | Self::MultiplySubtract | Self::SubtractProduct => 3,
            Self::Dot => 4,
            Self::DotAdd => 5,
        }
    }
}

/// A value the tape leaves in a register.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// The node.
    pub id: Id,
    /// The register it must end in.
    pub register: usize,
}
