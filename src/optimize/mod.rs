//! Optimisers: ask/tell over a search space; they never see what evaluates.

pub mod random;

use crate::evaluate::{Evaluation, Population};

/// Moves a population. Positions are in **search coordinates** (see [`Space`]); the study converts.
pub trait Optimizer {
    /// Name in the registry.
    fn name(&self) -> &'static str;

    /// The next candidates to score, or `None` when the method has come to its own end.
    fn ask(&mut self) -> Option<Population>;

    /// Costs of exactly the population that [`Self::ask`] gave last.
    fn tell(&mut self, population: &Population, costs: &Evaluation);
}

/// The box that an optimiser moves in: one entry per searched parameter, in the parameter's value or its logarithm.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    /// Lower bounds; -inf when unbounded.
    pub lower: Vec<f64>,
    /// Upper bounds; +inf when unbounded.
    pub upper: Vec<f64>,
    /// Where the first population is drawn from, uniformly.
    pub init: Vec<[f64; 2]>,
    /// Candidates that replace the first members of generation 0 (the user's start).
    pub seeds: Vec<Vec<f64>>,
}
