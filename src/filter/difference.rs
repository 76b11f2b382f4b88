//! How far formulas move from the nominal: by a candidate's parameters, and by its states.

use super::carried::narrow;
use super::tracer::Tracer;
use crate::tape::{Calculator, Differences, Graph, Id, Leaf, Moved, Sum};
use std::collections::HashMap;

/// For formulas of free variables what becomes of them when the states move as `x` says and the parameters from `candidate`.
pub(super) fn around(t: &mut Tracer<'_>, formulas: &[Id], x: &[Moved], candidate: &[f64]) -> Differences {
    let mut leaves = HashMap::new();
    for (j, x) in x.iter().enumerate() {
        leaves.insert(Leaf::Variable(narrow(j)), *x);
    }
    for (p, base) in candidate.iter().enumerate() {
        let leaf = Leaf::Parameter(narrow(p));
        let (value, base) = (t.g.leaf(leaf), t.g.constant(*base));
        // An invariant: the prologue takes it in f64.
        let delta = t.g.sub(value, base);
        leaves.insert(leaf, Moved { base, delta, value });
    }
    let (columns, rows) = (&*t.columns, t.columns.rows(t.rows.len()));
    let value = |leaf, row| match leaf {
        Leaf::Column(column) => columns.value(column, row),
        _ => f64::NAN,
    };
    t.g.difference(formulas, &leaves, &mut |g, sum| cancels(g, sum, rows, &value))
}

/// Whether a sum is far smaller than its operands in some of the rows, so that rounded operands would leave it few digits.
fn cancels(g: &Graph, sum: Sum, rows: usize, value: &dyn Fn(Leaf, usize) -> f64) -> bool {
    /// Operand over sum from which digits are counted as lost.
    const LOSS: f64 = 4.0;
    /// Share of the rows in which that has to be so.
    const SHARE: f64 = 0.02;
    let [a, b] = sum.operands;
    let mut calculator = Calculator::new(g, &[a, b, sum.base]);
    // A base that is no number, of a branch that the nominal does not take there, would make the value none.
    let mut numbers = 0;
    let cancels = |row: &usize| {
        let values: Vec<f64> = calculator.evaluate(|leaf| value(leaf, *row)).map(f64::abs).collect();
        numbers += usize::from(!values[2].is_nan());
        values[0].max(values[1]) > LOSS * values[2]
    };
    #[expect(clippy::cast_precision_loss, reason = "counts of rows stay far below 2^53")]
    let lost = (0..rows).filter(cancels).count() as f64;
    numbers == rows && lost > SHARE * rows as f64
}
