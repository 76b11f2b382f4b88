//! Formulas with a candidate's numbers in them: derivatives by the states, what is left without them, and their text.

use crate::model::{Binary, Expr, ExprKind, Model, Span, Symbol};

/// How tightly an operation binds: a comparison, a sum, a product, a power, what needs no parentheses.
const COMPARISON: u8 = 0;
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

/// `expr` with parameters as numbers, and dt too where it is one; what is constant then is a number.
pub(super) fn filled(expr: &Expr, parameters: &[f64], dt: Option<f64>) -> Expr {
    let again = |a: &Expr| filled(a, parameters, dt);
    match &expr.kind {
        ExprKind::Symbol(Symbol::Parameter(i)) => Expr::number(parameters.get(*i).copied().unwrap_or(f64::NAN)),
        ExprKind::Symbol(Symbol::Dt) => dt.map_or_else(|| expr.clone(), Expr::number),
        ExprKind::Number(_) | ExprKind::Symbol(_) => expr.clone(),
        ExprKind::Negate(a) => negated(again(a)),
        ExprKind::Binary(op, a, b) => joined(*op, again(a), again(b)),
        ExprKind::Logical(op, a, b) => folded(Expr::logical(*op, again(a), again(b))),
        ExprKind::If(operands) => {
            let [condition, a, b] = operands.as_ref();
            chosen(again(condition), again(a), again(b))
        }
        ExprKind::Table(curve, a) => {
            folded(Expr { kind: ExprKind::Table(curve.clone(), Box::new(again(a))), span: expr.span })
        }
        ExprKind::Call(function, arguments) => {
            folded(Expr { kind: ExprKind::Call(*function, arguments.iter().map(again).collect()), span: expr.span })
        }
    }
}

/// An operation on numbers alone as a number.
fn folded(expr: Expr) -> Expr {
    let constant = expr.operands().into_iter().all(|a| number(a).is_some());
    if constant { Expr::number(expr.evaluate(&|_| f64::NAN)) } else { expr }
}

/// `if(condition, a, b)`, or the one of the two that it always is.
fn chosen(condition: Expr, a: Expr, b: Expr) -> Expr {
    match number(&condition) {
        Some(value) => {
            if value > 0.0 {
                a
            } else {
                b
            }
        }
        None if a.same(&b) => a,
        None => Expr { kind: ExprKind::If(Box::new([condition, a, b])), span: Span::default() },
    }
}

/// The derivative of a formula by a state that it is affine in.
pub(super) fn coefficient(expr: &Expr, state: usize) -> Expr {
    let of = |a: &Expr| coefficient(a, state);
    let has_states = |a: &Expr| a.mentions(|symbol| matches!(symbol, Symbol::State(_)));
    match &expr.kind {
        ExprKind::Symbol(Symbol::State(i)) if *i == state => Expr::number(1.0),
        // A function of states would not be affine.
        ExprKind::Number(_)
        | ExprKind::Symbol(_)
        | ExprKind::Logical(..)
        | ExprKind::Table(..)
        | ExprKind::Call(..) => Expr::number(0.0),
        ExprKind::Negate(a) => negated(of(a)),
        ExprKind::If(operands) => chosen(operands[0].clone(), of(&operands[1]), of(&operands[2])),
        ExprKind::Binary(op @ (Binary::Add | Binary::Subtract), a, b) => joined(*op, of(a), of(b)),
        ExprKind::Binary(Binary::Multiply, a, b) if has_states(b) => joined(Binary::Multiply, (**a).clone(), of(b)),
        ExprKind::Binary(op @ (Binary::Multiply | Binary::Divide), a, b) => joined(*op, of(a), (**b).clone()),
        // A state to the power of 1.
        ExprKind::Binary(Binary::Power, a, _) => of(a),
    }
}

/// A formula with every state at 0.
pub(super) fn offset(expr: &Expr) -> Expr {
    match &expr.kind {
        ExprKind::Symbol(Symbol::State(_)) => Expr::number(0.0),
        ExprKind::Negate(a) => negated(offset(a)),
        ExprKind::Binary(op, a, b) => joined(*op, offset(a), offset(b)),
        ExprKind::If(operands) => chosen(operands[0].clone(), offset(&operands[1]), offset(&operands[2])),
        ExprKind::Number(_)
        | ExprKind::Symbol(_)
        | ExprKind::Logical(..)
        | ExprKind::Table(..)
        | ExprKind::Call(..) => expr.clone(),
    }
}

/// The value of a formula that is a number.
pub(super) const fn number(expr: &Expr) -> Option<f64> {
    match expr.kind {
        ExprKind::Number(value) => Some(value),
        _ => None,
    }
}

fn negated(a: Expr) -> Expr {
    match a.kind {
        ExprKind::Number(value) => Expr::number(-value),
        ExprKind::Negate(inner) => *inner,
        ExprKind::Binary(Binary::Multiply, factor, rest) if number(&factor).is_some() => {
            joined(Binary::Multiply, negated(*factor), *rest)
        }
        _ => Expr { span: a.span, kind: ExprKind::Negate(Box::new(a)) },
    }
}

/// `a op b` without zeros, ones and operations on numbers alone; a number in a product comes first.
fn joined(op: Binary, a: Expr, b: Expr) -> Expr {
    let is = |expr: &Expr, value: f64| number(expr).is_some_and(|v| (v - value).abs() <= 0.0);
    if op == Binary::Multiply && (is(&a, 0.0) || is(&b, 0.0)) {
        // Also of what is no number: a state that does not stand in a formula has no derivative there.
        return Expr::number(0.0);
    }
    if number(&a).is_some() && number(&b).is_some() {
        return Expr::number(Expr::binary(op, a, b).evaluate(&|_| f64::NAN));
    }
    match op {
        Binary::Add if is(&a, 0.0) => b,
        Binary::Add | Binary::Subtract if is(&b, 0.0) => a,
        Binary::Subtract if is(&a, 0.0) => negated(b),
        Binary::Divide if is(&a, 0.0) => Expr::number(0.0),
        Binary::Multiply if is(&a, 1.0) => b,
        Binary::Multiply | Binary::Divide | Binary::Power if is(&b, 1.0) => a,
        Binary::Multiply => product(a, b),
        Binary::Divide => quotient(a, b),
        _ => Expr::binary(op, a, b),
    }
}

/// A product with its number taken to the front.
fn product(a: Expr, b: Expr) -> Expr {
    let ((p, a), (q, b)) = (factored(a), factored(b));
    let rest = match (a, b) {
        (Some(a), Some(b)) => Expr::binary(Binary::Multiply, a, b),
        (Some(only), None) | (None, Some(only)) => only,
        (None, None) => return Expr::number(p * q),
    };
    scaled(p * q, rest)
}

/// `2*x / 4` as `0.5*x`; what is divided by a number alone, or by a formula, stays a quotient.
fn quotient(a: Expr, b: Expr) -> Expr {
    match (factored(a), number(&b)) {
        ((p, Some(a)), Some(divisor)) if (p - 1.0).abs() > 0.0 => scaled(p / divisor, a),
        ((p, Some(a)), _) => scaled(p, Expr::binary(Binary::Divide, a, b)),
        ((p, None), _) => Expr::binary(Binary::Divide, Expr::number(p), b),
    }
}

/// The number in front of a formula, and the rest.
fn factored(expr: Expr) -> (f64, Option<Expr>) {
    match expr.kind {
        ExprKind::Number(value) => (value, None),
        ExprKind::Negate(a) => (-1.0, Some(*a)),
        ExprKind::Binary(Binary::Multiply, a, b) if number(&a).is_some() => (number(&a).unwrap_or(1.0), Some(*b)),
        _ => (1.0, Some(expr)),
    }
}

fn scaled(factor: f64, rest: Expr) -> Expr {
    if (factor - 1.0).abs() <= 0.0 {
        rest
    } else if (factor + 1.0).abs() <= 0.0 {
        negated(rest)
    } else {
        Expr::binary(Binary::Multiply, Expr::number(factor), rest)
    }
}

/// Writes formulas of a model as a problem file does, numbers by `number`.
pub(super) struct Writer<'a> {
    pub(super) model: &'a Model,
    pub(super) number: &'a dyn Fn(f64) -> String,
}

impl Writer<'_> {
    /// The text of a formula whose parameters are filled in.
    pub(super) fn text(&self, expr: &Expr) -> String {
        self.bound(expr).0
    }

    /// The text, and how tightly its outermost operation binds.
    fn bound(&self, expr: &Expr) -> (String, u8) {
        match &expr.kind {
            ExprKind::Number(value) => ((self.number)(*value), if *value < 0.0 { SUM } else { ATOM }),
            ExprKind::Symbol(symbol) => (self.name(*symbol), ATOM),
            ExprKind::Negate(a) => (format!("-{}", self.within(a, PRODUCT)), SUM),
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b),
            ExprKind::Logical(op, a, b) => {
                let (a, b) = (self.within(a, SUM), self.within(b, SUM));
                (format!("{a} {} {b}", op.symbol()), COMPARISON)
            }
            ExprKind::If(_) => (self.call("if", expr), ATOM),
            ExprKind::Table(curve, a) => (format!("table({curve}, {})", self.text(a)), ATOM),
            ExprKind::Call(function, _) => (self.call(function.name(), expr), ATOM),
        }
    }

    fn call(&self, name: &str, expr: &Expr) -> String {
        let arguments: Vec<String> = expr.operands().into_iter().map(|a| self.text(a)).collect();
        format!("{name}({})", arguments.join(", "))
    }

    fn binary(&self, op: Binary, a: &Expr, b: &Expr) -> (String, u8) {
        match op {
            Binary::Add | Binary::Subtract => {
                // `a + -2*b` reads better as `a - 2*b`.
                let (factor, _) = factored(b.clone());
                let flipped = factor < 0.0;
                let minus = (op == Binary::Subtract) != flipped;
                let b = if flipped { negated(b.clone()) } else { b.clone() };
                let right = self.within(&b, if minus { PRODUCT } else { SUM });
                (format!("{} {} {right}", self.within(a, SUM), if minus { '-' } else { '+' }), SUM)
            }
            Binary::Multiply => (format!("{}*{}", self.leading(a), self.within(b, PRODUCT)), PRODUCT),
            Binary::Divide => (format!("{}/{}", self.leading(a), self.within(b, POWER)), PRODUCT),
            Binary::Power => (format!("{}^{}", self.within(a, ATOM), self.within(b, ATOM)), POWER),
        }
    }

    /// The first factor of a product: a sign in front of it is that of the product.
    fn leading(&self, expr: &Expr) -> String {
        if number(expr).is_some() { self.text(expr) } else { self.within(expr, PRODUCT) }
    }

    /// In parentheses where it binds less tightly than its place asks for.
    fn within(&self, expr: &Expr, least: u8) -> String {
        let (text, binds) = self.bound(expr);
        if binds < least { format!("({text})") } else { text }
    }

    fn name(&self, symbol: Symbol) -> String {
        let of = |names: &[String], i: usize| names.get(i).cloned().unwrap_or_default();
        match symbol {
            Symbol::State(i) => of(&self.model.states, i),
            Symbol::Input(i) => of(&self.model.inputs, i),
            Symbol::Dt => "dt".to_owned(),
            // Filled in before.
            Symbol::Parameter(_) => String::new(),
        }
    }
}
