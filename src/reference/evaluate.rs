//! Formulas in f64, straight from the tree: postfix order and a stack, so that depth costs memory and not the call stack.

use crate::model::{Binary, Expr, ExprKind, Function, Symbol};

/// What the symbols of a formula stand for. A symbol outside its slice evaluates to NaN.
#[derive(Debug, Clone, Copy, Default)]
pub struct Scope<'a> {
    /// State, n.
    pub states: &'a [f64],
    /// Values of [`crate::model::Parameters::all`].
    pub parameters: &'a [f64],
    /// Inputs of the row.
    pub inputs: &'a [f64],
    /// Interval to the next row \[s\].
    pub dt: f64,
}

/// The value of one formula.
///
/// ```
/// use kfgpu::model::{Binary, Expr, Symbol};
/// use kfgpu::reference::{Scope, evaluate};
///
/// let twice_dt = Expr::binary(Binary::Multiply, Expr::number(2.0), Expr::symbol(Symbol::Dt));
/// assert_eq!(evaluate(&twice_dt, &Scope { dt: 0.5, ..Scope::default() }), 1.0);
/// ```
#[must_use]
pub fn evaluate(expr: &Expr, scope: &Scope) -> f64 {
    Formula::of(expr).value(scope, &mut Vec::new())
}

/// A formula in postfix order, for repeated evaluation.
#[derive(Debug, Clone)]
pub(super) struct Formula {
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
    pub(super) fn of(expr: &Expr) -> Self {
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

    pub(super) fn mentions_input(&self) -> bool {
        self.operations.iter().any(|op| matches!(op, Operation::Symbol(Symbol::Input(_))))
    }

    /// The value; `stack` is scratch, its content is lost.
    pub(super) fn value(&self, scope: &Scope, stack: &mut Vec<f64>) -> f64 {
        stack.clear();
        for operation in &self.operations {
            let value = match *operation {
                Operation::Number(value) => value,
                Operation::Symbol(symbol) => lookup(symbol, scope),
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

fn lookup(symbol: Symbol, scope: &Scope) -> f64 {
    let found = match symbol {
        Symbol::State(i) => scope.states.get(i),
        Symbol::Parameter(i) => scope.parameters.get(i),
        Symbol::Input(i) => scope.inputs.get(i),
        Symbol::Dt => Some(&scope.dt),
    };
    found.copied().unwrap_or(f64::NAN)
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

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn call2(function: Function, a: Expr, b: Expr) -> Expr {
        Expr { kind: ExprKind::Call(function, vec![a, b]), span: Default::default() }
    }

    fn value(expr: &Expr) -> f64 {
        let scope = Scope { states: &[2.0, 3.0], parameters: &[5.0], inputs: &[7.0], dt: 0.5 };
        evaluate(expr, &scope)
    }

    #[test]
    fn operands_keep_their_order() {
        let (x0, x1) = (Expr::symbol(Symbol::State(0)), Expr::symbol(Symbol::State(1)));
        assert_eq!(value(&Expr::binary(Binary::Subtract, x0.clone(), x1.clone())), -1.0, "2 - 3");
        assert_eq!(value(&Expr::binary(Binary::Divide, x1.clone(), x0.clone())), 1.5, "3 / 2");
        assert_eq!(value(&Expr::binary(Binary::Power, x0.clone(), x1.clone())), 8.0, "2 ^ 3");
        assert_eq!(value(&call2(Function::Atan2, x0.clone(), x1.clone())), 2f64.atan2(3.0), "atan2(2, 3)");
        assert_eq!(value(&call2(Function::Max, x0, x1)), 3.0, "max(2, 3)");
    }

    #[test]
    fn every_kind_of_symbol_is_found() {
        let product = [Symbol::Parameter(0), Symbol::Input(0), Symbol::Dt]
            .map(Expr::symbol)
            .into_iter()
            .reduce(|a, b| Expr::binary(Binary::Multiply, a, b));
        assert_eq!(product.map(|p| value(&p)), Some(17.5), "5 * 7 * 0.5");
        assert!(value(&Expr::symbol(Symbol::State(2))).is_nan(), "an unknown state is NaN, not a panic");
    }

    #[test]
    fn a_chain_of_ten_thousand_terms_needs_no_call_stack() {
        let one = Expr::number(1.0);
        let left = (0..10_000).fold(one.clone(), |sum, _| Expr::binary(Binary::Add, sum, one.clone()));
        let right = (0..10_000).fold(one.clone(), |sum, _| Expr::binary(Binary::Subtract, one.clone(), sum));
        assert_eq!(value(&left), 10_001.0, "((1 + 1) + 1) + ...");
        assert_eq!(value(&right), 1.0, "1 - (1 - (1 - ...))");
    }
}
