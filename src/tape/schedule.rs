//! From graph to tape: pairs fused and operations ordered (see [`super::terms`]), registers assigned by liveness (see
//! [`super::assignment`]).

use super::assignment::{Assignment, narrow};
use super::graph::{Graph, Id};
use super::straight_line::{Argument, Output, Tape, TooLarge};
use super::terms::Terms;
use std::collections::HashMap;

impl Tape {
    /// Schedules `outputs`. `inputs` stand in registers 0, 1, ... before the first operation; a register that is the
    /// target of an output may be overwritten once its input is dead, the other inputs are left alone. Nodes that
    /// depend on nothing but constants, columns and starts become scalars.
    ///
    /// # Errors
    /// If more registers or scalars are needed than an [`Argument`] can name.
    pub fn new(graph: &Graph, inputs: &[Id], outputs: &[Output]) -> Result<Self, TooLarge> {
        let placed: HashMap<Id, usize> = inputs.iter().enumerate().map(|(r, id)| (*id, r)).collect();
        let uniform = |id: Id| graph.depends(id).is_uniform();
        let inside = |id: Id| !placed.contains_key(&id) && !uniform(id);
        let roots: Vec<Id> = outputs.iter().map(|o| o.id).collect();
        let nodes = graph.reachable(&roots, inside);
        let terms = Terms::fuse(graph, &nodes, &roots);
        let order = terms.order(&roots);
        let mut assign = Assignment::new(&placed, outputs, &terms, uniform);
        for id in order {
            assign.emit(id, &terms.of[&id]);
        }
        assign.finish(outputs)
    }
}

impl Tape {
    /// Renumbers the scalars so that those with a property come first.
    pub(crate) fn scalars_first(&mut self, property: impl Fn(Id) -> bool) {
        let (first, rest): (Vec<usize>, Vec<usize>) = (0..self.scalars.len()).partition(|i| property(self.scalars[*i]));
        let order: Vec<usize> = first.into_iter().chain(rest).collect();
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, old)| place[*old] = narrow(new));
        self.scalars = order.iter().map(|old| self.scalars[*old]).collect();
        for argument in self.operations.iter_mut().flat_map(|o| &mut o.arguments) {
            match *argument {
                Argument::NONE | Argument::Register(_) => {}
                Argument::Scalar(s) => *argument = Argument::Scalar(place[s as usize]),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::codes::Unary;
    use super::super::graph::Leaf;
    use super::super::lanes::run_one;
    use super::*;
    use proptest::prelude::*;

    fn step(graph: &Graph, carried: &[Id], next: &[Id]) -> Tape {
        let outputs: Vec<Output> = next.iter().enumerate().map(|(register, id)| Output { id: *id, register }).collect();
        Tape::new(graph, carried, &outputs).unwrap()
    }

    /// x plus `count` different numbers, none of which can be folded into another.
    fn with_scalars(count: u32) -> Result<Tape, TooLarge> {
        let mut g = Graph::default();
        let x = g.leaf(Leaf::Carried(0));
        let mut sum = x;
        for column in 0..count {
            let column = g.leaf(Leaf::Column(column));
            sum = g.mul(sum, x);
            sum = g.add(sum, column);
        }
        Tape::new(&g, &[x], &[Output { id: sum, register: 0 }])
    }

    #[test]
    fn more_numbers_than_operations_can_name_are_an_error() {
        assert_eq!(with_scalars(65_535).unwrap().scalars.len(), 65_535, "the limit itself fits");
        assert_eq!(with_scalars(65_536), Err(TooLarge { registers: 2, scalars: 65_536 }));
    }

    #[test]
    fn a_product_used_once_is_fused_and_updates_in_place() {
        let mut g = Graph::default();
        let (x, v) = (g.leaf(Leaf::Carried(0)), g.leaf(Leaf::Carried(1)));
        let dt = g.leaf(Leaf::Column(0));
        let move_ = g.mul(v, dt);
        let next = g.add(x, move_);
        let tape = step(&g, &[x, v], &[next, v]);
        assert_eq!(tape.operations.len(), 1, "x += v dt is one operation: {tape:?}");
        assert_eq!((tape.registers, tape.scalars), (2, vec![dt]), "in place, dt as a scalar");
    }

    #[test]
    fn registers_may_change_places() {
        let mut g = Graph::default();
        let [a, b, c] = [0, 1, 2].map(|i| g.leaf(Leaf::Carried(i)));
        let sum = g.add(a, b);
        let tape = step(&g, &[a, b, c], &[b, a, sum]);
        let mut registers = vec![1.0, 2.0, 9.0];
        run_one(&tape, &mut registers, &[]);
        assert_eq!(registers[..3], [2.0, 1.0, 3.0], "swapped, and the sum of the old values");
    }

    proptest! {
        /// Random graphs of carried values: running the tape equals evaluating the graph, in every register.
        #[test]
        fn a_tape_computes_its_graph(ops in prop::collection::vec((0u8..5, any::<u8>(), any::<u8>()), 1..80), next in prop::array::uniform4(any::<u8>())) {
            let mut g = Graph::default();
            let carried: Vec<Id> = (0..4).map(|i| g.leaf(Leaf::Carried(i))).collect();
            let mut built = carried.clone();
            built.push(g.leaf(Leaf::Column(0)));
            built.push(g.constant(0.5));
            for (op, a, b) in ops {
                let (a, b) = (built[a as usize % built.len()], built[b as usize % built.len()]);
                let id = match op {
                    0 => g.add(a, b),
                    1 => g.sub(a, b),
                    2 => g.mul(a, b),
                    3 => g.select(a, b, a),
                    _ => g.unary(Unary::Sin, a),
                };
                built.push(id);
            }
            let next: Vec<Id> = next.iter().map(|i| built[built.len() - 1 - *i as usize % built.len()]).collect();
            let values = [0.3, -0.7, 1.1, 0.9];
            let leaf = |l| match l { Leaf::Carried(i) => values[i as usize], _ => 0.25 };
            let expected: Vec<f64> = super::super::calculator::Calculator::new(&g, &next).evaluate(leaf).collect();
            let tape = step(&g, &carried, &next);
            let scalars: Vec<f64> = super::super::calculator::Calculator::new(&g, &tape.scalars).evaluate(leaf).collect();
            let mut registers = values.to_vec();
            run_one(&tape, &mut registers, &scalars);
            for (register, expected) in registers.iter().zip(&expected) {
                let same = register.to_bits() == expected.to_bits() || expected.is_nan();
                prop_assert!(same || (register - expected).abs() < 1e-12 * expected.abs().max(1.0), "{register} against {expected}");
            }
        }
    }
}
