//! Formula trees onto the graph.

use crate::model::{Binary, Expr, ExprKind, Parameters, Symbol, Value};
use crate::tape::{Graph, Id, Leaf};

/// What the symbols of a formula stand for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scope<'a> {
    pub(super) states: &'a [Id],
    pub(super) parameters: &'a [Id],
    pub(super) inputs: &'a [Id],
    pub(super) dt: Id,
}

/// The node of every parameter: searched ones are leaves, or the values of `candidate` where one is given.
pub(super) fn parameters(g: &mut Graph, parameters: &Parameters, candidate: Option<&[f64]>) -> Vec<Id> {
    let mut searched = 0u32;
    let mut ids: Vec<Option<Id>> = Vec::with_capacity(parameters.all.len());
    for parameter in &parameters.all {
        ids.push(match parameter.value {
            Value::Fixed(value) => Some(g.constant(value)),
            Value::Tied(_) => None,
            Value::Searched(_) => {
                searched += 1;
                Some(match candidate {
                    Some(values) => g.constant(values[searched as usize - 1]),
                    None => g.leaf(Leaf::Parameter(searched - 1)),
                })
            }
        });
    }
    let nan = g.constant(f64::NAN);
    let resolve = |(i, id): (usize, &Option<Id>)| match (id, &parameters.all[i].value) {
        (Some(id), _) => *id,
        (None, Value::Tied(to)) => ids[*to].unwrap_or(nan),
        (None, _) => nan,
    };
    ids.iter().enumerate().map(resolve).collect()
}

/// The node of a formula. Formulas are at most 10,000 characters long, which bounds the recursion.
pub(super) fn trace(g: &mut Graph, expr: &Expr, scope: Scope<'_>) -> Id {
    match &expr.kind {
        ExprKind::Number(value) => g.constant(*value),
        ExprKind::Symbol(Symbol::State(i)) => scope.states[*i],
        ExprKind::Symbol(Symbol::Parameter(i)) => scope.parameters[*i],
        ExprKind::Symbol(Symbol::Input(i)) => scope.inputs[*i],
        ExprKind::Symbol(Symbol::Dt) => scope.dt,
        ExprKind::Negate(a) => {
            let a = trace(g, a, scope);
            g.neg(a)
        }
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (trace(g, a, scope), trace(g, b, scope));
            match op {
                Binary::Add => g.add(a, b),
                Binary::Subtract => g.sub(a, b),
                Binary::Multiply => g.mul(a, b),
                Binary::Divide => g.div(a, b),
                Binary::Power => g.pow(a, b),
            }
        }
        ExprKind::Call(function, arguments) => {
            let arguments: Vec<Id> = arguments.iter().map(|a| trace(g, a, scope)).collect();
            g.call(*function, &arguments)
        }
    }
}

#[cfg(test)]
mod tests;
