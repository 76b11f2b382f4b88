//! Formulas in f64, straight from the tree: postfix order and a stack, so that depth costs memory and not the call stack.
//! Functions are those of the system and of `libm`, not those of the tape: the reference judges with them.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{Binary, Curve, Expr, ExprKind, Function, Logical, Symbol};

impl Expr {
    /// The value in f64, with `symbol` giving every symbol's; NaN and infinities follow IEEE 754.
    #[must_use]
    pub fn evaluate(&self, symbol: &impl Fn(Symbol) -> f64) -> f64 {
        Formula::of(self).value(symbol, &mut Vec::new())
    }
}

/// A formula in postfix order, for repeated evaluation.
#[derive(Debug, Clone)]
pub(crate) struct Formula {
    pub(super) operations: Vec<Operation>,
}

#[derive(Debug, Clone)]
pub(super) enum Operation {
    Number(f64),
    Symbol(Symbol),
    Negate,
    Binary(Binary),
    Logical(Logical),
    If,
    Table(Arc<Curve>),
    Call(Function),
}

impl Formula {
    /// Children pushed in order and popped last first give the mirrored postfix order, reversed at the end.
    pub(crate) fn of(expr: &Expr) -> Self {
        let mut pending = vec![expr];
        let mut operations = Vec::new();
        while let Some(node) = pending.pop() {
            operations.push(match &node.kind {
                ExprKind::Number(value) => Operation::Number(*value),
                ExprKind::Symbol(symbol) => Operation::Symbol(*symbol),
                ExprKind::Negate(_) => Operation::Negate,
                ExprKind::Binary(op, ..) => Operation::Binary(*op),
                ExprKind::Logical(op, ..) => Operation::Logical(*op),
                ExprKind::If(_) => Operation::If,
                ExprKind::Table(curve, _) => Operation::Table(Arc::clone(curve)),
                ExprKind::Call(function, _) => Operation::Call(*function),
            });
            pending.extend(node.operands());
        }
        operations.reverse();
        Self { operations }
    }

    pub(crate) fn mentions_input(&self) -> bool {
        self.operations.iter().any(|op| matches!(op, Operation::Symbol(Symbol::Input(_))))
    }

    /// The value with `symbol` giving every symbol's; `stack` is scratch, its content is lost.
    pub(crate) fn value(&self, symbol: impl Fn(Symbol) -> f64, stack: &mut Vec<f64>) -> f64 {
        stack.clear();
        for operation in &self.operations {
            let value = match operation {
                Operation::Number(value) => *value,
                Operation::Symbol(name) => symbol(*name),
                Operation::Negate => -pop(stack),
                Operation::Binary(op) => {
                    let b = pop(stack);
                    binary(*op, pop(stack), b)
                }
                Operation::Logical(op) => {
                    let b = pop(stack);
                    f64::from(u8::from(holds(*op, pop(stack), b)))
                }
                Operation::If => {
                    let (b, a) = (pop(stack), pop(stack));
                    if pop(stack) > 0.0 { a } else { b }
                }
                Operation::Call(function) if function.arity() == 2 => {
                    let b = pop(stack);
                    call(*function, pop(stack), b)
                }
                Operation::Table(curve) => curve.at(pop(stack)).0,
                Operation::Call(function) => call(*function, pop(stack), f64::NAN),
            };
            stack.push(value);
        }
        pop(stack)
    }
}

fn pop(stack: &mut Vec<f64>) -> f64 {
    stack.pop().unwrap_or(f64::NAN)
}

pub(super) fn binary(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => a.powf(b),
    }
}

/// Whether a comparison holds, by the sign of a difference.
pub(super) fn holds(op: Logical, a: f64, b: f64) -> bool {
    match op {
        Logical::Less => b - a > 0.0,
        Logical::LessOrEqual => !holds(Logical::Greater, a, b),
        Logical::Greater => a - b > 0.0,
        Logical::GreaterOrEqual => !holds(Logical::Less, a, b),
        Logical::Equal => !holds(Logical::NotEqual, a, b),
        Logical::NotEqual => (a - b).abs() > 0.0,
        Logical::And => a > 0.0 && b > 0.0,
        Logical::Or => a > 0.0 || b > 0.0,
    }
}

pub(super) fn call(function: Function, a: f64, b: f64) -> f64 {
    match function {
        Function::Sqrt => a.sqrt(),
        Function::Exp => a.exp(),
        Function::Expm1 => a.exp_m1(),
        Function::Ln => a.ln(),
        Function::Log1p => a.ln_1p(),
        Function::Log10 => a.log10(),
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.tan(),
        Function::Asin => a.asin(),
        Function::Acos => a.acos(),
        Function::Atan => a.atan(),
        Function::Atan2 => a.atan2(b),
        Function::Tanh => a.tanh(),
        Function::Sinc if a == 0.0 => 1.0,
        Function::Sinc => a.sin() / a,
        Function::Cosc if a == 0.0 => 0.0,
        Function::Cosc => 2.0 * (0.5 * a).sin().powi(2) / a,
        Function::Wrap => wrap(a),
        Function::Floor => a.floor(),
        Function::Round => a.round_ties_even(),
        Function::Sign if a == 0.0 => 0.0,
        Function::Sign => a.signum(),
        Function::Abs => a.abs(),
        Function::Min => a.min(b),
        Function::Max => a.max(b),
        Function::Erf => libm::erf(a),
        Function::Lgamma if a > 0.0 => libm::lgamma(a),
        Function::Lgamma => f64::NAN,
    }
}

/// The angle in [-pi, pi), from its sine and cosine where it is not there already.
pub(super) fn wrap(a: f64) -> f64 {
    if (-PI..PI).contains(&a) {
        return a;
    }
    let angle = a.sin().atan2(a.cos());
    if angle >= PI { -PI } else { angle }
}
