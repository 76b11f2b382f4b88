//! What the form of the matrices proves, without a number of a candidate.
//!
//! A matrix is written as a sum of strengths (products of parameters) times shapes (numbers, or functions of the interval):
//! q [dt^3/3, dt^2/2; dt^2/2, dt], r I. Where the shapes are semidefinite at every interval and the strengths are not
//! negative, so is the sum. A variance of its own on every place of the diagonal, or one strength times a definite shape,
//! is definite where the strengths are positive.

use super::Matrix;
use crate::model::{Parameters, ROUNDING, is_covariance};
use crate::tape::{Binary, Calculator, Graph, Id, Leaf, Node, Unary};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// A searched parameter that must be above 0, or at least 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Premise {
    parameter: usize,
    sign: Sign,
}

/// What is known of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Sign {
    Unknown,
    NotNegative,
    Positive,
}

use Sign::{NotNegative, Positive, Unknown};

impl Premise {
    pub(super) fn holds(self, candidate: &[f64]) -> bool {
        let value = candidate[self.parameter];
        match self.sign {
            Unknown => true,
            NotNegative => value >= 0.0,
            Positive => value > 0.0,
        }
    }
}

/// Under which signs of the parameters all matrices are covariances: those that their bounds give, or else all positive.
pub(super) fn premises(
    g: &mut Graph,
    matrices: &[Matrix],
    parameters: &Parameters,
    intervals: &[f64],
) -> Option<Vec<Premise>> {
    let sums: Vec<Sum> = matrices.iter().map(|matrix| Sum::of(g, matrix)).collect::<Option<_>>()?;
    let shapes: Vec<bool> = sums.iter().zip(matrices).map(|(sum, matrix)| sum.sound(g, matrix, intervals)).collect();
    if shapes.contains(&false) {
        return None;
    }
    let bounds = |min: f64| {
        if min > 0.0 {
            Positive
        } else if min >= 0.0 {
            NotNegative
        } else {
            Unknown
        }
    };
    let bounded: Vec<Sign> = parameters.searched().map(|(_, search)| bounds(search.min)).collect();
    let positive = vec![Positive; bounded.len()];
    let roots: Vec<Id> = matrices.iter().flat_map(|m| m.entries.upper().to_vec()).collect();
    let used: Vec<usize> = g.reachable(&roots, |_| true).iter().filter_map(|id| parameter(g, *id)).collect();
    [bounded, positive].into_iter().find(|signs| sums.iter().all(|sum| sum.holds(g, signs))).map(|signs| {
        let premise = |parameter: &usize| Premise { parameter: *parameter, sign: signs[*parameter] };
        used.iter().map(premise).collect()
    })
}

fn parameter(g: &Graph, id: Id) -> Option<usize> {
    match g.node(id) {
        Node::Leaf(Leaf::Parameter(i)) => Some(i as usize),
        _ => None,
    }
}

/// A matrix as a sum of strengths times shapes.
struct Sum {
    /// Factors of a strength, in order, with the entries of its shape.
    parts: BTreeMap<Vec<Id>, Vec<(usize, usize, Id)>>,
    definite: bool,
}

/// A product of parameters' functions times a function of the interval.
struct Term {
    strength: Vec<Id>,
    shape: Id,
}

impl Sum {
    fn of(g: &mut Graph, matrix: &Matrix) -> Option<Self> {
        let mut parts: BTreeMap<Vec<Id>, Vec<(usize, usize, Id)>> = BTreeMap::new();
        for i in 0..matrix.entries.n() {
            for j in i..matrix.entries.n() {
                for Term { mut strength, shape } in terms(g, matrix.entries.at(i, j))? {
                    strength.sort_unstable();
                    let entries = parts.entry(strength).or_default();
                    match entries.iter_mut().find(|(a, b, _)| (*a, *b) == (i, j)) {
                        Some((_, _, sum)) => *sum = g.add(*sum, shape),
                        None => entries.push((i, j, shape)),
                    }
                }
            }
        }
        parts.values_mut().for_each(|entries| entries.retain(|(_, _, shape)| !g.is(*shape, 0.0)));
        parts.retain(|_, entries| !entries.is_empty());
        Some(Self { parts, definite: !matrix.semi })
    }

    /// Whether every shape is semidefinite at every interval, and their sum definite where the matrix must be.
    fn sound(&self, g: &Graph, matrix: &Matrix, intervals: &[f64]) -> bool {
        let n = matrix.entries.n();
        let once = [f64::NAN];
        let intervals = if matrix.depends_on_interval(g) { intervals } else { &once };
        let semidefinite = self.parts.values().all(|entries| {
            let shapes: Vec<Id> = entries.iter().map(|(_, _, shape)| *shape).collect();
            let mut calculator = Calculator::new(g, &shapes);
            intervals.iter().all(|dt| {
                let mut shape = DMatrix::zeros(n, n);
                for ((i, j, _), value) in entries.iter().zip(calculator.evaluate(|_| *dt)) {
                    (shape[(*i, *j)], shape[(*j, *i)]) = (value, value);
                }
                if self.definite && self.parts.len() == 1 {
                    // With something to spare, for the rounding of strength times shape.
                    (0..n).for_each(|i| shape[(i, i)] *= 1.0 - ROUNDING);
                    return is_covariance(&shape, false);
                }
                is_covariance(&shape, true)
            })
        });
        let diagonal = self.parts.values().flatten().all(|(i, j, _)| i == j);
        semidefinite && (!self.definite || self.parts.len() == 1 || diagonal)
    }

    /// Whether the strengths are what they have to be if the parameters have these signs.
    fn holds(&self, g: &Graph, signs: &[Sign]) -> bool {
        let sign = |strength: &Vec<Id>| product(g, strength, signs);
        if self.parts.keys().any(|strength| sign(strength) == Unknown) {
            return false;
        }
        if !self.definite {
            return true;
        }
        // Shapes are semidefinite, so an entry that is not 0 on the diagonal is positive.
        let positive: Vec<&(usize, usize, Id)> =
            self.parts.iter().filter(|(strength, _)| sign(strength) == Positive).flat_map(|(_, e)| e).collect();
        let mut places = self.parts.values().flatten();
        places.all(|(i, _, _)| positive.iter().any(|(a, b, _)| a == i && b == i))
    }
}

/// The addends of a node; `None` where parameters and the interval cannot be told apart.
fn terms(g: &mut Graph, id: Id) -> Option<Vec<Term>> {
    /// More than any formula by hand has.
    const MOST: usize = 256;
    let one = g.constant(1.0);
    let depends = g.depends(id);
    if !depends.has_parameter() {
        return Some(vec![Term { strength: vec![], shape: id }]);
    }
    let found = match g.node(id) {
        Node::Unary(Unary::Negate, a) => {
            let a = terms(g, a)?;
            negated(g, a)
        }
        Node::Binary(Binary::Add, a, b) => [terms(g, a)?, terms(g, b)?].into_iter().flatten().collect(),
        Node::Binary(Binary::Subtract, a, b) => {
            let (a, b) = (terms(g, a)?, terms(g, b)?);
            let b = negated(g, b);
            a.into_iter().chain(b).collect()
        }
        Node::Binary(Binary::Multiply, a, b) => {
            let (a, b) = (terms(g, a)?, terms(g, b)?);
            if a.len() * b.len() > MOST {
                return None;
            }
            let mut all = Vec::with_capacity(a.len() * b.len());
            for (a, b) in a.iter().flat_map(|a| b.iter().map(move |b| (a, b))) {
                let strength = a.strength.iter().chain(&b.strength).copied().collect();
                all.push(Term { strength, shape: g.mul(a.shape, b.shape) });
            }
            all
        }
        Node::Binary(Binary::Divide, a, b) if !g.depends(b).has_parameter() => {
            let mut all = terms(g, a)?;
            all.iter_mut().for_each(|term| term.shape = g.div(term.shape, b));
            all
        }
        Node::Binary(Binary::Divide, a, b) if g.depends(b).is_invariant() => {
            let inverse = g.div(one, b);
            if id == inverse {
                return Some(vec![Term { strength: vec![id], shape: one }]);
            }
            let mut all = terms(g, a)?;
            all.iter_mut().for_each(|term| term.strength.push(inverse));
            all
        }
        _ if depends.is_invariant() => vec![Term { strength: vec![id], shape: one }],
        _ => return None,
    };
    (found.len() <= MOST).then_some(found)
}

fn negated(g: &mut Graph, mut terms: Vec<Term>) -> Vec<Term> {
    terms.iter_mut().for_each(|term| term.shape = g.neg(term.shape));
    terms
}

/// The sign of a product of nodes in order, where equal ones make squares.
fn product(g: &Graph, factors: &[Id], signs: &[Sign]) -> Sign {
    let runs = factors.chunk_by(|a, b| a == b);
    let run = |run: &[Id]| {
        let sign = sign(g, run[0], signs);
        if run.len().is_multiple_of(2) { sign.max(NotNegative) } else { sign }
    };
    runs.map(run).min().unwrap_or(Positive)
}

/// The sign of a node of parameters.
fn sign(g: &Graph, id: Id, signs: &[Sign]) -> Sign {
    let of = |id| sign(g, id, signs);
    let zero_at_least = |sign: Sign| sign.max(NotNegative);
    match g.node(id) {
        Node::Constant(bits) => match f64::from_bits(bits) {
            v if v > 0.0 => Positive,
            v if v >= 0.0 => NotNegative,
            _ => Unknown,
        },
        Node::Leaf(Leaf::Parameter(i)) => signs[i as usize],
        Node::Unary(Unary::Exp, _) => Positive,
        Node::Unary(Unary::Sqrt, a) => of(a),
        Node::Unary(Unary::Abs, a) => zero_at_least(of(a)),
        Node::Binary(Binary::Add, a, b) => match (of(a), of(b)) {
            (Unknown, _) | (_, Unknown) => Unknown,
            (a, b) => a.max(b),
        },
        Node::Binary(Binary::Multiply, a, b) if a == b => zero_at_least(of(a)),
        Node::Binary(Binary::Multiply, a, b) => of(a).min(of(b)),
        Node::Binary(Binary::Divide, a, b) if of(b) == Positive => of(a),
        Node::Binary(Binary::Power, a, _) if of(a) == Positive => Positive,
        Node::Binary(Binary::Min, a, b) => of(a).min(of(b)),
        Node::Binary(Binary::Max, a, b) => of(a).max(of(b)),
        _ => Unknown,
    }
}
