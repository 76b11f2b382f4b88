//! What a study may see of its log, and what is held out to judge the result by.
//!
//! Rows are held out from the end of a trajectory, or whole trajectories are: later rows never affect earlier ones in a
//! filter, so the training part is a shorter log and nothing that computes costs needs to know of the split.

use crate::data::{HeldOut, Log, SplitBy, Trajectory, ValidateSpec};
use crate::model::{Cause, Problem, ProblemError, Start};
use crate::objective::{Kind, Objective};
use crate::simulate::{SimulateError, realisations};

/// A log parted for tuning.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// What the search, the certificate, polish and the choice of the winner see.
    pub train: Log,
    /// What none of them sees.
    pub held_out: Option<HeldOut>,
}

/// Why a log cannot be parted as `data.validate` asks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
#[non_exhaustive]
pub enum SplitError {
    #[error("validation by trajectory needs at least two, and {source_name} has one (use by = \"time\")")]
    OneTrajectory { source_name: String },
    #[error("{share} of the {count} {what} of {source_name} rounds to none, so nothing is held out (give more)")]
    NothingHeldOut { share: f64, count: usize, what: &'static str, source_name: String },
    #[error("{share} of the {count} {what} of {source_name} rounds to all, so nothing is left to train on (give less)")]
    NothingToTrain { share: f64, count: usize, what: &'static str, source_name: String },
    #[error(
        "no {part} row of {source_name} scores under the objective `{objective}`, which needs {needs} there (give \
         another share)"
    )]
    NothingScores { part: &'static str, source_name: String, objective: &'static str, needs: &'static str },
    #[error("the {part} rows of {source_name} cannot serve by themselves: {cause}")]
    Unfit { part: &'static str, source_name: String, cause: Box<Cause> },
    #[error(
        "a share of {share} needs {count} fresh realisations beside {beside}, and at most {limit} are drawn in all"
    )]
    TooManyRealisations { share: f64, count: f64, beside: usize, limit: usize },
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

/// What each part is called in messages.
const TRAINING: &str = "training";
const HELD_OUT: &str = "held-out";

impl Split {
    /// Nothing held out.
    #[must_use]
    pub const fn whole(log: Log) -> Self {
        Self { train: log, held_out: None }
    }

    /// Parts `log` as the problem's `data.validate` says, and checks that every objective scores in both parts.
    ///
    /// With n trajectories, h = round(share x n) of them are held out, spread evenly: number i (from 1) where i h / n,
    /// rounded down, passes a whole number; the last is always one of them. By time the last round(share x rows) rows of
    /// each trajectory are, but never its first row. A log drawn from `[simulate]` keeps all its realisations for
    /// training unless `by = "time"`, and fresh ones are drawn to be held out: `share` of all, at least one.
    ///
    /// # Errors
    /// If nothing is left to train on or nothing is held out, or an objective has no row to score in one of the parts.
    pub fn of(problem: &Problem, log: Log) -> Result<Self, ProblemError> {
        let Some(spec) = problem.data.validate else { return Ok(Self::whole(log)) };
        let parted = Self::parted(problem, spec, log).and_then(|split| split.check(problem).map(|()| split.ranged()));
        parted.map_err(|error| problem.fault(&["data", "validate"], Cause::Validate { problem: error.to_string() }))
    }

    /// Held-out rows are judged by the ranges of those that the filter was tuned on.
    fn ranged(mut self) -> Self {
        if let Some(held) = &mut self.held_out {
            held.log.ranges = Some(self.train.ranges());
        }
        self
    }

    fn parted(problem: &Problem, spec: ValidateSpec, log: Log) -> Result<Self, SplitError> {
        let simulated = problem.data.file.is_none();
        let default = if simulated || log.trajectories.len() > 1 { SplitBy::Trajectory } else { SplitBy::Time };
        match spec.by.unwrap_or(default) {
            SplitBy::Trajectory if simulated => Self::with_fresh_realisations(problem, spec.share, log),
            SplitBy::Trajectory => Self::by_trajectory(spec.share, log),
            SplitBy::Time => Self::by_time(spec.share, log),
        }
    }

    fn by_time(share: f64, log: Log) -> Result<Self, SplitError> {
        let held = |t: &Trajectory| round(share * t.len() as f64);
        let what = if log.trajectories.len() > 1 { "rows (in the longest trajectory)" } else { "rows" };
        let longest = log.trajectories.iter().map(Trajectory::len).max().unwrap_or(0);
        refuse_empty(share, round(share * longest as f64), longest, what, &log)?;
        let from = log.trajectories.iter().map(|t| t.len() - held(t).min(t.len().saturating_sub(1))).collect();
        let train = log.with(log.trajectories.iter().zip(&from).map(|(t, from): (_, &usize)| t.first(*from)).collect());
        Ok(Self { train, held_out: Some(HeldOut { log, from, by: SplitBy::Time, share }) })
    }

    fn by_trajectory(share: f64, mut log: Log) -> Result<Self, SplitError> {
        let all = std::mem::take(&mut log.trajectories);
        let (n, held) = (all.len(), round(share * all.len() as f64));
        if n < 2 {
            return Err(SplitError::OneTrajectory { source_name: log.source });
        }
        refuse_empty(share, held, n, "trajectories", &log)?;
        let is_held = |i: usize| (i + 1) * held / n > i * held / n;
        let (held, kept): (Vec<_>, Vec<_>) = all.into_iter().enumerate().partition(|(i, _)| is_held(*i));
        let part = |part: Vec<(usize, Trajectory)>| log.with(part.into_iter().map(|(_, t)| t).collect());
        Ok(Self { train: part(kept), held_out: Some(HeldOut::trajectories(part(held), share)) })
    }

    fn with_fresh_realisations(problem: &Problem, share: f64, log: Log) -> Result<Self, SplitError> {
        const LIMIT: usize = 1_000_000;
        let kept = log.trajectories.len();
        let fresh = (share / (1.0 - share) * kept as f64).round().max(1.0);
        if fresh + kept as f64 > LIMIT as f64 {
            return Err(SplitError::TooManyRealisations { share, count: fresh, beside: kept, limit: LIMIT });
        }
        let held = realisations(problem, None, kept..kept + round(fresh))?;
        Ok(Self { train: log, held_out: Some(HeldOut::trajectories(held, share)) })
    }

    /// Refuses parts that the problem cannot run on, or where an objective has nothing to score.
    fn check(&self, problem: &Problem) -> Result<(), SplitError> {
        let source_name = || self.train.source.clone();
        let whole = vec![0; self.train.trajectories.len()];
        let held = self.held_out.as_ref().map(|held| (HELD_OUT, &held.log, &held.from));
        for (part, log, from) in [(TRAINING, &self.train, &whole)].into_iter().chain(held) {
            problem.check_log(log).map_err(|error| SplitError::Unfit {
                part,
                source_name: source_name(),
                cause: error.cause,
            })?;
            for objective in &problem.tune.objectives {
                if scoring_rows(problem, log, from, objective) == 0 {
                    let needs = if objective.kind.needs_truth() { "truth of its states" } else { "a measurement" };
                    let objective = objective.name();
                    return Err(SplitError::NothingScores { part, source_name: source_name(), objective, needs });
                }
            }
        }
        Ok(())
    }

    /// What the user should know about the training part that is not so of the whole log, in sentences.
    #[must_use]
    pub fn warnings(&self, problem: &Problem) -> Vec<String> {
        if self.held_out.is_none() {
            return Vec::new();
        }
        let unmeasured = |i: &usize| self.train.trajectories.iter().all(|t| t.z.column(*i).all(f64::is_nan));
        let columns = (0..self.train.measurements.len()).filter(unmeasured);
        columns
            .map(|i| {
                let name = &problem.model.measurements[i];
                format!("the measurement `{name}` has no value in the training rows, so nothing tunes its noise")
            })
            .collect()
    }
}

/// Number of rows of `log`, from row `from` of each trajectory on, that score under `objective`: those that update the
/// filter, or have the truth it needs.
///
/// # Panics
/// If `from` has not one entry a trajectory.
#[must_use]
pub fn scoring_rows(problem: &Problem, log: &Log, from: &[usize], objective: &Objective) -> usize {
    assert_eq!(from.len(), log.trajectories.len(), "one first row a trajectory");
    let truth = truth_columns(problem, log, objective);
    let scores = |t: &Trajectory, k: usize, start: Option<usize>| {
        if objective.kind.needs_truth() {
            truth.as_ref().is_some_and(|columns| columns.iter().all(|c| !t.truth.row(k)[*c].is_nan()))
        } else {
            start != Some(k) && t.z.row(k).iter().any(|z| !z.is_nan())
        }
    };
    let of = |(t, from): (&Trajectory, &usize)| {
        let start = (problem.model.x0 == Start::Measurement)
            .then(|| (0..t.len()).find(|&k| t.is_complete(k)).unwrap_or_else(|| t.len()));
        let first = start.unwrap_or(0).max(*from).max(objective.skip);
        (first..t.len()).filter(|&k| scores(t, k, start)).count()
    };
    log.trajectories.iter().zip(from).map(of).sum()
}

/// Columns of the truth that an objective compares with; `None` where one is not there.
fn truth_columns(problem: &Problem, log: &Log, objective: &Objective) -> Option<Vec<usize>> {
    let column = |state: &String| log.truth.iter().position(|t| t == state);
    let states = &problem.model.states;
    match objective.kind {
        Kind::Nees => states.iter().map(column).collect(),
        _ if objective.states.is_empty() => Some((0..log.truth.len()).collect()).filter(|c: &Vec<_>| !c.is_empty()),
        _ => objective.states.iter().map(|&i| column(&states[i])).collect(),
    }
}

fn refuse_empty(share: f64, held: usize, count: usize, what: &'static str, log: &Log) -> Result<(), SplitError> {
    let source_name = log.source.clone();
    match held {
        0 => Err(SplitError::NothingHeldOut { share, count, what, source_name }),
        held if held >= count => Err(SplitError::NothingToTrain { share, count, what, source_name }),
        _ => Ok(()),
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count not above that of a log's rows")]
fn round(share: f64) -> usize {
    share.round() as usize
}
