//! Which names a formula may use, and what they mean.

use crate::model::error::{Cause, Fault, nearest};
use crate::model::{Function, Span, Symbol};
use crate::words::shorten;

/// Every name of a problem.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    pub(crate) states: Vec<String>,
    pub(crate) parameters: Vec<String>,
    pub(crate) inputs: Vec<String>,
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
            Symbol::State(_) | Symbol::Input(_) => matches!(self, Self::Transition | Self::Measurement),
            Symbol::Dt => matches!(self, Self::Transition | Self::ProcessNoise),
        }
    }

    const fn allowed(self) -> &'static str {
        match self {
            Self::Transition => "states, inputs, parameters and dt",
            Self::Measurement => "states, inputs and parameters",
            Self::ProcessNoise => "parameters and dt",
            Self::Constant => "parameters",
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
}

impl Scope<'_> {
    /// What `name` means here.
    pub(super) fn resolve(&self, name: &str, span: Span) -> Result<Symbol, Fault> {
        let Some(symbol) = self.names.find(name) else { return Err(self.unknown(name, span)) };
        if self.place.allows(symbol) {
            return Ok(symbol);
        }
        let what = match symbol {
            Symbol::State(_) => "the state",
            Symbol::Parameter(_) => "the parameter",
            Symbol::Input(_) => "the input",
            Symbol::Dt => "the interval",
        };
        let (name, key) = (name.to_owned(), self.key.to_owned());
        Err(Fault::new(span, Cause::NotAllowed { what, name, key, allowed: self.place.allowed() }))
    }

    /// The error for a name that nothing has; a suggestion is drawn from what may stand here.
    fn unknown(&self, name: &str, span: Span) -> Fault {
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
}

impl Callee {
    pub(super) const fn arity(self) -> usize {
        match self {
            Self::Function(function) => function.arity(),
            Self::If => 3,
        }
    }
}

/// Everything that can be called, by name.
fn callees() -> impl Iterator<Item = (&'static str, Callee)> {
    let functions = Function::ALL.iter().map(|(name, function)| (*name, Callee::Function(*function)));
    functions.chain([("if", Callee::If)])
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
