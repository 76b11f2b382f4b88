//! The formula tree. It is what the problem file means: the tape traces it, the reference evaluates it.

use std::sync::Arc;

use super::Curve;
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
    /// `a < b` and its like, and `a and b`: 1 where it holds, else 0.
    Logical(Logical, Box<Expr>, Box<Expr>),
    /// `if(condition, a, b)`: a where the condition is above 0, else b. The other of the two does not matter, even if it is
    /// no number.
    If(Box<[Expr; 3]>),
    /// `table("file", a)`: a curve at a.
    Table(Arc<Curve>, Box<Expr>),
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

/// Comparisons, and what joins them. What is above 0 holds; `not a` is `a <= 0`.
///
/// All are told from the sign of a - b, as the tape does: `a <= b` holds where a - b is not above 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are the operators")]
pub enum Logical {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
    And,
    Or,
}

impl Logical {
    /// The operator as formulas write it.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::And => "and",
            Self::Or => "or",
        }
    }
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

    /// `a op b`, made by kfgpu itself.
    #[must_use]
    pub fn logical(op: Logical, a: Self, b: Self) -> Self {
        Self { kind: ExprKind::Logical(op, Box::new(a), Box::new(b)), span: Span::default() }
    }

    /// Operands, in reading order.
    #[must_use]
    pub fn operands(&self) -> Vec<&Self> {
        match &self.kind {
            ExprKind::Number(_) | ExprKind::Symbol(_) => vec![],
            ExprKind::Negate(a) | ExprKind::Table(_, a) => vec![a],
            ExprKind::Binary(_, a, b) | ExprKind::Logical(_, a, b) => vec![a, b],
            ExprKind::If(operands) => operands.iter().collect(),
            ExprKind::Call(_, arguments) => arguments.iter().collect(),
        }
    }

    /// Nodes, and how many of them lie above each other.
    pub(super) fn extent(&self) -> (usize, usize) {
        let below = self.operands().into_iter().map(Self::extent);
        let (size, depth) = below.fold((0, 0), |(size, depth), (s, d)| (size + s, depth.max(d)));
        (size + 1, depth + 1)
    }

    /// Replaces the span of every node.
    pub(super) fn map_spans(&mut self, map: &impl Fn(Span) -> Span) {
        self.span = map(self.span);
        match &mut self.kind {
            ExprKind::Number(_) | ExprKind::Symbol(_) => {}
            ExprKind::Negate(a) | ExprKind::Table(_, a) => a.map_spans(map),
            ExprKind::Binary(_, a, b) | ExprKind::Logical(_, a, b) => {
                a.map_spans(map);
                b.map_spans(map);
            }
            ExprKind::If(operands) => operands.iter_mut().for_each(|a| a.map_spans(map)),
            ExprKind::Call(_, arguments) => arguments.iter_mut().for_each(|a| a.map_spans(map)),
        }
    }

    /// Replaces every symbol.
    pub(super) fn map_symbols(&mut self, map: &impl Fn(Symbol) -> Symbol) {
        match &mut self.kind {
            ExprKind::Number(_) => {}
            ExprKind::Symbol(symbol) => *symbol = map(*symbol),
            ExprKind::Negate(a) | ExprKind::Table(_, a) => a.map_symbols(map),
            ExprKind::Binary(_, a, b) | ExprKind::Logical(_, a, b) => {
                a.map_symbols(map);
                b.map_symbols(map);
            }
            ExprKind::If(operands) => operands.iter_mut().for_each(|a| a.map_symbols(map)),
            ExprKind::Call(_, arguments) => arguments.iter_mut().for_each(|a| a.map_symbols(map)),
        }
    }

    /// Calls `visit` on every symbol, in reading order.
    pub fn symbols(&self, visit: &mut impl FnMut(Symbol)) {
        match &self.kind {
            ExprKind::Symbol(s) => visit(*s),
            _ => self.operands().into_iter().for_each(|a| a.symbols(visit)),
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
            (ExprKind::Table(p, a), ExprKind::Table(q, b)) => p == q && a.same(b),
            (ExprKind::Logical(p, a, b), ExprKind::Logical(q, c, d)) => p == q && a.same(c) && b.same(d),
            (ExprKind::If(a), ExprKind::If(b)) => a.iter().zip(b.iter()).all(|(a, b)| a.same(b)),
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
