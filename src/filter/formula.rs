//! Formula trees onto the graph.

mod curve;

use crate::model::{Binary, Expr, ExprKind, Logical, Parameters, Symbol, Value};
use crate::tape::{Graph, Id, Leaf, Unary};

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
        ExprKind::Logical(..) => {
            let [holds, fails] = [1.0, 0.0].map(|value| g.constant(value));
            choose(g, expr, [holds, fails], scope)
        }
        ExprKind::If(operands) => {
            let [condition, a, b] = operands.as_ref();
            let choices = [a, b].map(|branch| trace(g, branch, scope));
            choose(g, condition, choices, scope)
        }
        ExprKind::Table(table, a) => {
            let a = trace(g, a, scope);
            curve::trace(g, table, a)
        }
        ExprKind::Call(function, arguments) => {
            let arguments: Vec<Id> = arguments.iter().map(|a| trace(g, a, scope)).collect();
            g.call(*function, &arguments)
        }
    }
}

/// The first choice where a condition is above 0, else the second: one select a comparison, by the sign of a difference.
fn choose(g: &mut Graph, condition: &Expr, [then, otherwise]: [Id; 2], scope: Scope<'_>) -> Id {
    let ExprKind::Logical(op, a, b) = &condition.kind else {
        let condition = trace(g, condition, scope);
        return g.select(condition, then, otherwise);
    };
    match op {
        Logical::And => {
            let second = choose(g, b, [then, otherwise], scope);
            return choose(g, a, [second, otherwise], scope);
        }
        Logical::Or => {
            let second = choose(g, b, [then, otherwise], scope);
            return choose(g, a, [then, second], scope);
        }
        _ => {}
    }
    let (a, b) = (trace(g, a, scope), trace(g, b, scope));
    match op {
        Logical::Less | Logical::GreaterOrEqual => {
            let below = g.sub(b, a);
            let [then, otherwise] = if *op == Logical::Less { [then, otherwise] } else { [otherwise, then] };
            g.select(below, then, otherwise)
        }
        Logical::Greater | Logical::LessOrEqual => {
            let above = g.sub(a, b);
            let [then, otherwise] = if *op == Logical::Greater { [then, otherwise] } else { [otherwise, then] };
            g.select(above, then, otherwise)
        }
        _ => {
            let apart = g.sub(a, b);
            let apart = g.unary(Unary::Abs, apart);
            let [then, otherwise] = if *op == Logical::NotEqual { [then, otherwise] } else { [otherwise, then] };
            g.select(apart, then, otherwise)
        }
    }
}

#[cfg(test)]
mod tests;
