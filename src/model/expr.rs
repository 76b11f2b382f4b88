//! The formula tree. It is what the problem file means: the tape traces it, the reference evaluates it.

use crate::tape::Function;

/// A formula: a tree of operations on states, parameters, inputs and dt.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// The operation.
    pub kind: ExprKind,
    /// Where it stands in the problem file; empty for formulas kfgpu made itself.
    pub span: Span,
}

/// Byte range in the problem file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// What a node of a formula is.
#[derive(Debug, Clone, PartialEq)]
pub enum ExprKind {
    /// A literal.
    Number(f64),
    /// A named quantity.
    Symbol(Symbol),
    /// `-a`.
    Negate(Box<Expr>),
    /// `a op b`.
    Binary(Binary, Box<Expr>, Box<Expr>),
    /// `function(a, ...)`, with as many arguments as [`Function::arity`] says.
    Call(Function, Vec<Expr>),
}

/// A named quantity, by its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Symbol {
    /// State `i` of [`super::Model::states`].
    State(usize),
    /// Entry `i` of [`super::Parameters::all`].
    Parameter(usize),
    /// Input `i` of [`super::Model::inputs`].
    Input(usize),
    /// Interval to the next row in seconds.
    Dt,
}

/// Binary operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are the operators")]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Binary {
    /// The operator as formulas write it.
    #[must_use]
    pub const fn symbol(self) -> char {
        match self {
            Self::Add => '+',
            Self::Subtract => '-',
            Self::Multiply => '*',
            Self::Divide => '/',
            Self::Power => '^',
        }
    }
}

impl Expr {
    /// A literal that kfgpu made itself.
    #[must_use]
    pub const fn number(value: f64) -> Self {
        Self { kind: ExprKind::Number(value), span: Span { start: 0, end: 0 } }
    }

    /// A symbol that kfgpu made itself.
    #[must_use]
    pub const fn symbol(symbol: Symbol) -> Self {
        Self { kind: ExprKind::Symbol(symbol), span: Span { start: 0, end: 0 } }
    }

    /// `a op b`, made by kfgpu itself.
    #[must_use]
    pub fn binary(op: Binary, a: Self, b: Self) -> Self {
        Self { kind: ExprKind::Binary(op, Box::new(a), Box::new(b)), span: Span::default() }
    }

    /// Replaces the span of every node.
    pub(super) fn map_spans(&mut self, map: &impl Fn(Span) -> Span) {
        self.span = map(self.span);
        match &mut self.kind {
            ExprKind::Number(_) | ExprKind::Symbol(_) => {}
            ExprKind::Negate(a) => a.map_spans(map),
            ExprKind::Binary(_, a, b) => {
                a.map_spans(map);
                b.map_spans(map);
            }
            ExprKind::Call(_, arguments) => arguments.iter_mut().for_each(|a| a.map_spans(map)),
        }
    }

    /// Calls `visit` on every symbol, in reading order.
    pub fn symbols(&self, visit: &mut impl FnMut(Symbol)) {
        match &self.kind {
            ExprKind::Number(_) => {}
            ExprKind::Symbol(s) => visit(*s),
            ExprKind::Negate(a) => a.symbols(visit),
            ExprKind::Binary(_, a, b) => {
                a.symbols(visit);
                b.symbols(visit);
            }
            ExprKind::Call(_, arguments) => arguments.iter().for_each(|a| a.symbols(visit)),
        }
    }

    /// Whether any symbol satisfies `wanted`.
    #[must_use]
    pub fn mentions(&self, wanted: impl Fn(Symbol) -> bool) -> bool {
        let mut found = false;
        self.symbols(&mut |s| found |= wanted(s));
        found
    }

    /// Whether both are the same formula, wherever they stand.
    #[must_use]
    pub fn same(&self, other: &Self) -> bool {
        match (&self.kind, &other.kind) {
            (ExprKind::Negate(a), ExprKind::Negate(b)) => a.same(b),
            (ExprKind::Binary(p, a, b), ExprKind::Binary(q, c, d)) => p == q && a.same(c) && b.same(d),
            (ExprKind::Call(p, a), ExprKind::Call(q, b)) => p == q && a.iter().zip(b).all(|(a, b)| a.same(b)),
            (a, b) => a == b,
        }
    }

    /// Whether it is literally the number 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        matches!(self.kind, ExprKind::Number(v) if v.abs() == 0.0)
    }
}
