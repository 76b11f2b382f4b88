//! Exact differences on the graph: how far every value moves when leaves move, computed from how far those move.
//!
//! f(a + alpha) - f(a) in f32 loses what `alpha` has beyond the digits of `a`. Here the delta of every operation is algebra on
//! the deltas of its operands, so that it keeps its own digits however small it is: D(a b) = alpha B + a beta,
//! D exp a = exp(a) expm1(alpha), D sin a = 2 cos(a + alpha/2) sin(alpha/2), and so on, a row for each operation in
//! [`super::operations`].

use super::codes::Binary;
use super::graph::{Graph, Id, Leaf, Node};
use super::moved::Moved;
use std::collections::HashMap;

/// A sum or difference whose value may be its base plus its delta, or the sum of its operands' values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sum {
    /// Bases of its operands.
    pub operands: [Id; 2],
    /// Its own base.
    pub base: Id,
}

impl Graph {
    /// Moves leaves, and follows what becomes of `roots`: one [`Moved`] a root.
    ///
    /// - `moved` tells of every leaf that moves where it starts, by how much it moves, and its value (which for a parameter is
    ///   best the leaf itself, for a state the sum: [`Moved::by`]). Leaves that it lacks stay where they are; so does
    ///   what depends on them alone, with the constant 0 as delta.
    /// - Bases are the formulas of the bases. Deltas are computed from deltas and never as a difference of nearby values. An
    ///   angle (`atan2`) is right but for whole turns.
    /// - Values are the formulas of the values, which needs no base; but a sum for which `cancels` holds has base + delta
    ///   instead: where bases of the size 1e6 leave a difference of the size 1, the sum of their rounded values would lose six
    ///   digits. `cancels` is asked once a moving sum; a caller answers from the numbers of its nominal, for instance whether
    ///   max(|a|, |b|) > 4 |a + b| in some rows. Fewer such sums means fewer bases to provide (a column each).
    ///
    /// With 0 as base and the new node as delta (`Moved::by`), and `cancels` never true, the values are plain substitution.
    pub fn difference(
        &mut self,
        roots: &[Id],
        moved: &HashMap<Leaf, Moved>,
        cancels: &mut dyn FnMut(&Self, Sum) -> bool,
    ) -> Vec<Moved> {
        let mut found: HashMap<Id, Moved> = HashMap::new();
        for id in self.reachable(roots, |_| true) {
            let operands = self.operands(self.node(id)).map(|operand| operand.map(|operand| found[&operand]));
            let of = match self.node(id) {
                Node::Leaf(leaf) => moved.get(&leaf).copied().unwrap_or_else(|| Moved::still(self, id)),
                _ if operands.iter().flatten().all(|a| self.is(a.delta, 0.0)) => Moved::still(self, id),
                node => {
                    let none = Moved::still(self, id);
                    self.moved_node(node, operands.map(|operand| operand.unwrap_or(none)), cancels)
                }
            };
            found.insert(id, of);
        }
        roots.iter().map(|root| found[root]).collect()
    }

    fn moved_node(&mut self, node: Node, [a, b, c]: [Moved; 3], cancels: &mut dyn FnMut(&Self, Sum) -> bool) -> Moved {
        let [base, value] = [[a.base, b.base, c.base], [a.value, b.value, c.value]].map(|of| self.rebuilt(node, of));
        let delta = match node {
            Node::Constant(_) | Node::Leaf(_) => a.delta,
            Node::Unary(op, _) => (op.row().difference)(self, a, [base, value]),
            Node::Binary(op, ..) => (op.row().difference)(self, [a, b], [base, value]),
            Node::Select { .. } => {
                let [then, otherwise] = self.chosen(a, [b, c], base);
                self.select(a.value, then, otherwise)
            }
        };
        let sum = matches!(node, Node::Binary(Binary::Add | Binary::Subtract, ..));
        if sum && cancels(self, Sum { operands: [a.base, b.base], base }) {
            return Moved::by(self, base, delta);
        }
        Moved { base, delta, value }
    }

    /// The deltas of both choices; where the condition moves, each may be taken in the other's place.
    fn chosen(&mut self, condition: Moved, choices: [Moved; 2], base: Id) -> [Id; 2] {
        if self.is(condition.delta, 0.0) { choices.map(|c| c.delta) } else { choices.map(|c| c.from(self, base)) }
    }
}

#[cfg(test)]
mod tests;
