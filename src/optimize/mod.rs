//! Optimisers: ask/tell over a search space; they never see what evaluates.
//!
//! Every optimiser is one file and one row of [`ALGORITHMS`]. All of them draw from [`Stream`](crate::random::Stream) with one stream
//! per (generation, candidate), so a result depends on the seed alone.

pub mod indicators;
pub mod lbfgsb;
mod local_search;
pub mod memetic;
pub mod nelder_mead;
pub mod nsga2;
pub mod operators;
pub mod pareto;
pub mod pio;
pub mod pso;
pub mod random_search;
mod registry;
mod saved;
mod space;
mod swarm;
#[cfg(test)]
mod tests;

pub use local_search::{LocalSearch, Standing};
pub use registry::{ALGORITHMS, Algorithm, OptimizeError, Settings, algorithm, build};
pub use space::Space;

use crate::population::{Evaluation, Population};

/// Moves a population. Positions are in **search coordinates** (see [`Space`]); the study converts.
///
/// Calls alternate: [`Self::ask`], then [`Self::tell`] with the costs of exactly that population.
pub trait Optimizer {
    /// Name in the registry.
    fn name(&self) -> &'static str;

    /// The next candidates to score, or `None` when the method has come to its own end.
    fn ask(&mut self) -> Option<Population>;

    /// Costs of exactly the population that [`Self::ask`] gave last, of which a memetic wrapper may have improved some.
    fn tell(&mut self, population: &Population, costs: &Evaluation);

    /// Whether the last [`Self::tell`] ended a generation; a method that scores a generation in several parts says
    /// `false` between them, and the parts become one row of the history.
    fn generation_finished(&self) -> bool {
        true
    }

    /// Everything that later generations depend on and that building it anew does not give; `None` = this optimiser
    /// cannot be resumed. Called after [`Self::tell`].
    fn save(&self) -> Option<Vec<u8>> {
        None
    }

    /// Takes up where the optimiser that wrote `saved` stood: it was built from the same space and settings.
    ///
    /// # Errors
    /// If `saved` is not of this optimiser, space and settings; then nothing has changed.
    fn restore(&mut self, _saved: &[u8]) -> Result<(), RestoreError> {
        Err(RestoreError { algorithm: self.name(), problem: "it keeps no state to resume from" })
    }
}

/// Why an optimiser could not take up a saved state.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("algorithm {algorithm:?} cannot take up this state: {problem}")]
pub struct RestoreError {
    /// The optimiser asked.
    pub algorithm: &'static str,
    /// What is wrong.
    pub problem: &'static str,
}
