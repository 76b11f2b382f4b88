//! Formulas in f64, straight from the tree: postfix order and a stack, so that depth costs memory and not the call stack.
//! Functions are those of the system and of `libm`, not those of the tape: the reference judges with them.

use super::{Binary, Expr, ExprKind, Function, Symbol};

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
    operations: Vec<Operation>,
}

#[derive(Debug, Clone, Copy)]
enum Operation {
    Number(f64),
    Symbol(Symbol),
    Negate,
    Binary(Binary),
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
                ExprKind::Negate(a) => {
                    pending.push(a);
                    Operation::Negate
                }
                ExprKind::Binary(op, a, b) => {
                    pending.extend([a.as_ref(), b.as_ref()]);
                    Operation::Binary(*op)
                }
                ExprKind::Call(function, arguments) => {
                    pending.extend(arguments);
                    Operation::Call(*function)
                }
            });
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
            let value = match *operation {
                Operation::Number(value) => value,
                Operation::Symbol(name) => symbol(name),
                Operation::Negate => -pop(stack),
                Operation::Binary(op) => {
                    let b = pop(stack);
                    binary(op, pop(stack), b)
                }
                Operation::Call(function) if function.arity() == 2 => {
                    let b = pop(stack);
                    call(function, pop(stack), b)
                }
                Operation::Call(function) => call(function, pop(stack), f64::NAN),
            };
            stack.push(value);
        }
        pop(stack)
    }
}

fn pop(stack: &mut Vec<f64>) -> f64 {
    stack.pop().unwrap_or(f64::NAN)
}

fn binary(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => a.powf(b),
    }
}

fn call(function: Function, a: f64, b: f64) -> f64 {
    match function {
        Function::Sqrt => a.sqrt(),
        Function::Exp => a.exp(),
        Function::Ln => a.ln(),
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.tan(),
        Function::Atan => a.atan(),
        Function::Atan2 => a.atan2(b),
        Function::Abs => a.abs(),
        Function::Min => a.min(b),
        Function::Max => a.max(b),
    }
}
