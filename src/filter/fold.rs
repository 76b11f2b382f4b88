//! Expressions of columns that turn out equal in every row are constants, and what hangs on them is simplified once more.
//!
//! Columns by themselves are folded when they are registered; two that vary may still add up to one number, and a comparison of
//! columns may have one outcome.

use super::step::Traces;
use super::tracer::Tracer;
use crate::tape::{Calculator, Graph, Id, Node};
use std::collections::{BTreeSet, HashMap};

/// Folds a step over the rows of its kind.
pub(super) fn fold(t: &mut Tracer<'_>, kind: usize, step: &mut Traces) {
    let rows = t.columns.kinds.rows(kind, t.rows.len());
    let expressions = expressions(&t.g, &step.roots());
    let constants = unchanging(t, &expressions, rows);
    if constants.is_empty() {
        return;
    }
    let values: HashMap<Id, Id> = constants.into_iter().map(|(id, value)| (id, t.g.constant(value))).collect();
    let roots = step.roots();
    let folded = t.g.replaced(&roots, &values);
    step.replace(&folded);
}

/// The largest expressions of columns alone that a step reads.
fn expressions(g: &Graph, roots: &[Id]) -> Vec<Id> {
    let varying = g.reachable(roots, |id| !g.depends(id).is_uniform());
    let operands = varying.iter().flat_map(|id| g.operands(g.node(*id)).into_iter().flatten());
    let read: BTreeSet<Id> = operands.chain(roots.iter().copied()).collect();
    let is_expression = |id: &Id| {
        let depends = g.depends(*id);
        depends.is_uniform() && !depends.is_constant() && !matches!(g.node(*id), Node::Leaf(_))
    };
    read.into_iter().filter(is_expression).collect()
}

/// Those with one value in all rows. Most are known to vary after the second one.
fn unchanging(t: &Tracer<'_>, expressions: &[Id], rows: usize) -> Vec<(Id, f64)> {
    if expressions.is_empty() || rows == 0 {
        return vec![];
    }
    let mut calculator = Calculator::new(&t.g, expressions);
    let first = calculator.evaluate(|leaf| t.at(leaf, 0));
    let mut open: Vec<(Id, f64)> = expressions.iter().copied().zip(first).collect();
    for row in 1..rows {
        let mut values = calculator.evaluate(|leaf| t.at(leaf, row));
        let before = open.len();
        open.retain(|(_, first)| values.next().is_some_and(|value| value.to_bits() == first.to_bits()));
        drop(values);
        if open.is_empty() {
            break;
        }
        if open.len() < before {
            let ids: Vec<Id> = open.iter().map(|(id, _)| *id).collect();
            calculator = Calculator::new(&t.g, &ids);
        }
    }
    open
}
