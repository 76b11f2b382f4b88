//! Multiplication by powers of two, which rounds nothing.

use super::codes::{Binary, Unary};
use super::graph::{Graph, Id, Node};

impl Graph {
    /// 2^`exponent` a: the same digits, as long as neither leaves the range of normal numbers.
    ///
    /// The factor goes to what is computed in f64 before the time loop (constants, columns, invariants), so that a value
    /// beyond the range of f32 never stands in it; only what mixes rows and candidates otherwise than by `+ - * /` costs
    /// an operation.
    pub fn scale(&mut self, a: Id, exponent: i32) -> Id {
        if exponent == 0 {
            return a;
        }
        if self.is_hoisted(a) {
            return self.times_power(a, exponent);
        }
        match self.node(a) {
            Node::Unary(op @ (Unary::Negate | Unary::Abs | Unary::Positive), x) => {
                let x = self.scale(x, exponent);
                self.simplified(op, x)
            }
            Node::Binary(Binary::Multiply, x, y) => {
                let (x, y) = if self.depends(y).is_invariant() { (y, x) } else { (x, y) };
                let x = self.scale(x, exponent);
                self.mul(x, y)
            }
            Node::Binary(Binary::Divide, x, y) => {
                let x = self.scale(x, exponent);
                self.div(x, y)
            }
            Node::Binary(op @ (Binary::Add | Binary::Subtract | Binary::Min | Binary::Max), x, y) => {
                let (x, y) = (self.scale(x, exponent), self.scale(y, exponent));
                self.simplified_pair(op, x, y)
            }
            Node::Select { condition, then, otherwise } => {
                let (then, otherwise) = (self.scale(then, exponent), self.scale(otherwise, exponent));
                self.select(condition, then, otherwise)
            }
            _ => self.times_power(a, exponent),
        }
    }

    fn is_hoisted(&self, a: Id) -> bool {
        let depends = self.depends(a);
        depends.is_uniform() || depends.is_invariant()
    }

    fn times_power(&mut self, a: Id, exponent: i32) -> Id {
        let factor = self.constant(2.0_f64.powi(exponent));
        self.mul(factor, a)
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "the same bits are meant")]
    use super::super::calculator::Calculator;
    use super::super::graph::Leaf;
    use super::*;
    use proptest::prelude::*;

    const LEAVES: [Leaf; 4] = [Leaf::Carried(0), Leaf::Parameter(0), Leaf::Column(0), Leaf::Column(1)];

    #[test]
    fn a_parameter_times_a_column_is_scaled_before_the_time_loop() {
        let mut g = Graph::default();
        let [_, q, dt, _] = LEAVES.map(|leaf| g.leaf(leaf));
        for product in [g.mul(q, dt), g.mul(dt, q)] {
            let scaled = g.scale(product, 40);
            let factor = g.constant(2.0_f64.powi(40));
            let invariant = g.mul(factor, q);
            assert_eq!(scaled, g.mul(invariant, dt));
        }
        let zero = g.constant(0.0);
        assert_eq!(g.scale(zero, 7), zero, "a structural zero stays one");
    }

    proptest! {
        /// Every bit of a scaled expression is that of the expression itself, but for the exponent.
        #[test]
        fn scaling_moves_the_exponent_alone(
            ops in prop::collection::vec((0u8..10, any::<u8>(), any::<u8>()), 1..40),
            values in prop::array::uniform4(0.1f64..2.0),
            exponent in -60i32..60,
        ) {
            let mut g = Graph::default();
            let mut built: Vec<Id> = LEAVES.map(|leaf| g.leaf(leaf)).to_vec();
            for (op, a, b) in ops {
                let (a, b) = (built[a as usize % built.len()], built[b as usize % built.len()]);
                let id = match op {
                    0 => g.add(a, b),
                    1 => g.sub(a, b),
                    2 | 3 => g.mul(a, b),
                    4 => g.div(a, b),
                    5 => g.neg(a),
                    6 => g.select(a, b, a),
                    7 => g.unary(Unary::Abs, a),
                    8 => g.binary(Binary::Min, a, b),
                    _ => g.unary(Unary::Sin, a),
                };
                built.push(id);
            }
            let leaf = |leaf| values[LEAVES.iter().position(|l| *l == leaf).unwrap_or(0)];
            let scaled: Vec<Id> = built.iter().map(|id| g.scale(*id, exponent)).collect();
            let plain: Vec<f64> = Calculator::new(&g, &built).evaluate(leaf).collect();
            let found: Vec<f64> = Calculator::new(&g, &scaled).evaluate(leaf).collect();
            for (found, plain) in found.iter().zip(plain).filter(|(_, plain)| *plain == 0.0 || (1e-200..1e200).contains(&plain.abs())) {
                let expected = plain * 2.0_f64.powi(exponent);
                prop_assert!(found.to_bits() == expected.to_bits() || *found == expected, "{found} against {expected}");
            }
        }
    }
}
