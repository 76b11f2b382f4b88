//! The study: the one loop of ask, evaluate, tell; then the f64 verdict on what it found.

mod archive;
mod checkpoint;
mod coordinates;
mod decision;
mod error;
mod finish;
mod front;
mod polish;
mod record;
mod search;
mod snapshot;
mod split;
mod stop;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicBool, Ordering};

pub use archive::{Archive, Scored};
pub use checkpoint::{Checkpoint, CheckpointError, CheckpointFile, Identity, NUMERICS, Source};
pub use coordinates::Coordinates;
pub use error::StudyError;
pub use finish::Certificate;
pub use front::{Among, FRONT_CAPACITY, Front, FrontMember, Landmarks, MeanNis};
pub use polish::{Ended, Polish};
pub use record::{FINALISTS, Generation, Observer, Reached};
pub use snapshot::Snapshot;
pub use split::{Split, SplitError, scoring_rows};
pub use stop::StopReason;

use crate::evaluate::{Evaluation, Evaluator, Population};
use crate::model::{Parameters, Problem, TuneSpec};
use crate::optimize::{self, Optimizer, Settings};
use decision::Decision;
use finish::Bounds;
use record::Record;
use search::Search;

/// Objectives of which a front is searched.
pub const MAX_OBJECTIVES: usize = 4;

/// What is searched, and how.
#[derive(Debug, Clone, Copy)]
pub struct Study<'a> {
    /// The parameters, of which some are searched.
    pub parameters: &'a Parameters,
    /// Algorithm, budget and seed.
    pub tune: &'a TuneSpec,
}

impl<'a> Study<'a> {
    /// The study that a problem file describes.
    #[must_use]
    pub const fn of(problem: &'a Problem) -> Self {
        Self { parameters: &problem.parameters, tune: &problem.tune }
    }

    /// The optimiser that `tune.algorithm` names, for so many objectives.
    fn optimizer(&self, objectives: usize) -> Result<Box<dyn Optimizer>, StudyError> {
        if self.parameters.dimension() == 0 {
            return Err(StudyError::NothingSearched);
        }
        let &TuneSpec { population, generations, seed, evaluations, include_start, .. } = self.tune;
        let settings = Settings { population, generations, seed, objectives, evaluations };
        let space = Coordinates::new(self.parameters, include_start).space();
        Ok(optimize::build(&self.tune.algorithm, &space, &settings)?)
    }
}

/// f64 costs of a candidate by the reference filter, `None` where it fails: the objectives and, behind them, what the
/// constraints bound ([`crate::reference::scores`]; without constraints [`crate::reference::costs`]). Called from several
/// threads.
pub type Oracle<'a> = dyn Fn(&[f64]) -> Option<Vec<f64>> + Sync + 'a;

/// How far a candidate's filter carries a small change of its log ([`crate::reference::amplification`]); infinite where it
/// fails. Called from several threads.
pub type Amplification<'a> = dyn Fn(&[f64]) -> f64 + Sync + 'a;

/// Who decides after the search.
pub struct Judge<'a> {
    /// Scores the finalists, the baseline and the polished winner.
    pub oracle: &'a Oracle<'a>,
    /// Says which finalists have costs that rounding may not decide; `None` = all have, as with a linear filter.
    pub amplification: Option<&'a Amplification<'a>>,
    /// The f64 evaluator that polish runs on; `None` = the one of the search, which is right when that is f64 already.
    pub polisher: Option<&'a mut dyn Evaluator>,
}

/// The user's own candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// The starts; the middle of `init` where none is given.
    pub candidate: Vec<f64>,
    /// Objectives by the oracle; `None` where it fails.
    pub objectives: Option<Vec<f64>>,
    /// What the constraints bound, by the oracle.
    pub constraints: Option<Vec<f64>>,
}

/// What the search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Winner {
    /// Values of the searched parameters, in their own units.
    pub candidate: Vec<f64>,
    /// Objectives by the oracle.
    pub objectives: Vec<f64>,
    /// What the constraints bound, by the oracle.
    pub constraints: Vec<f64>,
    /// How far it is from satisfying the constraints, by the oracle: 0 = feasible. Above 0 only if nothing feasible was
    /// found; then this is what violates least.
    pub violation: f64,
    /// How far search and oracle agree.
    pub certificate: Certificate,
    /// The local searches after it; `None` when off or interrupted.
    pub polish: Option<Polish>,
}

/// The result of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Name of the optimiser.
    pub algorithm: &'static str,
    /// The user's own candidate.
    pub baseline: Baseline,
    /// The best candidate, of a front the recommended member; `None` if every one failed, in the search or by the oracle.
    pub winner: Option<Winner>,
    /// With several objectives, everything feasible that nothing else dominates by the oracle, best first objective first;
    /// at most [`FRONT_CAPACITY`] members and the user's start.
    pub front: Vec<FrontMember>,
    /// Where the knee and the ends of the front are; `None` without a front.
    pub landmarks: Option<Landmarks>,
    /// The point that [`Generation::hypervolume`] is measured from; empty with one objective, and while nothing feasible
    /// was found.
    pub reference_point: Vec<f64>,
    /// One row a generation.
    pub history: Vec<Generation>,
    /// Generations run, with the initial one.
    pub generations: usize,
    /// Evaluations of the search, without polish.
    pub evaluations: u64,
    /// How many of them failed.
    pub failed: u64,
    /// Why the search ended.
    pub stop: StopReason,
    /// Time inside the evaluator in seconds, without polish.
    pub evaluate_s: f64,
    /// Time of the whole study, in seconds.
    pub wall_s: f64,
}

/// Runs a study: searches until the optimiser or a limit ends it, re-scores the best distinct candidates by the oracle,
/// and polishes the winner.
///
/// Between generations `interrupt` is read: once true, the search ends with the best so far and polish is left out. A
/// generation starts only if all of it fits in the evaluations allowed; one of several parts ends with the last part
/// that fits. Apart from times, the outcome depends on the study and the costs alone, as long as neither wall time nor
/// an interrupt ends it.
///
/// # Errors
/// If nothing is searched, the optimiser cannot be built, the budget holds no generation, or the evaluator returns the
/// wrong number of costs.
pub fn run(
    study: &Study<'_>,
    evaluator: &mut dyn Evaluator,
    judge: Judge<'_>,
    observers: &mut [&mut dyn Observer],
    interrupt: &AtomicBool,
) -> Result<Outcome, StudyError> {
    let mut optimizer = study.optimizer(evaluator.objectives())?;
    run_with(study, optimizer.as_mut(), evaluator, judge, observers, interrupt)
}

/// As [`run`], with an optimiser of the caller's own in place of the one that `study.tune.algorithm` names. It moves in
/// the [`Coordinates`] of the study, and ends the search by its own count of generations.
///
/// # Errors
/// As [`run`], but for those of building an optimiser.
pub fn run_with(
    study: &Study<'_>,
    optimizer: &mut dyn Optimizer,
    evaluator: &mut dyn Evaluator,
    judge: Judge<'_>,
    observers: &mut [&mut dyn Observer],
    interrupt: &AtomicBool,
) -> Result<Outcome, StudyError> {
    let task = Task { study, optimizer, from: None };
    run_task(task, evaluator, judge, observers, interrupt)
}

/// As [`run`], going on from where a search of the same study stood: the outcome has the bits of one that was never
/// interrupted, if the evaluator's costs have. Limits may be others than before; a search that had ended by a limit
/// which no longer holds goes on.
///
/// # Errors
/// As [`run`]; and if the saved search does not fit the study.
pub fn resume(
    study: &Study<'_>,
    from: &Snapshot,
    evaluator: &mut dyn Evaluator,
    judge: Judge<'_>,
    observers: &mut [&mut dyn Observer],
    interrupt: &AtomicBool,
) -> Result<Outcome, StudyError> {
    let mut optimizer = study.optimizer(evaluator.objectives())?;
    let task = Task { study, optimizer: optimizer.as_mut(), from: Some(from) };
    run_task(task, evaluator, judge, observers, interrupt)
}

/// A study, the optimiser that moves its candidates, and where the search begins.
pub struct Task<'a> {
    /// What is searched, and how.
    pub study: &'a Study<'a>,
    /// Newly built; it moves in the [`Coordinates`] of the study.
    pub optimizer: &'a mut dyn Optimizer,
    /// The search to go on from; `None` = begin with generation 0.
    pub from: Option<&'a Snapshot>,
}

/// What [`run`], [`run_with`] and [`resume`] are short for.
///
/// # Errors
/// As they have.
pub fn run_task(
    task: Task<'_>,
    evaluator: &mut dyn Evaluator,
    judge: Judge<'_>,
    observers: &mut [&mut dyn Observer],
    interrupt: &AtomicBool,
) -> Result<Outcome, StudyError> {
    let Task { study, optimizer, from } = task;
    let tune = study.tune;
    if study.parameters.dimension() == 0 {
        return Err(StudyError::NothingSearched);
    }
    let coordinates = Coordinates::new(study.parameters, tune.include_start);
    let bounds = Bounds::of(tune, evaluator);
    if bounds.objectives > MAX_OBJECTIVES {
        return Err(StudyError::TooManyObjectives { objectives: bounds.objectives, limit: MAX_OBJECTIVES });
    }
    let baseline = decision::baseline(study.parameters.baseline(), judge.oracle, bounds)?;
    let mut record = Record::new(bounds.objectives);
    if let Some(from) = from {
        from.check(optimizer.name(), study.parameters.dimension(), bounds.objectives)?;
        optimizer.restore(&from.optimizer)?;
        record = Record::of(from);
    }
    let search = Search::new(tune, &coordinates, optimizer, evaluator, &mut record);
    let mut search = search.restored(from.map(|from| from.optimizer.as_slice()));
    let ended = search.run(observers, interrupt)?;
    let Decision { winner, front, landmarks } =
        decision::decide(tune, &coordinates, &record, evaluator, judge, interrupt)?;
    let stop = if interrupt.load(Ordering::Relaxed) { StopReason::Interrupted } else { ended };
    Ok(Outcome {
        algorithm: optimizer.name(),
        baseline,
        winner,
        front,
        landmarks,
        reference_point: record.front.as_ref().map_or_else(Vec::new, |front| front.reference().to_vec()),
        generations: record.generations(),
        evaluations: record.evaluations,
        failed: record.failed,
        stop,
        evaluate_s: record.evaluate_s,
        wall_s: record.seconds(),
        history: record.history,
    })
}

/// Costs of a population, one row a candidate or an error.
fn evaluate(evaluator: &mut dyn Evaluator, candidates: &Population) -> Result<Evaluation, StudyError> {
    let costs = evaluator.evaluate(candidates);
    if costs.len() == candidates.len() {
        Ok(costs)
    } else {
        Err(StudyError::Evaluator { expected: candidates.len(), received: costs.len() })
    }
}
