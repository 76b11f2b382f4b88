//! From nodes to operations: pairs fused, and the order in which they run.

use super::codes::{Binary, Unary};
use super::graph::{Graph, Id, Node};
use super::straight_line::Code;
use std::collections::{HashMap, HashSet};

/// An operation before registers are known.
pub(super) struct Term {
    pub(super) code: Code,
    pub(super) operands: Vec<Id>,
}

/// The operations to schedule, by the node they compute.
pub(super) struct Terms {
    pub(super) of: HashMap<Id, Term>,
}

impl Terms {
    /// One term a node; a product used once, by a sum or difference, becomes part of it.
    pub(super) fn fuse(graph: &Graph, nodes: &[Id], roots: &[Id]) -> Self {
        let mut uses: HashMap<Id, usize> = HashMap::new();
        let operands = nodes.iter().flat_map(|id| graph.operands(graph.node(*id)).into_iter().flatten());
        for id in operands.chain(roots.iter().copied()) {
            *uses.entry(id).or_default() += 1;
        }
        let inner = Inner { graph, members: nodes.iter().copied().collect(), uses };
        let mut absorbed = HashSet::new();
        let mut of = HashMap::new();
        for &id in nodes {
            let term = match graph.node(id) {
                Node::Leaf(_) | Node::Constant(_) => continue,
                Node::Unary(op, a) => Term { code: Code::Unary(op), operands: vec![a] },
                Node::Select { condition, then, otherwise } => {
                    Term { code: Code::Select, operands: vec![condition, then, otherwise] }
                }
                Node::Binary(op, a, b) => {
                    let (term, gone) = inner.fuse(op, a, b);
                    absorbed.extend(gone);
                    term
                }
            };
            of.insert(id, term);
        }
        of.retain(|id, _| !absorbed.contains(id));
        let mut terms = Self { of };
        terms.fuse_dots(nodes, |id| inner.used_once(id));
        terms
    }

    /// A product or sum of products used once, by another sum of products, becomes part of it: two values fewer a pair
    /// travel through memory. Operands come before their users in `nodes`, so chains pair up from their beginning.
    fn fuse_dots(&mut self, nodes: &[Id], used_once: impl Fn(Id) -> bool) {
        for id in nodes {
            let Some(Term { code: Code::MultiplyAdd, operands }) = self.of.get(id) else { continue };
            let [c, d, inner] = [operands[0], operands[1], operands[2]];
            let Some(term) = self.of.get(&inner).filter(|_| used_once(inner)) else { continue };
            let code = match term.code {
                Code::Binary(Binary::Multiply) => Code::Dot,
                Code::MultiplyAdd => Code::DotAdd,
                _ => continue,
            };
            let operands = [&term.operands[..2], &[c, d], &term.operands[2..]].concat();
            self.of.remove(&inner);
            self.of.insert(*id, Term { code, operands });
        }
    }

    /// Depth-first from the outputs, operands first: values are made shortly before they are used.
    pub(super) fn order(&self, roots: &[Id]) -> Vec<Id> {
        let mut done = HashSet::new();
        let mut order = Vec::with_capacity(self.of.len());
        let mut stack: Vec<(Id, bool)> = roots.iter().rev().map(|id| (*id, false)).collect();
        while let Some((id, operands_done)) = stack.pop() {
            let Some(term) = self.of.get(&id) else { continue };
            if operands_done {
                order.push(id);
            } else if done.insert(id) {
                stack.push((id, true));
                stack.extend(term.operands.iter().rev().map(|o| (*o, false)));
            }
        }
        order
    }
}

/// Finds operations that are used once and may become part of their user.
struct Inner<'a> {
    graph: &'a Graph,
    members: HashSet<Id>,
    uses: HashMap<Id, usize>,
}

impl Inner<'_> {
    fn used_once(&self, id: Id) -> bool {
        self.members.contains(&id) && self.uses.get(&id) == Some(&1)
    }

    fn product(&self, id: Id) -> Option<[Id; 2]> {
        match self.graph.node(id) {
            Node::Binary(Binary::Multiply, a, b) if self.used_once(id) => Some([a, b]),
            _ => None,
        }
    }

    fn positive(&self, id: Id) -> Option<Id> {
        match self.graph.node(id) {
            Node::Unary(Unary::Positive, a) if self.used_once(id) => Some(a),
            _ => None,
        }
    }

    /// The term of `a op b`, and the operand that it swallows.
    fn fuse(&self, op: Binary, a: Id, b: Id) -> (Term, Option<Id>) {
        let term = |code, operands: &[Id], gone| (Term { code, operands: operands.to_vec() }, Some(gone));
        match op {
            Binary::Add | Binary::Subtract => {
                let swap = if op == Binary::Add { Code::MultiplyAdd } else { Code::SubtractProduct };
                let keep = if op == Binary::Add { Code::MultiplyAdd } else { Code::MultiplySubtract };
                match (self.product(a), self.product(b)) {
                    (_, Some([x, y])) => return term(swap, &[x, y, a], b),
                    (Some([x, y]), _) => return term(keep, &[x, y, b], a),
                    _ => {}
                }
            }
            Binary::Multiply => match (self.positive(a), self.positive(b)) {
                (_, Some(x)) => return term(Code::MultiplyPositive, &[a, x], b),
                (Some(x), _) => return term(Code::MultiplyPositive, &[b, x], a),
                _ => {}
            },
            _ => {}
        }
        (Term { code: Code::Binary(op), operands: vec![a, b] }, None)
    }
}
