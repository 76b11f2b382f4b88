//! Formulas with their derivatives in f64, by dual numbers on the tree: every operation turns the values and slopes of its
//! operands into its own. The derivatives are those of a table of functions, not of the tape's nodes: the reference judges
//! with them.
//!
//! At a kink the slope is that of the side that the tape takes: of `abs` the left one, of `min` and `max` that of the second
//! operand; `floor`, `round` and `sign` have none, and `wrap` goes on over its seam.

use std::f64::consts::{FRAC_2_SQRT_PI, LOG10_E};

use super::evaluate::{Operation, binary, call, holds};
use super::{Binary, Formula, Function, Symbol};

/// Scratch of [`Formula::gradient`]: values, and n slopes for each. `None` is of what does not depend on a state at all,
/// and stays 0 whatever it is multiplied with.
#[derive(Debug, Default)]
pub(crate) struct Duals {
    values: Vec<f64>,
    slopes: Vec<Option<f64>>,
}

/// Derivative of an operation in each operand; `None` for one that was not chosen, whose own slope may be anything.
type Partials = [Option<f64>; 2];

impl Formula {
    /// The value, and the partial derivatives in states 0 to n - 1, with `symbol` giving every symbol's value; the content of
    /// `stack` is lost.
    pub(crate) fn gradient(&self, symbol: impl Fn(Symbol) -> f64, n: usize, stack: &mut Duals) -> (f64, Vec<f64>) {
        stack.values.clear();
        stack.slopes.clear();
        for operation in &self.operations {
            match operation {
                Operation::Number(value) => stack.push(*value, n, |_| None),
                Operation::Symbol(name) => {
                    stack.push(symbol(*name), n, |j| (*name == Symbol::State(j)).then_some(1.0));
                }
                Operation::Negate => stack.apply(n, |a| (-a, Some(-1.0))),
                Operation::Binary(op) => stack.apply_pair(n, |a, b| (binary(*op, a, b), binary_slopes(*op, a, b))),
                Operation::Logical(op) => {
                    stack.apply_pair(n, |a, b| (f64::from(u8::from(holds(*op, a, b))), [None; 2]));
                }
                Operation::If => stack.choose(n),
                Operation::Call(function) if function.arity() == 2 => {
                    stack.apply_pair(n, |a, b| (call(*function, a, b), pair_slopes(*function, a, b)));
                }
                Operation::Table(curve) => stack.apply(n, |a| {
                    let (value, slope) = curve.at(a);
                    (value, Some(slope))
                }),
                Operation::Call(function) => stack.apply(n, |a| (call(*function, a, f64::NAN), slope(*function, a))),
            }
        }
        let value = stack.values.pop().unwrap_or(f64::NAN);
        (value, stack.slopes.iter().map(|slope| slope.unwrap_or(0.0)).collect())
    }
}

impl Duals {
    fn push(&mut self, value: f64, n: usize, slope: impl Fn(usize) -> Option<f64>) {
        self.values.push(value);
        self.slopes.extend((0..n).map(slope));
    }

    /// Replaces the last value a by y(a), with dy/da; `None` where y has no slope anywhere.
    fn apply(&mut self, n: usize, of: impl Fn(f64) -> (f64, Option<f64>)) {
        let Some(last) = self.values.last_mut() else { return };
        let (value, partial) = of(*last);
        *last = value;
        let first = self.slopes.len() - n;
        for slope in &mut self.slopes[first..] {
            *slope = slope.zip(partial).map(|(da, partial)| partial * da);
        }
    }

    /// Replaces the last values a and b by y(a, b), with dy/da and dy/db.
    fn apply_pair(&mut self, n: usize, of: impl Fn(f64, f64) -> (f64, Partials)) {
        let Some(b) = self.values.pop() else { return };
        let Some(last) = self.values.last_mut() else { return };
        let (value, [in_a, in_b]) = of(*last, b);
        *last = value;
        let first = self.slopes.len() - 2 * n;
        for j in first..first + n {
            let part =
                |slope: Option<f64>, partial: Option<f64>| slope.map(|d| partial.map_or(0.0, |partial| partial * d));
            let (da, db) = (part(self.slopes[j], in_a), part(self.slopes[j + n], in_b));
            self.slopes[j] = match (da, db) {
                (Some(da), Some(db)) => Some(da + db),
                (da, db) => da.or(db),
            };
        }
        self.slopes.truncate(first + n);
    }

    /// Replaces a condition and two values by the first where it is above 0, else by the second, slopes and all.
    fn choose(&mut self, n: usize) {
        let (Some(b), Some(a)) = (self.values.pop(), self.values.pop()) else { return };
        let Some(last) = self.values.last_mut() else { return };
        let first = *last > 0.0;
        *last = if first { a } else { b };
        let start = self.slopes.len() - 3 * n;
        for j in start..start + n {
            let (da, db) = (self.slopes[j + n], self.slopes[j + 2 * n]);
            // What moves in the other place alone stands still here.
            self.slopes[j] = if first { da.or(db.map(|_| 0.0)) } else { db.or(da.map(|_| 0.0)) };
        }
        self.slopes.truncate(start + n);
    }
}

fn binary_slopes(op: Binary, a: f64, b: f64) -> Partials {
    match op {
        Binary::Add => [Some(1.0); 2],
        Binary::Subtract => [Some(1.0), Some(-1.0)],
        Binary::Multiply => [Some(b), Some(a)],
        Binary::Divide => [Some(1.0 / b), Some(-a / b / b)],
        Binary::Power => [(b != 0.0).then(|| b * a.powf(b - 1.0)), Some(a.powf(b) * a.ln())],
    }
}

fn pair_slopes(function: Function, a: f64, b: f64) -> Partials {
    let first = |chosen: bool| if chosen { [Some(1.0), None] } else { [None, Some(1.0)] };
    match function {
        Function::Min => first(a < b),
        Function::Max => first(a > b),
        Function::Atan2 => {
            let radius = a.hypot(b);
            [Some(b / radius / radius), Some(-a / radius / radius)]
        }
        _ => [Some(f64::NAN); 2],
    }
}

fn slope(function: Function, a: f64) -> Option<f64> {
    Some(match function {
        Function::Sqrt => 0.5 / a.sqrt(),
        Function::Exp | Function::Expm1 => a.exp(),
        Function::Ln => 1.0 / a,
        Function::Log1p => 1.0 / (1.0 + a),
        Function::Log10 => LOG10_E / a,
        Function::Sin => a.cos(),
        Function::Cos => -a.sin(),
        Function::Tan => 1.0 / a.cos().powi(2),
        Function::Asin => 1.0 / ((1.0 - a) * (1.0 + a)).sqrt(),
        Function::Acos => -1.0 / ((1.0 - a) * (1.0 + a)).sqrt(),
        Function::Atan => 1.0 / (1.0 + a * a),
        Function::Tanh => a.cosh().recip().powi(2),
        Function::Sinc => sinc_slope(a),
        // sinc a - sinc(a/2)^2 / 2.
        Function::Cosc => call(Function::Sinc, a, f64::NAN) - 0.5 * call(Function::Sinc, 0.5 * a, f64::NAN).powi(2),
        Function::Wrap => 1.0,
        Function::Abs if a > 0.0 => 1.0,
        Function::Abs => -1.0,
        Function::Erf => FRAC_2_SQRT_PI * (-a * a).exp(),
        Function::Lgamma if a > 0.0 => digamma(a),
        Function::Lgamma => f64::NAN,
        Function::Floor | Function::Round | Function::Sign => return None,
        Function::Atan2 | Function::Min | Function::Max => f64::NAN,
    })
}

/// (cos a - sin a / a) / a, which cancels near 0: there the sum of (-1)^k 2k a^(2k-1) / (2k+1)!.
fn sinc_slope(a: f64) -> f64 {
    if a.abs() > 0.5 {
        return (a.cos() - a.sin() / a) / a;
    }
    let (mut power, mut sum) = (a, 0.0);
    for k in 1..9 {
        let twice = 2.0 * f64::from(k);
        // power is (-1)^(k-1) a^(2k-1) / (2k-1)!.
        sum -= power / (twice + 1.0);
        power *= -a * a / (twice * (twice + 1.0));
    }
    sum
}

/// The derivative of ln Gamma, for a > 0: psi(a) = psi(a + 1) - 1 / a up to 15, then its asymptotic series (Abramowitz and
/// Stegun 6.3.18).
fn digamma(a: f64) -> f64 {
    /// B_2k / 2k.
    const SERIES: [f64; 6] = [1.0 / 12.0, -1.0 / 120.0, 1.0 / 252.0, -1.0 / 240.0, 1.0 / 132.0, -691.0 / 32_760.0];
    let (mut a, mut before) = (a, 0.0);
    while a < 15.0 {
        before += 1.0 / a;
        a += 1.0;
    }
    let square = 1.0 / (a * a);
    let series = SERIES.iter().rev().fold(0.0, |sum, c| (sum + c) * square);
    a.ln() - 0.5 / a - series - before
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Expr, ExprKind};

    fn gradient(expr: &Expr, at: [f64; 2]) -> (f64, Vec<f64>) {
        let symbol = |symbol| if let Symbol::State(i) = symbol { at[i] } else { f64::NAN };
        Formula::of(expr).gradient(symbol, 2, &mut Duals::default())
    }

    fn call1(function: Function, a: Expr) -> Expr {
        Expr { kind: ExprKind::Call(function, vec![a]), span: Default::default() }
    }

    #[test]
    fn what_does_not_depend_on_a_state_has_no_slope_in_it() {
        let (x, y) = (Expr::symbol(Symbol::State(0)), Expr::symbol(Symbol::State(1)));
        let root = call1(Function::Sqrt, y);
        assert_eq!(gradient(&Expr::binary(Binary::Multiply, x, root), [3.0, 0.0]), (0.0, vec![0.0, f64::INFINITY]));
        let x = Expr::symbol(Symbol::State(0));
        let power = Expr::binary(Binary::Power, x, Expr::number(2.0));
        assert_eq!(gradient(&power, [-3.0, 0.0]), (9.0, vec![-6.0, 0.0]), "a whole power of a negative base");
    }

    #[test]
    fn known_slopes() {
        // psi(1) is minus Euler's constant, psi(1/2) = psi(1) - 2 ln 2; sinc'(0) = 0, sinc'(pi) = -1/pi.
        let euler = 0.577_215_664_901_532_9;
        for (function, a, expected) in [
            (Function::Lgamma, 1.0, -euler),
            (Function::Lgamma, 0.5, -euler - 2.0 * 2f64.ln()),
            (Function::Sinc, 0.0, 0.0),
            (Function::Sinc, std::f64::consts::PI, -1.0 / std::f64::consts::PI),
            (Function::Cosc, 0.0, 0.5),
            (Function::Abs, 0.0, -1.0),
        ] {
            let found = slope(function, a).unwrap();
            assert!((found - expected).abs() < 1e-15, "{function:?} at {a}: {found}, expected {expected}");
        }
        assert_eq!(slope(Function::Floor, 1.5), None, "a step has no slope");
    }
}
