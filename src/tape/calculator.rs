//! The graph itself as a machine: f64, one value a node.

use super::graph::{Graph, Id, Leaf, Node};

/// Evaluates fixed nodes of a graph in f64, again and again for other leaves.
#[derive(Debug)]
pub struct Calculator {
    program: Vec<(usize, Node)>,
    values: Vec<f64>,
    outputs: Vec<usize>,
}

impl Calculator {
    /// Prepares the evaluation of `outputs`.
    #[must_use]
    pub fn new(graph: &Graph, outputs: &[Id]) -> Self {
        let program: Vec<_> =
            graph.reachable(outputs, |_| true).into_iter().map(|id| (id.index(), graph.node(id))).collect();
        let size = program.last().map_or(0, |(i, _)| i + 1);
        Self { program, values: vec![0.0; size], outputs: outputs.iter().map(|id| id.index()).collect() }
    }

    /// The outputs, given every leaf.
    pub fn evaluate(&mut self, leaf: impl Fn(Leaf) -> f64) -> impl Iterator<Item = f64> + '_ {
        for &(i, node) in &self.program {
            let of = |id: Id| self.values[id.index()];
            self.values[i] = match node {
                Node::Constant(bits) => f64::from_bits(bits),
                Node::Leaf(l) => leaf(l),
                Node::Unary(op, a) => op.apply(of(a)),
                Node::Binary(op, a, b) => op.apply(of(a), of(b)),
                Node::Select { condition, then, otherwise } => {
                    if of(condition) > 0.0 {
                        of(then)
                    } else {
                        of(otherwise)
                    }
                }
            };
        }
        self.outputs.iter().map(|&i| self.values[i])
    }
}
