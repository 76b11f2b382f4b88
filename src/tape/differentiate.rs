//! Exact derivatives on the graph.

use super::graph::{Graph, Id, Leaf, Node};
use std::collections::HashMap;

impl Graph {
    /// The derivative of `y` with respect to a leaf, as a new node.
    pub fn differentiate(&mut self, y: Id, with_respect_to: Leaf) -> Id {
        let order = self.reachable(&[y], |_| true);
        let zero = self.constant(0.0);
        let mut derivative: HashMap<Id, Id> = HashMap::with_capacity(order.len());
        for id in order {
            let d = |operand: Id| derivative.get(&operand).copied().unwrap_or(zero);
            let dy = match self.node(id) {
                Node::Constant(_) => zero,
                Node::Leaf(leaf) => self.constant(f64::from(u8::from(leaf == with_respect_to))),
                Node::Unary(op, a) => {
                    let da = d(a);
                    if self.is(da, 0.0) { da } else { (op.row().derivative)(self, id, a, da) }
                }
                Node::Binary(op, a, b) => {
                    let (da, db) = (d(a), d(b));
                    let still = self.is(da, 0.0) && self.is(db, 0.0);
                    if still { da } else { (op.row().derivative)(self, id, [a, b], [da, db]) }
                }
                Node::Select { condition, then, otherwise } => {
                    let (then, otherwise) = (d(then), d(otherwise));
                    self.select(condition, then, otherwise)
                }
            };
            derivative.insert(id, dy);
        }
        derivative.get(&y).copied().unwrap_or(zero)
    }
}

#[cfg(test)]
mod tests {
    use super::super::calculator::Calculator;
    use super::super::codes::{Binary, Unary};
    use super::*;

    /// Every rule against a central difference.
    #[test]
    fn derivatives_equal_central_differences() {
        let mut g = Graph::default();
        let (x, y) = (g.leaf(Leaf::Variable(0)), g.leaf(Leaf::Variable(1)));
        let mut cases = Vec::new();
        for op in [
            Unary::Negate,
            Unary::Sqrt,
            Unary::Exp,
            Unary::Ln,
            Unary::Sin,
            Unary::Cos,
            Unary::Expm1,
            Unary::Log1p,
            Unary::Wrap,
            Unary::Abs,
            Unary::Positive,
        ] {
            let product = g.mul(x, y);
            cases.push(g.unary(op, product));
        }
        for op in [
            Binary::Add,
            Binary::Subtract,
            Binary::Multiply,
            Binary::Divide,
            Binary::Min,
            Binary::Max,
            Binary::Atan2,
            Binary::Power,
        ] {
            let square = g.mul(x, x);
            cases.push(g.binary(op, square, y));
        }
        let difference = g.sub(x, y);
        cases.push(g.select(difference, x, y));
        for (k, case) in cases.into_iter().enumerate() {
            let derivative = g.differentiate(case, Leaf::Variable(0));
            let mut f = Calculator::new(&g, &[case, derivative]);
            let mut at = |x: f64| {
                let mut out = f.evaluate(|l| if l == Leaf::Variable(0) { x } else { 1.3 });
                (out.next().unwrap(), out.next().unwrap())
            };
            let numeric = (at(0.7 + 1e-6).0 - at(0.7 - 1e-6).0) / 2e-6;
            assert!((numeric - at(0.7).1).abs() < 1e-8, "case {k}: {numeric} against {}", at(0.7).1);
        }
    }

    #[test]
    fn an_affine_formula_has_constant_derivatives() {
        let mut g = Graph::default();
        let (x, dt) = (g.leaf(Leaf::Variable(0)), g.leaf(Leaf::Column(0)));
        let product = g.mul(x, dt);
        let two = g.constant(2.0);
        let y = g.add(product, two);
        assert_eq!(g.differentiate(y, Leaf::Variable(0)), dt, "d(x dt + 2)/dx = dt");
        assert!(!g.depends(dt).has_variable(), "and it holds for every x");
    }
}
