//! Published studies run again: our numbers beside the paper's, and targets that pass or fail.
//!
//! A study is a folder with a `Protocol`, and a row of [`STUDIES`]. It draws its own data, runs on the machinery that every problem file
//! runs on, and hands back a [`Reproduction`]: targets (gated), tables and findings (printed, not gated), figures.
//! Everything but times depends on the seed alone.

mod columns;
mod kf_pio;
mod moma;
mod protocol;
mod reproduction;
mod statistics;
mod target;

use std::num::NonZero;
use std::time::Instant;

use crate::chart::FigureError;
use crate::data::Log;
use crate::evaluate::{BuildError, CpuEvaluator, CpuOptions, Device, Evaluator as _, Population, Precision};
use crate::model::{Problem, ProblemError};
use crate::optimize::OptimizeError;
use crate::reference::Failure;
use crate::simulate::SimulateError;
use crate::study::StudyError;

pub use crate::table::{Cell, Table};
pub use reproduction::{Figure, Reproduction};
pub use target::{Required, Target};

/// One row of [`STUDIES`].
#[derive(Debug)]
pub struct PublishedStudy {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// The paper, with its DOI where it has one.
    pub paper: &'static str,
    run: fn(&Self, &Options, &dyn Progress) -> Result<Reproduction, ReproduceError>,
}

/// Every study that can be reproduced.
pub static STUDIES: &[PublishedStudy] = &[kf_pio::STUDY, moma::STUDY];

/// How a study is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Seed of data and searches.
    pub seed: u64,
    /// Fewer repetitions, with tolerances widened to suit them.
    pub quick: bool,
    /// Number of threads; `None` = one a core. It never changes a result.
    pub threads: Option<NonZero<usize>>,
}

/// Watches a study: it is told how many steps there are, then of each that is done, from several threads.
pub trait Progress: Sync {
    /// `steps` steps begin.
    fn begin(&self, steps: usize);
    /// One more is done.
    fn advance(&self);
}

/// Watches nothing.
#[derive(Debug, Clone, Copy)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _steps: usize) {}
    fn advance(&self) {}
}

/// Why a study could not be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// No such name.
    #[error("unknown study {name:?}{}: expected one of {}, or all", nearest.map(|n| format!(" (did you mean {n:?}?)")).unwrap_or_default(), names())]
    UnknownStudy {
        /// The name received.
        name: String,
        /// The known name nearest to it, where one is near.
        nearest: Option<&'static str>,
    },
    /// The study's own problem was refused.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// Its log could not be drawn.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The filter cannot be traced.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// An optimiser cannot be built.
    #[error(transparent)]
    Optimize(#[from] OptimizeError),
    /// A search could not run.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A search found nothing.
    #[error("{what} found no usable candidate on data set {data_set}: every one failed")]
    Nothing {
        /// The search.
        what: String,
        /// Which data set, from 0.
        data_set: u64,
    },
    /// The reference filter failed where a search had succeeded.
    #[error("{what} of data set {data_set}: {failure}")]
    Filter {
        /// Which filter.
        what: String,
        /// Which data set, from 0.
        data_set: u64,
        /// Where and why.
        failure: Failure,
    },
    /// A picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {reason} (give fewer)")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system says.
        reason: String,
    },
}

fn names() -> String {
    STUDIES.iter().map(|study| study.name).collect::<Vec<_>>().join(", ")
}

/// The row of a name.
///
/// # Errors
/// [`ReproduceError::UnknownStudy`] with the nearest known name.
pub fn published(name: &str) -> Result<&'static PublishedStudy, ReproduceError> {
    let nearest = || {
        let known = STUDIES.iter().map(|study| study.name).chain(["all"]);
        let distance = |known: &&str| strsim::damerau_levenshtein(known, name);
        known.min_by_key(distance).filter(|known| distance(known) <= 3)
    };
    STUDIES
        .iter()
        .find(|study| study.name == name)
        .ok_or_else(|| ReproduceError::UnknownStudy { name: name.to_owned(), nearest: nearest() })
}

impl PublishedStudy {
    /// Runs the study, on as many threads as the options say.
    ///
    /// # Errors
    /// If a search cannot run or finds nothing, or the threads cannot be started. A missed target is no error.
    pub fn run(&self, options: &Options, progress: &dyn Progress) -> Result<Reproduction, ReproduceError> {
        let threads = options.threads.map_or(0, NonZero::get);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| ReproduceError::Threads { threads, reason: error.to_string() })?;
        let clock = Instant::now();
        let mut report = pool.install(|| (self.run)(self, options, progress))?;
        report.wall_s = clock.elapsed().as_secs_f64();
        Ok(report)
    }
}

/// Data sets run side by side, each on one thread.
const ONE_THREAD: CpuOptions = CpuOptions { precision: Precision::F64, threads: Some(NonZero::<usize>::MIN) };

/// Scores candidates of `problem` on the log of one data set.
fn evaluator(problem: &Problem, log: &Log) -> Result<CpuEvaluator, ReproduceError> {
    Ok(CpuEvaluator::new(problem, log, ONE_THREAD)?)
}

/// Where costs are computed: one thread a data set, on all threads of the pool.
fn device(problem: &Problem, log: &Log) -> Result<Device, ReproduceError> {
    let all = CpuOptions { threads: NonZero::new(rayon::current_num_threads()), ..ONE_THREAD };
    Ok(CpuEvaluator::new(problem, log, all)?.device())
}

/// The first objective of some candidates.
fn scores(evaluator: &mut CpuEvaluator, candidates: &Population) -> Vec<f64> {
    let costs = evaluator.evaluate(candidates);
    (0..candidates.len()).map(|i| costs.costs(i)[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_is_refused_with_the_nearest() {
        let error = published("kf-poi").unwrap_err().to_string();
        assert!(
            error.starts_with("unknown study \"kf-poi\" (did you mean \"kf-pio\"?): expected one of kf-pio"),
            "{error}"
        );
        let error = published("what else").unwrap_err().to_string();
        assert!(!error.contains("did you mean"), "{error}");
    }

    #[test]
    fn names_are_distinct_and_none_is_all() {
        let mut names: Vec<&str> = STUDIES.iter().map(|s| s.name).collect();
        names.push("all");
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), STUDIES.len() + 1, "{names:?}");
    }
}
