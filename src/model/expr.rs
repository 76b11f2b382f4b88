//! The formula tree. It is what the problem file means: the tape traces it, the reference evaluates it.

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

impl Binary {
    fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => a.powf(b),
        }
    }
}

/// Functions a formula may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are the functions")]
pub enum Function {
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Atan,
    Atan2,
    Abs,
    Min,
    Max,
}

impl Function {
    /// Every function with the name it has in formulas.
    pub const ALL: [(&'static str, Self); 11] = [
        ("sqrt", Self::Sqrt),
        ("exp", Self::Exp),
        ("ln", Self::Ln),
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("atan", Self::Atan),
        ("atan2", Self::Atan2),
        ("abs", Self::Abs),
        ("min", Self::Min),
        ("max", Self::Max),
    ];

    /// Its name in formulas.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, function)| *function == self).map_or("", |(name, _)| name)
    }

    /// Number of arguments.
    #[must_use]
    pub const fn arity(self) -> usize {
        match self {
            Self::Atan2 | Self::Min | Self::Max => 2,
            _ => 1,
        }
    }

    /// The value at `a`, and for functions of two arguments `b()`.
    fn apply(self, a: f64, b: impl Fn() -> f64) -> f64 {
        match self {
            Self::Sqrt => a.sqrt(),
            Self::Exp => a.exp(),
            Self::Ln => a.ln(),
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Tan => a.tan(),
            Self::Atan => a.atan(),
            Self::Atan2 => a.atan2(b()),
            Self::Abs => a.abs(),
            Self::Min => a.min(b()),
            Self::Max => a.max(b()),
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

    /// The value in f64, with `value` giving every symbol's; NaN and infinities follow IEEE 754.
    #[must_use]
    pub fn evaluate(&self, value: &impl Fn(Symbol) -> f64) -> f64 {
        match &self.kind {
            ExprKind::Number(number) => *number,
            ExprKind::Symbol(symbol) => value(*symbol),
            ExprKind::Negate(a) => -a.evaluate(value),
            ExprKind::Binary(op, a, b) => op.apply(a.evaluate(value), b.evaluate(value)),
            ExprKind::Call(function, arguments) => {
                let argument = |i: usize| arguments.get(i).map_or(f64::NAN, |a| a.evaluate(value));
                function.apply(argument(0), || argument(1))
            }
        }
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
