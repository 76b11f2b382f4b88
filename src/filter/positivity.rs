//! Which candidates have covariances for Q, R and P0: judged in f64 from their parameters alone, before any row, so that
//! every device says the same.
//!
//! The rule is [`is_covariance`](crate::model::is_covariance), for Q at every interval of the log. What the form of the
//! matrices proves for positive parameters ([`proof`]) is not computed for the candidates that have them.

mod proof;

use super::carried::narrow;
use super::covariance::Symmetric;
use super::error::TraceError;
use super::formula::{self, Scope};
use super::rows::Rows;
use crate::model::{First, Problem, ROUNDING, is_product, must_be_definite};
use crate::tape::lanes::{Register, run_apart};
use crate::tape::{Calculator, Graph, Id, Leaf, Output, Tape};
use proof::Premise;
use std::collections::BTreeSet;

/// The checks of a problem over a log.
#[derive(Debug, Clone, Default)]
pub struct Positivity {
    checks: Vec<Check>,
    /// What a candidate is accepted for without a check; `None` where nothing is proven.
    proof: Option<Vec<Premise>>,
    /// Number of searched parameters.
    dimension: usize,
}

/// A tape from searched parameters to one number, positive where the matrices are covariances.
#[derive(Debug, Clone)]
struct Check {
    tape: Tape,
    /// Scalars of the tape: once, or for every interval.
    scalars: Vec<Vec<f64>>,
}

/// A matrix to be judged.
#[derive(PartialEq, Eq)]
struct Matrix {
    entries: Symmetric,
    /// Whether it may be singular.
    semi: bool,
}

/// Candidates that are checked side by side.
const LANES: usize = 8;

impl Positivity {
    /// Traces the checks.
    pub(super) fn new(problem: &Problem, rows: &Rows<'_>) -> Result<Self, TraceError> {
        let mut g = Graph::default();
        let intervals = intervals(problem, rows);
        let matrices = matrices(&mut g, problem, !intervals.is_empty());
        let dimension = problem.parameters.dimension();
        let proof = proof::premises(&mut g, &matrices, &problem.parameters, &intervals);
        let (often, once): (Vec<_>, Vec<_>) = matrices.iter().partition(|m| m.depends_on_interval(&g));
        let mut checks = Vec::new();
        for (matrices, intervals) in [(once, &[f64::NAN][..]), (often, &intervals[..])] {
            let conditions: Vec<Id> = matrices.iter().flat_map(|m| m.conditions(&mut g)).collect();
            let (passed, failed) = (g.constant(1.0), g.constant(-1.0));
            let all = conditions.iter().fold(passed, |all, condition| g.select(*condition, all, failed));
            if all != passed && !intervals.is_empty() {
                checks.push(Check::new(&mut g, all, dimension, intervals)?);
            }
        }
        Ok(Self { checks, proof, dimension })
    }

    /// Indices of the candidates (row-major) whose Q, R or P0 is no covariance.
    pub(crate) fn refused(&self, candidates: &[f64]) -> Vec<usize> {
        if self.checks.is_empty() || self.dimension == 0 {
            return Vec::new();
        }
        let proven = |candidate: &[f64]| self.proof.as_ref().is_some_and(|p| p.iter().all(|p| p.holds(candidate)));
        let rows = candidates.chunks_exact(self.dimension).enumerate();
        let open: Vec<(usize, &[f64])> = rows.filter(|(_, candidate)| !proven(candidate)).collect();
        open.chunks(LANES).flat_map(|block| self.refused_of(block)).collect()
    }

    fn refused_of(&self, block: &[(usize, &[f64])]) -> Vec<usize> {
        let passed = |lane: usize, least: &[f64; LANES]| least[lane] > 0.0;
        let mut refused = vec![false; block.len()];
        for check in &self.checks {
            let mut registers = vec![Register::<f64, LANES, 1>::splat(0.0); check.tape.registers];
            for scalars in &check.scalars {
                for (lane, (_, candidate)) in block.iter().enumerate() {
                    candidate.iter().zip(&mut registers).for_each(|(v, r)| r.lanes_mut()[lane] = *v);
                }
                run_apart(&check.tape.operations, &mut registers, scalars);
                let mut least = [0.0; LANES];
                least.copy_from_slice(registers[self.dimension].lanes());
                refused.iter_mut().enumerate().for_each(|(lane, refused)| *refused |= !passed(lane, &least));
            }
        }
        block.iter().zip(refused).filter(|(_, refused)| *refused).map(|((index, _), _)| *index).collect()
    }
}

impl Check {
    fn new(g: &mut Graph, result: Id, dimension: usize, intervals: &[f64]) -> Result<Self, TraceError> {
        let inputs: Vec<Id> = (0..dimension).map(|i| g.leaf(Leaf::Parameter(narrow(i)))).collect();
        let tape = Tape::new(g, &inputs, &[Output { id: result, register: dimension }])?;
        let mut calculator = Calculator::new(g, &tape.scalars);
        let scalars = intervals.iter().map(|dt| calculator.evaluate(|_| *dt).collect()).collect();
        Ok(Self { tape, scalars })
    }
}

impl Matrix {
    fn depends_on_interval(&self, g: &Graph) -> bool {
        self.entries.upper().iter().any(|id| !g.depends(*id).is_invariant())
    }

    /// What has to be positive: the pivots of L D L', and what they leave up to the largest number.
    #[expect(clippy::needless_range_loop, reason = "rows i and columns k of one matrix")]
    fn conditions(&self, g: &mut Graph) -> Vec<Id> {
        let n = self.entries.n();
        let (least, largest) = (g.constant(f64::MIN_POSITIVE), g.constant(f64::MAX));
        let raised = g.constant(if self.semi { 1.0 + ROUNDING } else { 1.0 });
        let mut entry = |i, j| if i == j { g.mul(self.entries.at(i, i), raised) } else { self.entries.at(i, j) };
        let mut rest: Vec<Vec<Id>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let mut conditions = Vec::new();
        for j in 0..n {
            if self.semi && (j..n).all(|i| g.is(rest[i][j], 0.0)) {
                continue;
            }
            let mut pivot = rest[j][j];
            if self.semi {
                // A variance of 0 passes; what correlates with it leaves another hugely negative.
                pivot = g.add(pivot, least);
            }
            conditions.push(pivot);
            conditions.push(g.sub(largest, pivot));
            for i in j + 1..n {
                if g.is(rest[i][j], 0.0) {
                    continue;
                }
                let share = g.div(rest[i][j], pivot);
                for k in j + 1..=i {
                    let product = g.mul(share, rest[k][j]);
                    rest[i][k] = g.sub(rest[i][k], product);
                }
            }
        }
        conditions.retain(|id| g.value(*id).is_none_or(|v| v.is_nan() || v <= 0.0));
        conditions
    }
}

/// P0, R and Q as far as they have to be judged; Q as a function of the interval, which is column 0.
fn matrices(g: &mut Graph, problem: &Problem, steps: bool) -> Vec<Matrix> {
    let parameters = formula::parameters(g, &problem.parameters, None);
    let dt = g.leaf(Leaf::Column(0));
    let scope = Scope { states: &[], parameters: &parameters, inputs: &[], dt };
    let mut matrices: Vec<Matrix> = Vec::new();
    for model in problem.models() {
        let kinds =
            [(&model.p0, must_be_definite(&model.p0)), (&model.r, must_be_definite(&model.r)), (&model.q, false)];
        for (formulas, definite) in &kinds[..if steps { 3 } else { 2 }] {
            // M M' is semidefinite whatever M is.
            if is_product(formulas) {
                continue;
            }
            let n = formulas.len().isqrt();
            let entries = Symmetric::from_fn(n, |i, j| formula::trace(g, &formulas[i * n + j], scope));
            let matrix = Matrix { entries, semi: !definite };
            // Modes have most matrices in common.
            if !matrices.contains(&matrix) {
                matrices.push(matrix);
            }
        }
    }
    matrices
}

/// Every interval over which the filter predicts, each once.
fn intervals(problem: &Problem, rows: &Rows<'_>) -> Vec<f64> {
    let trajectories = rows.log.trajectories.iter().zip(&rows.first);
    let used = trajectories.flat_map(|(t, first)| (*first..t.len()).filter_map(|k| t.dt(k)));
    let before = match problem.model.first {
        First::Predict { dt } => dt.or_else(|| rows.log.regular_dt()),
        First::Update => None,
    };
    // Positive numbers are ordered as their bits are.
    let distinct: BTreeSet<u64> = used.chain(before).map(f64::to_bits).collect();
    distinct.into_iter().map(f64::from_bits).collect()
}

#[cfg(test)]
mod tests;
