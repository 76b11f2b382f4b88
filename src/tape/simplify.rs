//! Building nodes with what algebra gives for free: neutral elements, zeros, signs, constants.
//!
//! `0 * x = 0` assumes that x is finite; a candidate for which it is not has failed anyway.

use super::codes::{Binary, Unary};
use super::graph::{Graph, Id, Node};

impl Graph {
    /// `a + b`.
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        match (self.node(a), self.node(b)) {
            _ if self.is(a, 0.0) => b,
            _ if self.is(b, 0.0) => a,
            (_, Node::Unary(Unary::Negate, b)) => self.sub(a, b),
            (Node::Unary(Unary::Negate, a), _) => self.sub(b, a),
            _ => self.binary(Binary::Add, a, b),
        }
    }

    /// `a - b`.
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        match (self.node(a), self.node(b)) {
            _ if a == b => self.constant(0.0),
            _ if self.is(b, 0.0) => a,
            _ if self.is(a, 0.0) => self.neg(b),
            (_, Node::Unary(Unary::Negate, b)) => self.add(a, b),
            (Node::Unary(Unary::Negate, a), _) => {
                let sum = self.add(a, b);
                self.neg(sum)
            }
            _ => self.binary(Binary::Subtract, a, b),
        }
    }

    /// `a * b`. Signs are moved out of products, where sums absorb them.
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        match (self.node(a), self.node(b)) {
            _ if self.is(a, 0.0) || self.is(b, 0.0) => self.constant(0.0),
            _ if self.is(a, 1.0) => b,
            _ if self.is(b, 1.0) => a,
            _ if self.is(a, -1.0) => self.neg(b),
            _ if self.is(b, -1.0) => self.neg(a),
            (Node::Unary(Unary::Negate, a), _) => self.negative_product(a, b),
            (_, Node::Unary(Unary::Negate, b)) => self.negative_product(a, b),
            _ => self.binary(Binary::Multiply, a, b),
        }
    }

    fn negative_product(&mut self, a: Id, b: Id) -> Id {
        let product = self.mul(a, b);
        self.neg(product)
    }

    /// `a / b`.
    pub fn div(&mut self, a: Id, b: Id) -> Id {
        match self.node(a) {
            _ if self.is(b, 1.0) => a,
            _ if self.is(a, 0.0) && !self.is(b, 0.0) => a,
            Node::Unary(Unary::Negate, a) => {
                let quotient = self.div(a, b);
                self.neg(quotient)
            }
            _ => self.binary(Binary::Divide, a, b),
        }
    }

    /// `-a`.
    pub fn neg(&mut self, a: Id) -> Id {
        match self.node(a) {
            Node::Unary(Unary::Negate, inner) => inner,
            Node::Binary(Binary::Subtract, x, y) => self.sub(y, x),
            _ => self.unary(Unary::Negate, a),
        }
    }

    /// A function of one operand; constants are folded.
    pub fn unary(&mut self, op: Unary, a: Id) -> Id {
        match self.value(a) {
            Some(value) => self.constant(op.apply(value)),
            None => self.intern(Node::Unary(op, a)),
        }
    }

    /// An operation of two operands without algebra; constants are folded, commutative operands ordered.
    pub fn binary(&mut self, op: Binary, a: Id, b: Id) -> Id {
        if let (Some(x), Some(y)) = (self.value(a), self.value(b)) {
            return self.constant(op.apply(x, y));
        }
        let (a, b) = if op.row().commutes && b < a { (b, a) } else { (a, b) };
        self.intern(Node::Binary(op, a, b))
    }

    /// Any operation of one operand, simplified.
    pub(super) fn simplified(&mut self, op: Unary, a: Id) -> Id {
        if op == Unary::Negate { self.neg(a) } else { self.unary(op, a) }
    }

    /// Any operation of two operands, simplified.
    pub(super) fn simplified_pair(&mut self, op: Binary, a: Id, b: Id) -> Id {
        match op {
            Binary::Add => self.add(a, b),
            Binary::Subtract => self.sub(a, b),
            Binary::Multiply => self.mul(a, b),
            Binary::Divide => self.div(a, b),
            Binary::Power => self.pow(a, b),
            _ => self.binary(op, a, b),
        }
    }

    /// `a ^ b`: whole exponents up to 4 become products, 1/2 a root.
    pub fn pow(&mut self, a: Id, b: Id) -> Id {
        let square = |g: &mut Self| g.mul(a, a);
        match self.value(b) {
            _ if self.is(b, 0.0) => self.constant(1.0),
            _ if self.is(b, 1.0) => a,
            _ if self.is(b, 2.0) => square(self),
            _ if self.is(b, 3.0) => {
                let s = square(self);
                self.mul(s, a)
            }
            _ if self.is(b, 4.0) => {
                let s = square(self);
                self.mul(s, s)
            }
            _ if self.is(b, 0.5) => self.unary(Unary::Sqrt, a),
            _ if self.is(b, -1.0) => {
                let one = self.constant(1.0);
                self.div(one, a)
            }
            _ => self.binary(Binary::Power, a, b),
        }
    }

    /// `then` where `condition > 0`, else `otherwise`.
    pub fn select(&mut self, condition: Id, then: Id, otherwise: Id) -> Id {
        match self.value(condition) {
            Some(value) => {
                if value > 0.0 {
                    then
                } else {
                    otherwise
                }
            }
            None => match self.node(then) {
                _ if then == otherwise => then,
                Node::Select { condition: same, then, .. } if same == condition => {
                    self.select(condition, then, otherwise)
                }
                _ => self.intern(Node::Select { condition, then, otherwise }),
            },
        }
    }

    /// The sum of the products of pairs: `sum_i a_i b_i`.
    pub fn dot(&mut self, pairs: impl IntoIterator<Item = (Id, Id)>) -> Id {
        let mut sum = self.constant(0.0);
        for (a, b) in pairs {
            let product = self.mul(a, b);
            sum = self.add(sum, product);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::calculator::Calculator;
    use super::super::graph::Leaf;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn neutral_elements_vanish() {
        let mut g = Graph::default();
        let (x, zero, one) = (g.leaf(Leaf::Carried(0)), g.constant(0.0), g.constant(1.0));
        assert_eq!(g.add(x, zero), x, "x + 0");
        assert_eq!(g.mul(one, x), x, "1 * x");
        assert_eq!(g.mul(x, zero), zero, "x * 0");
        assert_eq!(g.sub(x, x), zero, "x - x");
        let minus = g.neg(x);
        assert_eq!(g.neg(minus), x, "--x");
        assert_eq!(g.add(x, minus), zero, "x + -x");
        let y = g.leaf(Leaf::Carried(1));
        let once = g.select(y, x, one);
        assert_eq!(g.select(y, once, zero), g.select(y, x, zero), "the same condition asked twice");
        let negative_zero = g.constant(-0.0);
        assert_eq!(negative_zero, zero, "-0 is 0");
    }

    #[test]
    fn equal_expressions_are_one_node() {
        let mut g = Graph::default();
        let (x, y) = (g.leaf(Leaf::Carried(0)), g.leaf(Leaf::Column(0)));
        assert_eq!(g.add(x, y), g.add(y, x), "addition commutes");
        let two = g.constant(2.0);
        assert_eq!(g.pow(x, two), g.mul(x, x), "x^2 = x x");
    }

    proptest! {
        /// Whatever is simplified away, the value stays: random expressions against plain f64 arithmetic.
        #[test]
        fn simplified_graphs_keep_their_value(ops in prop::collection::vec((0u8..8, any::<u8>(), any::<u8>()), 1..60), leaves in prop::array::uniform3(-2.0f64..2.0)) {
            let mut g = Graph::default();
            let mut built: Vec<(Id, f64)> = (0u32..3).map(|i| (g.leaf(Leaf::Carried(i)), leaves[i as usize])).collect();
            for c in [0.0, 1.0, -1.0, 2.0] {
                built.push((g.constant(c), c));
            }
            for (op, a, b) in ops {
                let ((a, x), (b, y)) = (built[a as usize % built.len()], built[b as usize % built.len()]);
                let (id, value) = match op {
                    0 | 1 => (g.add(a, b), x + y),
                    2 | 3 => (g.sub(a, b), x - y),
                    4 => (g.mul(a, b), x * y),
                    5 => (g.neg(a), -x),
                    6 => (g.select(a, b, a), if x > 0.0 { y } else { x }),
                    _ => (g.unary(Unary::Sin, a), x.sin()),
                };
                if value.abs() < 1e6 {
                    built.push((id, value));
                }
            }
            let ids: Vec<Id> = built.iter().map(|b| b.0).collect();
            let mut calculator = Calculator::new(&g, &ids);
            let values: Vec<f64> = calculator.evaluate(|l| match l { Leaf::Carried(i) => leaves[i as usize], _ => f64::NAN }).collect();
            for (value, (_, expected)) in values.iter().zip(&built) {
                prop_assert!((value - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{value} against {expected}");
            }
        }
    }
}
