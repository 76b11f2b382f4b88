//! Whether a formula is affine in the states, by its form alone.

use super::{Binary, Expr, ExprKind, Symbol};

impl Expr {
    /// Whether it is affine in the states, by its form: `x * x - x * x` is not.
    #[must_use]
    pub fn is_affine(&self) -> bool {
        check(self).is_ok()
    }
}

/// `Ok` if affine; otherwise the smallest sub-formula that is not.
pub(super) fn check(formula: &Expr) -> Result<(), &Expr> {
    uses_states(formula).map(|_| ())
}

/// Whether the states appear (affinely).
fn uses_states(expr: &Expr) -> Result<bool, &Expr> {
    match &expr.kind {
        ExprKind::Number(_) => Ok(false),
        ExprKind::Symbol(symbol) => Ok(matches!(symbol, Symbol::State(_))),
        ExprKind::Negate(a) => uses_states(a),
        ExprKind::Binary(op, a, b) => {
            let (left, right) = (uses_states(a)?, uses_states(b)?);
            let affine = match op {
                Binary::Add | Binary::Subtract => true,
                Binary::Multiply => !(left && right),
                Binary::Divide => !right,
                Binary::Power => !right && (!left || is_one(b)),
            };
            if affine { Ok(left || right) } else { Err(expr) }
        }
        ExprKind::If(operands) => {
            let [condition, a, b] = operands.as_ref();
            if uses_states(condition)? {
                return Err(expr);
            }
            Ok(uses_states(a)? | uses_states(b)?)
        }
        ExprKind::Logical(..) | ExprKind::Table(..) | ExprKind::Call(..) => {
            for operand in expr.operands() {
                if uses_states(operand)? {
                    return Err(expr);
                }
            }
            Ok(false)
        }
    }
}

fn is_one(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Number(v) if (v - 1.0).abs() == 0.0)
}
