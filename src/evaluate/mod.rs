//! Evaluators: a whole population in, a cost matrix and a status each out.

mod block;
mod build;
mod cpu;
mod device;
#[cfg(feature = "gpu")]
pub mod gpu;

#[doc(hidden)]
pub mod mock;
pub mod probe;
mod single;

pub use crate::population::{Evaluation, Population, Status};
pub use crate::precision::Precision;
pub use build::BuildError;
pub use cpu::{CpuEvaluator, CpuOptions};
pub use device::{Adapter, Backend, Device};

use crate::filter::Program;
use crate::objective::Constraint;

/// Scores whole populations; the only way any optimiser gets a cost.
pub trait Evaluator {
    /// Number of objectives of every evaluation.
    fn objectives(&self) -> usize;

    /// Costs and status of every candidate, in order. The same candidate gets the same bits in any population.
    fn evaluate(&mut self, population: &Population) -> Evaluation;

    /// Where it computes.
    fn device(&self) -> Device;

    /// Rows of the log that a candidate runs over; 0 where there is no log.
    fn rows(&self) -> usize {
        0
    }
}

/// From the scores and statuses of the parts of a population, in order; see [`Evaluation::new`].
fn scored(program: &Program, parts: Vec<(Vec<f64>, Vec<Status>)>) -> Evaluation {
    let (scores, status): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    let (k, scores) = (program.objectives(), scores.concat());
    if program.constraints().is_empty() {
        return Evaluation::new(k, scores, status.concat());
    }
    let rows = || scores.chunks_exact(program.scorers());
    let violation = rows().map(|row| Constraint::total_violation(program.constraints(), &row[k..])).collect();
    let costs = rows().flat_map(|row| &row[..k]).copied().collect();
    Evaluation::new(k, costs, status.concat()).with_violation(violation)
}
