//! From graph to tape: pairs fused, operations ordered, registers assigned by liveness.

use super::graph::{Binary, Graph, Id, Node, Unary};
use std::collections::{HashMap, HashSet};

/// A straight line of operations on registers (one value a candidate) and scalars (one value for all).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tape {
    /// The operations, in order.
    pub operations: Vec<Operation>,
    /// Number of registers they use, inputs included.
    pub registers: usize,
    /// The graph nodes whose values the caller provides as scalars, in order.
    pub scalars: Vec<Id>,
}

/// `register = code(arguments)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operation {
    /// What is computed.
    pub code: Code,
    /// Where the result goes.
    pub register: u16,
    /// As many as [`Code::arity`] says; the rest are [`Argument::NONE`].
    pub arguments: [Argument; 5],
}

/// Where an operand comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Argument {
    /// A register.
    Register(u16),
    /// A scalar.
    Scalar(u16),
}

impl Argument {
    /// Fills unused places.
    pub const NONE: Self = Self::Scalar(u16::MAX);
}

/// Operation codes. Fused operations round as often, and in the same order, as the plain ones they stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Code {
    /// a.
    Copy,
    /// op(a).
    Unary(Unary),
    /// a op b.
    Binary(Binary),
    /// b where a > 0, else c.
    Select,
    /// a * b + c.
    MultiplyAdd,
    /// a * b - c.
    MultiplySubtract,
    /// c - a * b.
    SubtractProduct,
    /// a * b + c * d.
    Dot,
    /// (a * b + e) + c * d.
    DotAdd,
    /// a * b where b > 0, else 0.
    MultiplyPositive,
}

impl Code {
    /// Number of arguments.
    #[must_use]
    pub const fn arity(self) -> usize {
        match self {
            Self::Copy | Self::Unary(_) => 1,
            Self::Binary(_) | Self::MultiplyPositive => 2,
            Self::Select | Self::MultiplyAdd | Self::MultiplySubtract | Self::SubtractProduct => 3,
            Self::Dot => 4,
            Self::DotAdd => 5,
        }
    }
}

/// A value the tape leaves in a register.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// The node.
    pub id: Id,
    /// The register it must end in.
    pub register: usize,
}

impl Tape {
    /// Schedules `outputs`. `inputs` stand in registers 0, 1, ... before the first operation; a register that is the
    /// target of an output may be overwritten once its input is dead, the other inputs are left alone. Nodes that
    /// depend on nothing but constants, columns and starts become scalars.
    #[must_use]
    pub fn new(graph: &Graph, inputs: &[Id], outputs: &[Output]) -> Self {
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

/// An operation before registers are known.
struct Term {
    code: Code,
    operands: Vec<Id>,
}

/// The operations to schedule, by the node they compute.
struct Terms {
    of: HashMap<Id, Term>,
}

impl Terms {
    /// One term a node; a product used once, by a sum or difference, becomes part of it.
    fn fuse(graph: &Graph, nodes: &[Id], roots: &[Id]) -> Self {
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
    fn order(&self, roots: &[Id]) -> Vec<Id> {
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

/// Register assignment in one pass over the ordered operations.
struct Assignment<'a, U> {
    uniform: U,
    remaining: HashMap<Id, usize>,
    place: HashMap<Id, usize>,
    target: HashMap<Id, usize>,
    input_of: HashMap<usize, Id>,
    outputs: HashSet<Id>,
    saved: HashMap<Id, usize>,
    fixed: usize,
    free: Vec<usize>,
    next: usize,
    scalars: Vec<Id>,
    scalar_index: HashMap<Id, u16>,
    operations: Vec<Operation>,
    placed: &'a HashMap<Id, usize>,
}

impl<'a, U: Fn(Id) -> bool> Assignment<'a, U> {
    fn new(placed: &'a HashMap<Id, usize>, outputs: &[Output], terms: &Terms, uniform: U) -> Self {
        let mut remaining: HashMap<Id, usize> = HashMap::new();
        for operand in terms.of.values().flat_map(|t| &t.operands) {
            *remaining.entry(*operand).or_default() += 1;
        }
        let fixed = outputs.iter().map(|o| o.register + 1).max().unwrap_or(0).max(placed.len());
        let mut target = HashMap::new();
        for output in outputs {
            target.entry(output.id).or_insert(output.register);
        }
        let mut this = Self {
            uniform,
            remaining,
            place: placed.clone(),
            target,
            input_of: placed.iter().map(|(id, r)| (*r, *id)).collect(),
            outputs: outputs.iter().map(|o| o.id).collect(),
            saved: HashMap::new(),
            fixed,
            free: Vec::new(),
            next: fixed,
            scalars: Vec::new(),
            scalar_index: HashMap::new(),
            operations: Vec::new(),
            placed,
        };
        this.save_shifted_inputs(outputs);
        this
    }

    /// An output that is another register's input is copied away before anything can overwrite it.
    fn save_shifted_inputs(&mut self, outputs: &[Output]) {
        for output in outputs {
            let shifted = self.placed.get(&output.id).is_some_and(|r| *r != output.register);
            if shifted && !self.saved.contains_key(&output.id) {
                let source = self.argument(output.id);
                let register = self.temporary();
                self.push(Code::Copy, register, &[source]);
                self.saved.insert(output.id, register);
            }
        }
    }

    fn emit(&mut self, id: Id, term: &Term) {
        let arguments: Vec<Argument> = term.operands.iter().map(|o| self.argument(*o)).collect();
        for operand in &term.operands {
            self.release(*operand);
        }
        let register = self.destination(id);
        let (code, arguments) = canonical(term.code, arguments);
        self.push(code, register, &arguments);
        self.place.insert(id, register);
    }

    /// The output's own register if its input is dead by now, else a temporary one.
    fn destination(&mut self, id: Id) -> usize {
        if let Some(&register) = self.target.get(&id)
            && self.input_of.get(&register).is_none_or(|input| self.remaining.get(input).is_none_or(|n| *n == 0))
        {
            return register;
        }
        self.temporary()
    }

    fn temporary(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.next += 1;
            self.next - 1
        })
    }

    /// One use less; a temporary that nobody needs any more is free.
    fn release(&mut self, id: Id) {
        let Some(count) = self.remaining.get_mut(&id) else { return };
        *count -= 1;
        if *count == 0
            && !self.outputs.contains(&id)
            && let Some(&register) = self.place.get(&id).filter(|r| **r >= self.fixed)
        {
            self.free.push(register);
        }
    }

    fn argument(&mut self, id: Id) -> Argument {
        if let Some(&register) = self.place.get(&id) {
            return Argument::Register(narrow(register));
        }
        debug_assert!((self.uniform)(id), "an operand is in a register or a scalar");
        let next = narrow(self.scalars.len());
        let index = *self.scalar_index.entry(id).or_insert(next);
        if index == next {
            self.scalars.push(id);
        }
        Argument::Scalar(index)
    }

    fn push(&mut self, code: Code, register: usize, arguments: &[Argument]) {
        let mut all = [Argument::NONE; 5];
        all[..arguments.len()].copy_from_slice(arguments);
        self.operations.push(Operation { code, register: narrow(register), arguments: all });
    }

    /// Copies what did not end in its own register.
    fn finish(mut self, outputs: &[Output]) -> Tape {
        for output in outputs {
            let source = match self.saved.get(&output.id) {
                Some(copy) if self.placed[&output.id] != output.register => Argument::Register(narrow(*copy)),
                _ => self.argument(output.id),
            };
            if source != Argument::Register(narrow(output.register)) {
                self.push(Code::Copy, output.register, &[source]);
            }
        }
        Tape { operations: self.operations, registers: self.next, scalars: self.scalars }
    }
}

/// Scalars go last among the operands that commute, so that the machines need fewer cases.
fn canonical(code: Code, mut arguments: Vec<Argument>) -> (Code, Vec<Argument>) {
    let commutes = match code {
        Code::Binary(op) => op.is_commutative(),
        Code::MultiplyAdd | Code::MultiplySubtract | Code::SubtractProduct => true,
        _ => false,
    };
    let pairs = match code {
        Code::Dot | Code::DotAdd => 2,
        _ => usize::from(commutes),
    };
    for pair in 0..pairs {
        if matches!(arguments[2 * pair..2 * pair + 2], [Argument::Scalar(_), Argument::Register(_)]) {
            arguments.swap(2 * pair, 2 * pair + 1);
        }
    }
    (code, arguments)
}

#[expect(clippy::expect_used, reason = "dimensions are bounded so that a step has far fewer than 65,535 live values")]
fn narrow(place: usize) -> u16 {
    u16::try_from(place).expect("a tape has fewer than 65,536 registers")
}

#[cfg(test)]
mod tests {
    use super::super::graph::Leaf;
    use super::super::lanes::run_one;
    use super::*;
    use proptest::prelude::*;

    fn step(graph: &Graph, carried: &[Id], next: &[Id]) -> Tape {
        let outputs: Vec<Output> = next.iter().enumerate().map(|(register, id)| Output { id: *id, register }).collect();
        Tape::new(graph, carried, &outputs)
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
            let expected: Vec<f64> = super::super::graph::Calculator::new(&g, &next).evaluate(leaf).collect();
            let tape = step(&g, &carried, &next);
            let scalars: Vec<f64> = super::super::graph::Calculator::new(&g, &tape.scalars).evaluate(leaf).collect();
            let mut registers = values.to_vec();
            run_one(&tape, &mut registers, &scalars);
            for (register, expected) in registers.iter().zip(&expected) {
                let same = register.to_bits() == expected.to_bits() || expected.is_nan();
                prop_assert!(same || (register - expected).abs() < 1e-12 * expected.abs().max(1.0), "{register} against {expected}");
            }
        }
    }
}
