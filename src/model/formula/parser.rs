//! Tokens to tree, by recursive descent.

use super::lexer::{Lexer, Token};
use super::scope::{Callee, Meaning, Scope, WORDS, callee};
use super::{MAX_DEPTH, MAX_LENGTH, MAX_NESTING};
use crate::model::error::{Cause, Fault};
use crate::model::{Binary, Expr, ExprKind, Logical, Span};

/// A subtree and its depth.
struct Tree {
    expr: Expr,
    depth: usize,
}

struct Parser<'a> {
    lexer: Lexer<'a>,
    token: Token<'a>,
    span: Span,
    nesting: usize,
    scope: Scope<'a>,
}

/// Parses one formula; spans are byte ranges of `text`.
pub(crate) fn parse(text: &str, scope: Scope<'_>) -> Result<Expr, Fault> {
    let length = text.chars().count();
    if length > MAX_LENGTH {
        let span = Span { start: 0, end: text.len() };
        return Err(Fault::new(span, Cause::FormulaTooLong { length, limit: MAX_LENGTH }));
    }
    let mut parser = Parser { lexer: Lexer::new(text), token: Token::End, span: Span::default(), nesting: 0, scope };
    parser.advance()?;
    let tree = parser.formula()?;
    match parser.token {
        Token::End => Ok(tree.expr),
        _ => Err(parser.unexpected("an operator")),
    }
}

impl<'a> Parser<'a> {
    /// Moves to the next token; returns the one left behind and its span.
    fn advance(&mut self) -> Result<(Token<'a>, Span), Fault> {
        let left = (self.token, self.span);
        (self.token, self.span) = self.lexer.next()?;
        Ok(left)
    }

    fn unexpected(&self, expected: &'static str) -> Fault {
        let cause = match self.token {
            Token::End => Cause::UnexpectedEnd { expected },
            token => Cause::Syntax { found: token.describe(), expected },
        };
        Fault::new(self.span, cause)
    }

    /// Runs `inner` one level deeper.
    fn nested(&mut self, inner: impl FnOnce(&mut Self) -> Result<Tree, Fault>) -> Result<Tree, Fault> {
        if self.nesting == MAX_NESTING {
            return Err(Fault::new(self.span, Cause::FormulaTooDeep { limit: MAX_NESTING }));
        }
        self.nesting += 1;
        let tree = inner(self);
        self.nesting -= 1;
        tree
    }

    fn formula(&mut self) -> Result<Tree, Fault> {
        self.joined("or", Logical::Or, Self::conjunction)
    }

    fn conjunction(&mut self) -> Result<Tree, Fault> {
        self.joined("and", Logical::And, Self::negation)
    }

    /// `part { word part }`.
    fn joined(
        &mut self,
        word: &str,
        op: Logical,
        part: impl Fn(&mut Self) -> Result<Tree, Fault>,
    ) -> Result<Tree, Fault> {
        let mut left = part(self)?;
        while self.token == Token::Name(word) {
            let (_, at) = self.advance()?;
            let right = part(self)?;
            left = pair(at, left, right, |a, b| ExprKind::Logical(op, a, b))?;
        }
        Ok(left)
    }

    /// `not a` is `a <= 0`.
    fn negation(&mut self) -> Result<Tree, Fault> {
        if self.token != Token::Name("not") {
            return self.comparison();
        }
        self.nested(|p| {
            let (_, at) = p.advance()?;
            let inner = p.negation()?;
            let end = inner.expr.span.end;
            let mut tree = pair(at, inner, leaf(ExprKind::Number(0.0), at), |a, zero| {
                ExprKind::Logical(Logical::LessOrEqual, a, zero)
            })?;
            tree.expr.span = Span { start: at.start, end };
            Ok(tree)
        })
    }

    fn comparison(&mut self) -> Result<Tree, Fault> {
        let left = self.sum()?;
        let Token::Comparison(op) = self.token else { return Ok(left) };
        let (_, at) = self.advance()?;
        let right = self.sum()?;
        if let Token::Comparison(_) = self.token {
            return Err(Fault::new(self.span, Cause::ComparisonChain));
        }
        pair(at, left, right, |a, b| ExprKind::Logical(op, a, b))
    }

    fn sum(&mut self) -> Result<Tree, Fault> {
        let mut left = self.product()?;
        while let Token::Operator(op @ (Binary::Add | Binary::Subtract)) = self.token {
            let (_, at) = self.advance()?;
            let right = self.product()?;
            left = binary(op, at, left, right)?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Tree, Fault> {
        let mut left = self.signed()?;
        while let Token::Operator(op @ (Binary::Multiply | Binary::Divide)) = self.token {
            let (_, at) = self.advance()?;
            let right = self.signed()?;
            left = binary(op, at, left, right)?;
        }
        Ok(left)
    }

    fn signed(&mut self) -> Result<Tree, Fault> {
        match self.token {
            Token::Operator(Binary::Subtract) => self.nested(|p| {
                let (_, at) = p.advance()?;
                let Tree { expr, depth } = p.signed()?;
                let span = Span { start: at.start, end: expr.span.end };
                above(at, depth, Expr { kind: ExprKind::Negate(Box::new(expr)), span })
            }),
            Token::Operator(Binary::Add) => self.nested(|p| {
                p.advance()?;
                p.signed()
            }),
            _ => self.power(),
        }
    }

    fn power(&mut self) -> Result<Tree, Fault> {
        let base = self.atom()?;
        let Token::Operator(Binary::Power) = self.token else { return Ok(base) };
        let (_, at) = self.advance()?;
        let exponent = self.nested(Self::signed)?;
        binary(Binary::Power, at, base, exponent)
    }

    fn atom(&mut self) -> Result<Tree, Fault> {
        match self.token {
            Token::Number(value) => {
                let (_, span) = self.advance()?;
                Ok(leaf(ExprKind::Number(value), span))
            }
            Token::Name(name) => {
                if WORDS.contains(&name) {
                    return Err(self.unexpected("a number, a name or `(`"));
                }
                let (_, span) = self.advance()?;
                match self.token {
                    Token::Open => self.nested(|p| p.call(name, span)),
                    _ => self.name(name, span),
                }
            }
            Token::Open => self.nested(Self::parenthesis),
            _ => Err(self.unexpected("a number, a name or `(`")),
        }
    }

    fn name(&self, name: &str, span: Span) -> Result<Tree, Fault> {
        if name == "pi" {
            return Ok(leaf(ExprKind::Number(std::f64::consts::PI), span));
        }
        Ok(match self.scope.resolve(name, span)? {
            Meaning::Symbol(symbol) => leaf(ExprKind::Symbol(symbol), span),
            Meaning::Let(found) => {
                let mut expr = found.formula.clone();
                expr.map_spans(&|_| span);
                Tree { expr, depth: found.depth }
            }
        })
    }

    /// `( formula )`; the tree's span takes the parentheses in.
    fn parenthesis(&mut self) -> Result<Tree, Fault> {
        let (_, open) = self.advance()?;
        let mut tree = self.formula()?;
        let close = self.close("`)` or an operator")?;
        tree.expr.span = Span { start: open.start, end: close.end };
        Ok(tree)
    }

    fn close(&mut self, expected: &'static str) -> Result<Span, Fault> {
        match self.token {
            Token::Close => Ok(self.advance()?.1),
            _ => Err(self.unexpected(expected)),
        }
    }

    fn call(&mut self, name: &str, at: Span) -> Result<Tree, Fault> {
        let callee = callee(name, at)?;
        self.advance()?;
        if callee == Callee::Table {
            return self.table(at);
        }
        let (arguments, depth) = self.arguments()?;
        let span = Span { start: at.start, end: self.close("`)`")?.end };
        let (expected, found) = (callee.arity(), arguments.len());
        let refused = || Fault::new(span, Cause::ArgumentCount { name: name.to_owned(), expected, found });
        let kind = match callee {
            Callee::If => ExprKind::If(Box::new(arguments.try_into().map_err(|_| refused())?)),
            Callee::Function(function) if found == expected => ExprKind::Call(function, arguments),
            Callee::Function(_) | Callee::Table => return Err(refused()),
        };
        above(at, depth, Expr { kind, span })
    }

    /// `"file", formula)`.
    fn table(&mut self, at: Span) -> Result<Tree, Fault> {
        let Token::Text(file) = self.token else { return Err(self.unexpected("a file's name in quotes")) };
        let (_, named) = self.advance()?;
        let curve = self.scope.names.table(file, named)?;
        match self.token {
            Token::Comma => self.advance()?,
            _ => return Err(self.unexpected("`,` and where to look it up")),
        };
        let Tree { expr, depth } = self.formula()?;
        let span = Span { start: at.start, end: self.close("`)` or an operator")?.end };
        above(at, depth, Expr { kind: ExprKind::Table(curve, Box::new(expr)), span })
    }

    /// Arguments up to the closing parenthesis, and the depth of the deepest.
    fn arguments(&mut self) -> Result<(Vec<Expr>, usize), Fault> {
        let (mut arguments, mut depth) = (Vec::new(), 0);
        while self.token != Token::Close {
            if !arguments.is_empty() {
                match self.token {
                    Token::Comma => self.advance()?,
                    _ => return Err(self.unexpected("`,`, `)` or an operator")),
                };
            }
            let argument = self.formula()?;
            depth = depth.max(argument.depth);
            arguments.push(argument.expr);
        }
        Ok((arguments, depth))
    }
}

const fn leaf(kind: ExprKind, span: Span) -> Tree {
    Tree { expr: Expr { kind, span }, depth: 1 }
}

fn binary(op: Binary, at: Span, left: Tree, right: Tree) -> Result<Tree, Fault> {
    pair(at, left, right, |a, b| ExprKind::Binary(op, a, b))
}

/// `left op right`, an operator at `at`.
fn pair(at: Span, left: Tree, right: Tree, kind: impl FnOnce(Box<Expr>, Box<Expr>) -> ExprKind) -> Result<Tree, Fault> {
    let depth = left.depth.max(right.depth);
    let span = Span { start: left.expr.span.start, end: right.expr.span.end };
    let kind = kind(Box::new(left.expr), Box::new(right.expr));
    above(at, depth, Expr { kind, span })
}

/// A node whose operands are `below` deep, unless the tree grows too deep to recurse over: then an error at `at`.
fn above(at: Span, below: usize, expr: Expr) -> Result<Tree, Fault> {
    if below >= MAX_DEPTH {
        return Err(Fault::new(at, Cause::FormulaChain { limit: MAX_DEPTH }));
    }
    Ok(Tree { expr, depth: below + 1 })
}
