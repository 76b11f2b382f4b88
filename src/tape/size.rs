//! How large what an operation works with is: what its rounding errors are a share of.

use super::{Binary, Code, Operation, Unary};

impl Operation {
    /// The largest of the terms that the operation adds up, of one that adds nothing the result: `value`, from `operands`
    /// (unused ones are 0). Where it is far above the result the terms cancel.
    #[must_use]
    pub fn size(&self, [a, b, c, d, e]: [f64; 5], value: f64) -> f64 {
        match self.code {
            Code::Binary(Binary::Add | Binary::Subtract) => a.abs().max(b.abs()),
            Code::MultiplyAdd | Code::MultiplySubtract | Code::SubtractProduct => (a * b).abs().max(c.abs()),
            Code::Dot => (a * b).abs().max((c * d).abs()),
            Code::DotAdd => (a * b).abs().max((c * d).abs()).max(e.abs()),
            Code::Copy | Code::Unary(_) | Code::Binary(_) | Code::Select | Code::MultiplyPositive => value.abs(),
        }
    }

    /// Whether every machine computes it to a few roundings: signs, fused or not, comparisons, roots; no other function.
    #[must_use]
    pub const fn is_arithmetic(&self) -> bool {
        match self.code {
            Code::Unary(op) => matches!(op, Unary::Negate | Unary::Abs | Unary::Positive | Unary::Sqrt),
            Code::Binary(op) => !matches!(op, Binary::Atan2 | Binary::Power),
            _ => true,
        }
    }
}
