//! Which names a formula may use, and what they mean.

use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::sync::Arc;

use super::table;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::{Curve, Expr, Function, Span, Symbol};
use crate::words::shorten;

/// Nodes that the names of `[model.let]` may stand for, all their uses together.
const MAX_EXPANDED: usize = 200_000;

/// Every name of a problem.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    pub(crate) states: Vec<String>,
    pub(crate) parameters: Vec<String>,
    pub(crate) inputs: Vec<String>,
    /// Of `[model.let]`: those read so far.
    pub(crate) lets: Vec<Let>,
    /// Names of `[model.let]` still to come, the one that is being read first.
    pub(crate) coming: Vec<String>,
    /// Nodes that they stand for where they were used so far.
    pub(crate) expanded: Cell<usize>,
    /// The folder that files of tables are relative to, and what was read from there.
    pub(crate) folder: PathBuf,
    pub(crate) tables: RefCell<Vec<Arc<Curve>>>,
}

/// A name of `[model.let]` and the formula that it stands for, earlier names in it already replaced.
#[derive(Debug, Clone)]
pub(crate) struct Let {
    pub(crate) name: String,
    pub(crate) formula: Expr,
    /// Nodes, and how many of them lie above each other.
    pub(crate) size: usize,
    pub(crate) depth: usize,
}

/// What a name stands for.
pub(super) enum Meaning<'a> {
    Symbol(Symbol),
    Let(&'a Let),
}

/// The kind of formula, which decides what may stand in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// States, inputs, parameters and dt.
    Transition,
    /// States, inputs and parameters.
    Measurement,
    /// Parameters and dt.
    ProcessNoise,
    /// Parameters.
    Constant,
    /// Inputs and parameters.
    Condition,
    /// Everything: where it is used decides.
    Let,
}

/// The names, the kind of formula and the key it stands under.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scope<'a> {
    pub(crate) names: &'a Names,
    pub(crate) place: Place,
    pub(crate) key: &'a str,
}

impl Place {
    const fn allows(self, symbol: Symbol) -> bool {
        match symbol {
            Symbol::Parameter(_) => true,
            Symbol::State(_) => matches!(self, Self::Transition | Self::Measurement | Self::Let),
            Symbol::Input(_) => matches!(self, Self::Transition | Self::Measurement | Self::Condition | Self::Let),
            Symbol::Dt => matches!(self, Self::Transition | Self::ProcessNoise | Self::Let),
        }
    }

    const fn allowed(self) -> &'static str {
        match self {
            Self::Transition => "states, inputs, parameters and dt",
            Self::Measurement => "states, inputs and parameters",
            Self::ProcessNoise => "parameters and dt",
            Self::Constant => "parameters",
            Self::Condition => "inputs and parameters",
            Self::Let => "states, inputs, parameters, dt and the names above it",
        }
    }
}

impl Names {
    fn find(&self, name: &str) -> Option<Symbol> {
        let index = |list: &[String]| list.iter().position(|n| n == name);
        if name == "dt" {
            return Some(Symbol::Dt);
        }
        index(&self.states)
            .map(Symbol::State)
            .or_else(|| index(&self.parameters).map(Symbol::Parameter))
            .or_else(|| index(&self.inputs).map(Symbol::Input))
    }

    /// The curve of a file, read where it is first asked for.
    pub(super) fn table(&self, file: &str, span: Span) -> Result<Arc<Curve>, Fault> {
        let mut tables = self.tables.borrow_mut();
        if let Some(known) = tables.iter().find(|curve| curve.file() == file) {
            return Ok(Arc::clone(known));
        }
        let curve = Arc::new(table::read(&self.folder, file, span)?);
        tables.push(Arc::clone(&curve));
        Ok(curve)
    }

    /// What messages call a symbol.
    fn described(&self, symbol: Symbol) -> (&'static str, String) {
        let of = |names: &[String], i: usize| names.get(i).cloned().unwrap_or_default();
        match symbol {
            Symbol::State(i) => ("the state", of(&self.states, i)),
            Symbol::Parameter(i) => ("the parameter", of(&self.parameters, i)),
            Symbol::Input(i) => ("the input", of(&self.inputs, i)),
            Symbol::Dt => ("the interval", "dt".to_owned()),
        }
    }
}

impl<'a> Scope<'a> {
    /// What `name` means here.
    pub(super) fn resolve(&self, name: &str, span: Span) -> Result<Meaning<'a>, Fault> {
        if let Some(found) = self.names.lets.iter().find(|known| known.name == name) {
            self.check_let(found, span)?;
            return Ok(Meaning::Let(found));
        }
        let Some(symbol) = self.names.find(name) else { return Err(self.unknown(name, span)) };
        if self.place.allows(symbol) {
            return Ok(Meaning::Symbol(symbol));
        }
        let (what, name) = self.names.described(symbol);
        let key = self.key.to_owned();
        Err(Fault::new(span, Cause::NotAllowed { what, name, key, allowed: self.place.allowed() }))
    }

    /// Whether all that a name of `[model.let]` stands for may stand here, and not too much of it.
    fn check_let(&self, found: &Let, span: Span) -> Result<(), Fault> {
        let mut refused = None;
        found.formula.symbols(&mut |symbol| {
            if !self.place.allows(symbol) && refused.is_none() {
                refused = Some(symbol);
            }
        });
        if let Some(symbol) = refused {
            let (what, name) = self.names.described(symbol);
            let (through, key) = (found.name.clone(), self.key.to_owned());
            return Err(Fault::new(
                span,
                Cause::NotAllowedThrough { what, name, through, key, allowed: self.place.allowed() },
            ));
        }
        let expanded = self.names.expanded.get() + found.size;
        self.names.expanded.set(expanded);
        if expanded > MAX_EXPANDED {
            return Err(Fault::new(span, Cause::LetTooLarge { name: found.name.clone(), limit: MAX_EXPANDED }));
        }
        Ok(())
    }

    /// The error for a name that nothing has; a suggestion is drawn from what may stand here.
    fn unknown(&self, name: &str, span: Span) -> Fault {
        match self.names.coming.iter().position(|coming| coming == name) {
            Some(0) => return Fault::new(span, Cause::LetOfItself { name: name.to_owned() }),
            Some(_) => return Fault::new(span, Cause::LetLater { name: name.to_owned() }),
            None => {}
        }
        let mut known: Vec<String> = Vec::new();
        if self.place.allows(Symbol::State(0)) {
            known.extend_from_slice(&self.names.states);
        }
        known.extend_from_slice(&self.names.parameters);
        if self.place.allows(Symbol::Input(0)) {
            known.extend_from_slice(&self.names.inputs);
        }
        if self.place.allows(Symbol::Dt) {
            known.push("dt".to_owned());
        }
        known.extend(self.names.lets.iter().map(|known| known.name.clone()));
        known.push("pi".to_owned());
        let nearest = nearest(name, known.iter().map(String::as_str));
        let name = shorten(name);
        Fault::new(span, Cause::UnknownName { name, nearest, known })
    }
}

/// Whether formulas can use `name`: letters, digits, underscores, not starting with a digit.
pub(crate) fn is_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && characters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Words with a meaning of their own between operands.
pub(super) const WORDS: [&str; 3] = ["and", "or", "not"];

/// What stands before parentheses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Callee {
    Function(Function),
    If,
    Table,
}

impl Callee {
    pub(super) const fn arity(self) -> usize {
        match self {
            Self::Function(function) => function.arity(),
            Self::If => 3,
            Self::Table => 2,
        }
    }
}

/// Everything that can be called, by name.
fn callees() -> impl Iterator<Item = (&'static str, Callee)> {
    let functions = Function::ALL.iter().map(|(name, function)| (*name, Callee::Function(*function)));
    functions.chain([("if", Callee::If), ("table", Callee::Table)])
}

/// What a name that formulas already give a meaning is; `None` for any other.
pub(crate) fn reserved(name: &str) -> Option<&'static str> {
    match name {
        "dt" => Some("the interval to the next row"),
        "pi" => Some("the circle constant"),
        _ if WORDS.contains(&name) => Some("an operator"),
        _ => callees().any(|(known, _)| known == name).then_some("a function"),
    }
}

/// What is called `name`.
pub(super) fn callee(name: &str, span: Span) -> Result<Callee, Fault> {
    let names = || callees().map(|(known, _)| known);
    callees().find(|(known, _)| *known == name).map(|(_, callee)| callee).ok_or_else(|| {
        let nearest = nearest(name, names());
        let known = names().map(str::to_owned).collect();
        Fault::new(span, Cause::UnknownFunction { name: shorten(name), nearest, known })
    })
}
