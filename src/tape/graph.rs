//! The expression graph: hash-consed scalar nodes, simplified as they are built (see [`super::simplify`]).

use super::codes::{Binary, Unary};
use std::collections::HashMap;

/// A node, by its place in the graph. Operands always come before the node that uses them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(u32);

impl Id {
    pub(super) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Node {
    /// A number, by its bits (so that it can be hashed); never negative zero.
    Constant(u64),
    /// A quantity that comes from outside.
    Leaf(Leaf),
    /// One operand.
    Unary(Unary, Id),
    /// Two operands; those of commutative operations are ordered by [`Id`].
    Binary(Binary, Id, Id),
    /// `a` where `condition > 0`, else `b`.
    Select {
        /// What is compared with 0.
        condition: Id,
        /// Value where it is positive.
        then: Id,
        /// Value elsewhere.
        otherwise: Id,
    },
}

/// Quantities that come from outside the graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leaf {
    /// Carried from row to row: a state, an entry of P, a running sum.
    Carried(u32),
    /// A searched parameter: one value a candidate.
    Parameter(u32),
    /// A column of the record: one value a row, the same for every candidate.
    Column(u32),
    /// One value a trajectory, the same for every candidate (a start taken from a measurement).
    Start(u32),
    /// A variable that only exists while a Jacobian is taken.
    Variable(u32),
}

/// What the value of a node depends on, which decides when it is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Depends(u8);

impl Depends {
    const CARRIED: u8 = 1;
    const PARAMETER: u8 = 2;
    const COLUMN: u8 = 4;
    const START: u8 = 8;
    const VARIABLE: u8 = 16;

    const fn of_leaf(leaf: Leaf) -> Self {
        Self(match leaf {
            Leaf::Carried(_) => Self::CARRIED,
            Leaf::Parameter(_) => Self::PARAMETER,
            Leaf::Column(_) => Self::COLUMN,
            Leaf::Start(_) => Self::START,
            Leaf::Variable(_) => Self::VARIABLE,
        })
    }

    const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The same for every candidate and row.
    #[must_use]
    pub const fn is_constant(self) -> bool {
        self.0 == 0
    }

    /// The same for every candidate.
    #[must_use]
    pub const fn is_uniform(self) -> bool {
        self.0 & !(Self::COLUMN | Self::START) == 0
    }

    /// The same for every row of a trajectory, so computed once before the first.
    #[must_use]
    pub const fn is_invariant(self) -> bool {
        self.0 & !(Self::PARAMETER | Self::START) == 0
    }

    /// Involves a variable of differentiation.
    #[must_use]
    pub const fn has_variable(self) -> bool {
        self.0 & Self::VARIABLE != 0
    }

    /// Involves a searched parameter.
    #[must_use]
    pub const fn has_parameter(self) -> bool {
        self.0 & Self::PARAMETER != 0
    }
}

/// A graph of scalar expressions in which equal expressions are one node.
#[derive(Debug, Clone, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    depends: Vec<Depends>,
    index: HashMap<Node, Id>,
}

impl Graph {
    /// The node behind `id`.
    #[must_use]
    pub fn node(&self, id: Id) -> Node {
        self.nodes[id.index()]
    }

    /// What `id` depends on.
    #[must_use]
    pub fn depends(&self, id: Id) -> Depends {
        self.depends[id.index()]
    }

    /// Number of nodes built so far.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether nothing has been built.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The value of a constant node.
    #[must_use]
    pub fn value(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Whether `id` is the constant `value`.
    #[must_use]
    pub fn is(&self, id: Id, value: f64) -> bool {
        self.node(id) == Node::Constant(value.to_bits())
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> Id {
        let value = if value.abs() == 0.0 { 0.0 } else { value };
        self.intern(Node::Constant(value.to_bits()))
    }

    /// A quantity from outside.
    pub fn leaf(&mut self, leaf: Leaf) -> Id {
        self.intern(Node::Leaf(leaf))
    }

    /// The node itself, without simplification; an equal node is reused.
    pub(super) fn intern(&mut self, node: Node) -> Id {
        if let Some(&id) = self.index.get(&node) {
            return id;
        }
        #[expect(
            clippy::expect_used,
            reason = "4 billion nodes need 100 GB: formulas and dimensions are bounded far below"
        )]
        let id = Id(u32::try_from(self.nodes.len()).expect("a graph has fewer than 2^32 nodes"));
        let depends = match node {
            Node::Leaf(leaf) => Depends::of_leaf(leaf),
            _ => self.operands(node).into_iter().flatten().fold(Depends::default(), |d, o| d.union(self.depends(o))),
        };
        self.nodes.push(node);
        self.depends.push(depends);
        self.index.insert(node, id);
        id
    }

    /// Operands of a node, in order.
    #[expect(clippy::unused_self, reason = "reads as a question to the graph")]
    pub(crate) const fn operands(&self, node: Node) -> [Option<Id>; 3] {
        match node {
            Node::Constant(_) | Node::Leaf(_) => [None; 3],
            Node::Unary(_, a) => [Some(a), None, None],
            Node::Binary(_, a, b) => [Some(a), Some(b), None],
            Node::Select { condition, then, otherwise } => [Some(condition), Some(then), Some(otherwise)],
        }
    }

    /// Every node that `roots` need and that `inside` accepts (it is not looked behind the others), operands first.
    pub(crate) fn reachable(&self, roots: &[Id], inside: impl Fn(Id) -> bool) -> Vec<Id> {
        let mut seen = vec![false; self.nodes.len()];
        let mut stack: Vec<Id> = roots.to_vec();
        let mut found = Vec::new();
        while let Some(id) = stack.pop() {
            if seen[id.index()] || !inside(id) {
                continue;
            }
            seen[id.index()] = true;
            found.push(id);
            stack.extend(self.operands(self.node(id)).into_iter().flatten());
        }
        found.sort_unstable();
        found
    }
}
