//! Random search: the baseline that any other method must beat.

use super::saved::{self, Reader};
use super::{Optimizer, RestoreError, Settings, Space, swarm};
use crate::population::{Evaluation, Population};

/// Draws every generation afresh and uniformly from `init` (the bounds, where bounded); learns nothing.
///
/// J. Bergstra, Y. Bengio, "Random search for hyper-parameter optimization", JMLR 13 (2012), shows why it is the
/// baseline to beat. No constants. Any number of objectives.
#[derive(Debug, Clone)]
pub struct RandomSearch {
    space: Space,
    settings: Settings,
    generation: usize,
}

impl RandomSearch {
    /// At generation 0, which holds the seeds.
    #[must_use]
    pub fn new(space: &Space, settings: &Settings) -> Self {
        Self { space: space.clone(), settings: *settings, generation: 0 }
    }
}

impl Optimizer for RandomSearch {
    fn name(&self) -> &'static str {
        "random"
    }

    fn ask(&mut self) -> Option<Population> {
        let Settings { population, seed, generations, .. } = self.settings;
        match self.generation {
            0 => Some(swarm::first(&self.space, population, seed)),
            g if g <= generations => Some(swarm::draw(&self.space, population, seed, g as u64)),
            _ => None,
        }
    }

    fn tell(&mut self, _population: &Population, _costs: &Evaluation) {
        self.generation += 1;
    }
    /// The generation alone: nothing is learnt.
    fn save(&self) -> Option<Vec<u8>> {
        saved::write(&self.generation)
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), RestoreError> {
        let reader = Reader { algorithm: self.name(), dimension: self.space.dimension() };
        self.generation = reader.told(reader.read(saved)?, self.settings.generations)?;
        Ok(())
    }
}
