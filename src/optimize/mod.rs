//! Optimisers: ask/tell over a search space; they never see what evaluates.
//!
//! Every optimiser is one file and one row of [`ALGORITHMS`]. All of them draw from [`random::Stream`] with one stream
//! per (generation, candidate), so a result depends on the seed alone.

pub mod nelder_mead;
pub mod pio;
pub mod pso;
pub mod random;
pub mod random_search;
mod registry;
mod space;
mod swarm;
#[cfg(test)]
mod tests;

pub use registry::{ALGORITHMS, Algorithm, OptimizeError, Settings, algorithm, build};
pub use space::Space;

use crate::evaluate::{Evaluation, Population};

/// Moves a population. Positions are in **search coordinates** (see [`Space`]); the study converts.
///
/// Calls alternate: [`Self::ask`], then [`Self::tell`] with the costs of exactly that population.
pub trait Optimizer {
    /// Name in the registry.
    fn name(&self) -> &'static str;

    /// The next candidates to score, or `None` when the method has come to its own end.
    fn ask(&mut self) -> Option<Population>;

    /// Costs of exactly the population that [`Self::ask`] gave last.
    fn tell(&mut self, population: &Population, costs: &Evaluation);
}
