//! The operations by name; what each is stands in [`super::operations`].

/// Operations of one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are the operations")]
pub enum Unary {
    Negate,
    Sqrt,
    Exp,
    Ln,
    /// exp(a) - 1, without its cancellation.
    Expm1,
    /// ln(1 + a), without its cancellation.
    Log1p,
    Sin,
    Cos,
    /// The same angle in [-pi, pi).
    Wrap,
    Floor,
    /// The nearest whole number, of two the even one.
    Round,
    Abs,
    /// a where a > 0, else (and for NaN) 0.
    Positive,
}

/// Operations of two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are the operations")]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Min,
    Max,
    Atan2,
    Power,
}
