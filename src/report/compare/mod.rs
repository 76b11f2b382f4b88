//! Finished studies side by side.

mod differences;
mod run;
mod table;

#[cfg(test)]
mod tests;

use std::fmt;

use serde::Serialize;

use super::Named;
pub use run::{Run, RunBaseline, RunConsistency, RunError, RunHeldOut, RunValidation};

/// Finished studies, the first of which the others are compared with.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// The runs, in the order given.
    pub runs: Vec<Run>,
    /// Whether objectives of all runs were computed over the same rows in the same way.
    pub comparable: bool,
    /// Why they were not, in sentences.
    pub differences: Vec<String>,
    /// The run, counted from 0, that is lowest under each objective on what it was tuned on; `None` where runs are not
    /// comparable, or several are lowest.
    pub best: Named<Option<usize>>,
    /// The same on held-out rows; no entry where a run has none.
    pub best_held_out: Named<Option<usize>>,
}

/// Why runs cannot be put side by side.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// Fewer than two.
    #[error("{count} runs: a comparison needs at least two")]
    TooFew {
        /// Runs given.
        count: usize,
    },
    /// No objective is common to them.
    #[error("{path} has {found} and {first} has {expected}: they share no objective, so there is nothing to compare")]
    NoSharedObjective {
        /// The run.
        path: String,
        /// Its objectives.
        found: String,
        /// The first run.
        first: String,
        /// The objectives of that.
        expected: String,
    },
}

impl Comparison {
    /// Puts runs side by side.
    ///
    /// # Errors
    /// If there are fewer than two, or one shares no objective with the first.
    pub fn of(runs: Vec<Run>) -> Result<Self, CompareError> {
        let [first, others @ ..] = &runs[..] else { return Err(CompareError::TooFew { count: 0 }) };
        if others.is_empty() {
            return Err(CompareError::TooFew { count: 1 });
        }
        for run in others {
            if !run.objectives.iter().any(|(name, _)| first.objectives.get(name).is_some()) {
                return Err(CompareError::NoSharedObjective {
                    path: run.path.clone(),
                    found: run.objective_list(),
                    first: first.path.clone(),
                    expected: first.objective_list(),
                });
            }
        }
        let differences: Vec<String> = others.iter().flat_map(|run| differences::between(first, run)).collect();
        let comparable = differences.is_empty();
        let shared = || first.objectives.iter().map(|(name, _)| name.to_owned());
        let lowest = |name: &String, held_out: bool| {
            let costs = runs.iter().map(|run| run.objective(name, held_out));
            if comparable { lowest(costs) } else { None }
        };
        let best = shared().map(|name| (name.clone(), lowest(&name, false))).collect();
        let validated = runs.iter().all(|run| run.validation.is_some());
        let best_held_out = shared().filter(|_| validated).map(|name| (name.clone(), lowest(&name, true))).collect();
        Ok(Self { comparable, differences, best, best_held_out, runs })
    }
}

/// Costs no further apart than this, relative, are alike: they show the same digits.
const ALIKE: f64 = 1e-8;

/// Which of these is lowest; `None` when that is not one alone, or one is missing.
fn lowest(costs: impl Iterator<Item = Option<f64>>) -> Option<usize> {
    let costs: Vec<f64> = costs.collect::<Option<_>>()?;
    let (index, least) = costs.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
    let alone = costs.iter().filter(|cost| (*cost - least).abs() <= ALIKE * least.abs()).count() == 1;
    alone.then_some(index)
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", table::of(self))?;
        if self.comparable {
            return writeln!(f, "\n* lowest of the runs, which scored the same rows in the same way.");
        }
        writeln!(f, "\nThese runs are not comparable by their objectives:")?;
        self.differences.iter().try_for_each(|difference| writeln!(f, "  {difference}"))
    }
}
