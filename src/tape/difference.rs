//! Exact differences on the graph: how far every value moves when leaves move, computed from how far those move.
//!
//! f(a + alpha) - f(a) in f32 loses what `alpha` has beyond the digits of `a`. Here the delta of every operation is algebra on
//! the deltas of its operands, so that it keeps its own digits however small it is: D(a b) = alpha B + a beta,
//! D exp a = exp(a) expm1(alpha), D sin a = 2 cos(a + alpha/2) sin(alpha/2), and so on, a row for each operation in
//! [`super::operations`].

use super::codes::{Binary, Unary};
use super::graph::{Graph, Id, Leaf, Node};
use super::moved::Moved;
use std::collections::{HashMap, HashSet};

/// A sum or difference whose value may be its base plus its delta, or the sum of its operands' values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sum {
    /// Bases of its operands.
    pub operands: [Id; 2],
    /// Its own base.
    pub base: Id,
}

/// Where every value of some formulas is at one place, from which they may move again.
#[derive(Debug, Clone, Default)]
pub struct Centre {
    /// By the node of the formula.
    values: HashMap<Id, Id>,
    /// Sums whose value is where they started plus how far they moved.
    cancelling: HashSet<Id>,
}

/// What becomes of formulas when leaves move.
#[derive(Debug, Clone)]
pub struct Differences {
    /// One a root.
    pub roots: Vec<Moved>,
    /// Where the move ends.
    pub centre: Centre,
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
    pub fn difference(
        &mut self,
        roots: &[Id],
        moved: &HashMap<Leaf, Moved>,
        cancels: &mut dyn FnMut(&Self, Sum) -> bool,
    ) -> Differences {
        let mut found: HashMap<Id, Moved> = HashMap::new();
        let mut centre = Centre::default();
        for id in self.reachable(roots, |_| true) {
            let node = self.node(id);
            let of = match node {
                Node::Leaf(leaf) => moved.get(&leaf).copied().unwrap_or_else(|| Moved::still(self, id)),
                _ => {
                    let bases = self.operands(node).map(|operand| operand.map_or(id, |operand| found[&operand].base));
                    let base = self.rebuilt(node, bases);
                    match self.moving(node, &found) {
                        None => Moved::still(self, base),
                        Some(operands) => {
                            let sum = matches!(node, Node::Binary(Binary::Add | Binary::Subtract, ..));
                            let adds = sum && cancels(self, Sum { operands: [bases[0], bases[1]], base });
                            centre.cancelling.extend(adds.then_some(id));
                            self.moved_node(node, operands, base, adds)
                        }
                    }
                }
            };
            centre.values.insert(id, of.value);
            found.insert(id, of);
        }
        Differences { roots: roots.iter().map(|root| found[root]).collect(), centre }
    }

    /// The values of formulas with others in the place of leaves: plain substitution.
    pub fn centre(&mut self, roots: &[Id], by: &HashMap<Leaf, Id>) -> (Vec<Id>, Centre) {
        let mut values: HashMap<Id, Id> = HashMap::new();
        for id in self.reachable(roots, |_| true) {
            let value = match self.node(id) {
                Node::Leaf(leaf) => by.get(&leaf).copied().unwrap_or(id),
                node => {
                    let operands = self.operands(node).map(|operand| operand.map_or(id, |operand| values[&operand]));
                    self.rebuilt(node, operands)
                }
            };
            values.insert(id, value);
        }
        (roots.iter().map(|root| values[root]).collect(), Centre { values, cancelling: HashSet::new() })
    }

    /// How far formulas move from a centre when leaves move from there by `deltas`.
    ///
    /// # Panics
    /// If the centre is not one of these formulas.
    pub fn difference_from(&mut self, roots: &[Id], centre: &Centre, deltas: &HashMap<Leaf, Id>) -> Vec<Id> {
        let mut found: HashMap<Id, Moved> = HashMap::new();
        for id in self.reachable(roots, |_| true) {
            let (node, base) = (self.node(id), centre.values[&id]);
            let of = match node {
                Node::Leaf(leaf) => match deltas.get(&leaf) {
                    Some(delta) => Moved::by(self, base, *delta),
                    None => Moved::still(self, base),
                },
                _ => match self.moving(node, &found) {
                    None => Moved::still(self, base),
                    Some(operands) => self.moved_node(node, operands, base, centre.cancelling.contains(&id)),
                },
            };
            found.insert(id, of);
        }
        roots.iter().map(|root| found[root].delta).collect()
    }

    /// The operands of a node, where one of them moves.
    fn moving(&mut self, node: Node, found: &HashMap<Id, Moved>) -> Option<[Moved; 3]> {
        let operands = self.operands(node).map(|operand| operand.map(|operand| found[&operand]));
        let first = operands[0]?;
        if operands.iter().flatten().all(|a| self.is(a.delta, 0.0)) {
            return None;
        }
        Some(operands.map(|operand| operand.unwrap_or(first)))
    }

    /// A node whose operands move; where it `adds`, its value is its base and its delta.
    fn moved_node(&mut self, node: Node, [a, b, c]: [Moved; 3], base: Id, adds: bool) -> Moved {
        let value = self.rebuilt(node, [a.value, b.value, c.value]);
        let delta = match node {
            Node::Constant(_) | Node::Leaf(_) => a.delta,
            Node::Unary(op, _) => (op.row().difference)(self, a, [base, value]),
            Node::Binary(op, ..) => (op.row().difference)(self, [a, b], [base, value]),
            Node::Select { .. } => {
                let [then, otherwise] = self.chosen(a, [b, c], base);
                self.select(a.value, then, otherwise)
            }
        };
        if adds { Moved::by(self, base, delta) } else { Moved { base, delta, value } }
    }

    /// The deltas of both choices; where the condition moves, each may be taken in the other's place.
    fn chosen(&mut self, condition: Moved, choices: [Moved; 2], base: Id) -> [Id; 2] {
        if self.is(condition.delta, 0.0) {
            choices.map(|choice| choice.delta)
        } else {
            choices.map(|choice| self.crossing(choice, base))
        }
    }

    /// How far a choice is from `base`, which may be of the other one. Its own base then need not be a number, as of
    /// `if(x > 0, sqrt(x), 0)` that x enters from below: there it is value - base.
    fn crossing(&mut self, choice: Moved, base: Id) -> Id {
        let exact = choice.from(self, base);
        if !self.may_be_no_number(choice.base) {
            return exact;
        }
        // Above 0 where the base is finite.
        let (one, size) = (self.constant(1.0), self.unary(Unary::Abs, choice.base));
        let more = self.add(one, size);
        let inverse = self.div(one, more);
        let finite = self.unary(Unary::Positive, inverse);
        let apart = self.sub(choice.value, base);
        self.select(finite, exact, apart)
    }

    /// Whether an operation that finite operands can take out of its domain leads to a node.
    fn may_be_no_number(&self, id: Id) -> bool {
        self.reachable(&[id], |_| true).into_iter().any(|id| match self.node(id) {
            Node::Unary(op, _) => matches!(op, Unary::Sqrt | Unary::Ln | Unary::Log1p | Unary::Exp | Unary::Expm1),
            Node::Binary(op, ..) => matches!(op, Binary::Divide | Binary::Power),
            Node::Constant(bits) => !f64::from_bits(bits).is_finite(),
            _ => false,
        })
    }
}

#[cfg(test)]
mod tests;
