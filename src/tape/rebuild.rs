//! The same operations on other operands.

use super::graph::{Graph, Id, Node};
use std::collections::HashMap;

impl Graph {
    /// Nodes with others in the place of some that they are made of; what that makes simpler is simplified.
    pub fn replaced(&mut self, roots: &[Id], by: &HashMap<Id, Id>) -> Vec<Id> {
        let mut found: HashMap<Id, Id> = by.clone();
        for id in self.reachable(roots, |id| !by.contains_key(&id)) {
            if !found.contains_key(&id) {
                let operands =
                    self.operands(self.node(id)).map(|operand| operand.map_or(id, |operand| found[&operand]));
                let rebuilt = self.rebuilt(self.node(id), operands);
                found.insert(id, rebuilt);
            }
        }
        roots.iter().map(|root| found[root]).collect()
    }

    /// The same operation on other operands.
    pub(super) fn rebuilt(&mut self, node: Node, [a, b, c]: [Id; 3]) -> Id {
        match node {
            Node::Constant(_) | Node::Leaf(_) => a,
            Node::Unary(op, _) => self.simplified(op, a),
            Node::Binary(op, ..) => self.simplified_pair(op, a, b),
            Node::Select { .. } => self.select(a, b, c),
        }
    }
}
