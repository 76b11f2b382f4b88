//! What the symbols of a formula stand for where the reference evaluates it.

use crate::model::{Duals, Expr, Formula, Symbol};

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
    expr.evaluate(&|symbol| scope.of(symbol))
}

/// The partial derivatives of one formula in the states, as many as [`Scope::states`] has, by dual numbers on the tree: no
/// step, no graph. At a kink they are those of the side that the tape takes.
///
/// ```
/// use kfgpu::model::{Binary, Expr, Symbol};
/// use kfgpu::reference::{Scope, gradient};
///
/// let x = |i| Expr::symbol(Symbol::State(i));
/// let product = Expr::binary(Binary::Multiply, x(0), x(1));
/// assert_eq!(gradient(&product, &Scope { states: &[2.0, 3.0], ..Scope::default() }), [3.0, 2.0]);
/// ```
#[must_use]
pub fn gradient(expr: &Expr, scope: &Scope) -> Vec<f64> {
    scope.gradient(&Formula::of(expr), &mut Duals::default()).1
}

impl Scope<'_> {
    /// The value of a formula and its partial derivatives in the states; `stack` is scratch.
    pub(super) fn gradient(&self, formula: &Formula, stack: &mut Duals) -> (f64, Vec<f64>) {
        formula.gradient(|symbol| self.of(symbol), self.states.len(), stack)
    }

    /// The value of a formula; `stack` is scratch.
    pub(super) fn value(&self, formula: &Formula, stack: &mut Vec<f64>) -> f64 {
        formula.value(|symbol| self.of(symbol), stack)
    }

    fn of(&self, symbol: Symbol) -> f64 {
        let found = match symbol {
            Symbol::State(i) => self.states.get(i),
            Symbol::Parameter(i) => self.parameters.get(i),
            Symbol::Input(i) => self.inputs.get(i),
            Symbol::Dt => Some(&self.dt),
        };
        found.copied().unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::model::{Binary, ExprKind, Function};

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
