//! What a search has done so far, and who watches it.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::Snapshot;
use super::archive::{Archive, Scored};
use super::front::{FRONT_CAPACITY, Front};
use crate::evaluate::{Evaluation, Population};

/// Candidates that are re-scored in f64 at the end.
pub const FINALISTS: usize = 16;

/// A relative gain below this counts as none.
const STALL_GAIN: f64 = 1e-9;

/// One generation of the history. Costs are of the first objective, as the search scored them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Generation {
    /// 0 = the initial population.
    pub generation: usize,
    /// Evaluations up to and with this generation.
    pub evaluations: u64,
    /// Best cost of the search so far; `None` while no candidate is usable and feasible.
    pub best: Option<f64>,
    /// Median cost of this generation's usable candidates.
    pub median: Option<f64>,
    /// Interquartile range of their costs.
    pub spread: Option<f64>,
    /// Candidates of this generation that failed.
    pub failed: usize,
    /// Candidates of this generation that are usable and meet all constraints.
    pub feasible: usize,
    /// Members of the front so far; `None` with one objective.
    pub front: Option<usize>,
    /// Volume that the front dominates, up to the study's reference point; `None` with one objective, and while the front
    /// has no member.
    pub hypervolume: Option<f64>,
    /// Time since the search began, in seconds; a resumed one counts what was spent before.
    pub seconds: f64,
}

/// Watches a search: progress, history, checkpoints.
pub trait Observer {
    /// A generation is finished; `best` is the best candidate so far, as the search scored it.
    fn generation(&mut self, row: &Generation, best: Option<&Scored>);

    /// Whether [`Self::state`] is of use to it. Asked once, before the search.
    fn keeps_states(&self) -> bool {
        false
    }

    /// After every finished generation, and once more with `ended` when none will follow: `make` gives what the search
    /// can be resumed from. Never called for an optimiser that keeps no state.
    fn state(&mut self, _make: &dyn Fn() -> Snapshot, _ended: bool) {}
}

/// The running record of a search.
#[derive(Debug)]
pub(super) struct Record {
    clock: Instant,
    /// Seconds spent before the clock was started, by the runs that this one goes on from.
    spent: f64,
    pub(super) archive: Archive,
    /// With several objectives.
    pub(super) front: Option<Front>,
    pub(super) start: Option<Scored>,
    pub(super) history: Vec<Generation>,
    pub(super) evaluations: u64,
    pub(super) evaluate_s: f64,
    pub(super) failed: u64,
    /// Generations since the last gain.
    pub(super) stalled: usize,
    pub(super) reached: Option<Reached>,
    unfinished: Unfinished,
}

/// How far a search has come; both numbers fall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// Smallest violation of the constraints.
    pub violation: f64,
    /// Best first objective, or minus the hypervolume; the worst finite number while nothing is feasible.
    pub cost: f64,
}

impl Reached {
    /// Whether this is better than `old` by a relative 1e-9.
    fn gains_on(self, old: Self) -> bool {
        let gain = |old: f64, new: f64| old - new > STALL_GAIN * old.abs();
        gain(old.violation, self.violation) || (self.violation <= 0.0 && gain(old.cost, self.cost))
    }
}

/// The parts so far of a generation that is not finished.
#[derive(Debug, Default)]
struct Unfinished {
    /// Costs of its usable candidates.
    costs: Vec<f64>,
    failed: usize,
    feasible: usize,
}

impl Record {
    pub(super) fn new(objectives: usize) -> Self {
        Self {
            clock: Instant::now(),
            spent: 0.0,
            archive: Archive::new(FINALISTS),
            front: (objectives > 1).then(|| Front::new(objectives, FRONT_CAPACITY)),
            start: None,
            history: Vec::new(),
            evaluations: 0,
            evaluate_s: 0.0,
            failed: 0,
            stalled: 0,
            reached: None,
            unfinished: Unfinished::default(),
        }
    }

    /// As it stood when the snapshot was taken.
    pub(super) fn of(snapshot: &Snapshot) -> Self {
        Self {
            spent: snapshot.wall_s,
            archive: Archive::of(FINALISTS, snapshot.archive.clone()),
            start: snapshot.start.clone(),
            history: snapshot.history.clone(),
            evaluations: snapshot.evaluations(),
            evaluate_s: snapshot.evaluate_s,
            failed: snapshot.failed(),
            stalled: snapshot.stalled,
            reached: snapshot.reached,
            front: snapshot.front.clone(),
            ..Self::new(1)
        }
    }

    /// Finished generations.
    pub(super) const fn generations(&self) -> usize {
        self.history.len()
    }

    /// Whether a generation has parts but no end yet.
    pub(super) const fn is_unfinished(&self) -> bool {
        !self.unfinished.costs.is_empty() || self.unfinished.failed > 0
    }

    /// Time since the beginning, in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.spent + self.clock.elapsed().as_secs_f64()
    }

    /// Keeps the user's start with its costs, if these candidates hold it and it did not fail.
    pub(super) fn keep_start(&mut self, start: &[f64], candidates: &Population, costs: &Evaluation) {
        let found = candidates.rows().position(|row| row == start).filter(|i| costs.status(*i).is_ok());
        let scored = found.map(|i| Scored {
            candidate: candidates.row(i).to_vec(),
            costs: costs.costs(i).to_vec(),
            violation: costs.violation(i),
        });
        self.start = self.start.take().or(scored);
    }

    /// Takes in scored candidates: a generation, or a part of one.
    pub(super) fn add(&mut self, candidates: &Population, costs: &Evaluation) {
        self.archive.add(candidates, costs);
        self.evaluations += candidates.len() as u64;
        let usable = (0..costs.len()).filter(|i| costs.status(*i).is_ok());
        let before = self.unfinished.costs.len();
        self.unfinished.costs.extend(usable.map(|i| costs.costs(i)[0]));
        let failed = costs.len() - (self.unfinished.costs.len() - before);
        self.unfinished.failed += failed;
        self.failed += failed as u64;
        self.unfinished.feasible += (0..costs.len()).filter(|i| costs.violation(*i) <= 0.0).count();
        if let Some(front) = &mut self.front {
            front.add(candidates, costs);
        }
    }

    /// Makes a row of the history of what was added since the last one.
    pub(super) fn finish_generation(&mut self) {
        let best = self.archive.best().filter(|best| best.violation <= 0.0).map(|best| best.costs[0]);
        let hypervolume = self.front.as_ref().filter(|front| front.len() > 0).map(Front::hypervolume);
        self.count_stall(hypervolume.map(|volume| -volume).or(best));
        let Unfinished { mut costs, failed, feasible } = std::mem::take(&mut self.unfinished);
        let [low, median, high] = [0.25, 0.5, 0.75].map(|share| quantile(&mut costs, share));
        self.history.push(Generation {
            generation: self.generations(),
            evaluations: self.evaluations,
            best,
            median,
            spread: low.zip(high).map(|(low, high)| high - low),
            failed,
            feasible,
            front: self.front.as_ref().map(Front::len),
            hypervolume,
            seconds: self.seconds(),
        });
    }

    /// `cost`: of the best feasible candidate, or minus the hypervolume of the front.
    fn count_stall(&mut self, cost: Option<f64>) {
        let best = self.archive.best();
        let now = best.map(|best| Reached { violation: best.violation, cost: cost.unwrap_or(f64::MAX) });
        let gained = match (self.reached, now) {
            (None, Some(_)) => true,
            (Some(old), Some(new)) => new.gains_on(old),
            _ => false,
        };
        self.stalled = if gained { 0 } else { self.stalled + 1 };
        if gained {
            self.reached = now;
        }
    }
}

/// The order statistic at this share of the values (no interpolation), which reorders them.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index below the length")]
fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let index = (share * last as f64).round() as usize;
    Some(*values.select_nth_unstable_by(index, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Status;

    fn add(record: &mut Record, costs: &[f64]) -> Generation {
        let rows: Vec<f64> = (0..costs.len()).map(|i| (record.evaluations as usize + i) as f64).collect();
        let status = costs.iter().map(|c| if c.is_nan() { Status::NOT_FINITE } else { Status::OK }).collect();
        record.add(&Population::from_rows(1, rows), &Evaluation::new(1, costs.to_vec(), status));
        record.finish_generation();
        record.history.last().expect("a row").clone()
    }

    #[test]
    fn rows_of_the_history() {
        let mut record = Record::new(1);
        let lost = add(&mut record, &[f64::NAN, f64::NAN]);
        assert_eq!((lost.best, lost.median, lost.spread, lost.failed), (None, None, None, 2));
        let row = add(&mut record, &[5.0, 1.0, f64::NAN, 3.0, 2.0, 4.0]);
        assert_eq!((row.generation, row.evaluations, row.failed), (1, 8, 1));
        assert_eq!((row.best, row.median, row.spread), (Some(1.0), Some(3.0), Some(2.0)));
        assert_eq!(add(&mut record, &[7.0]).best, Some(1.0), "best of the whole search");
        assert_eq!((record.failed, record.history.len()), (3, 3));
    }

    #[test]
    fn stall_counts_generations_without_a_relative_gain() {
        let mut record = Record::new(1);
        let steps = [(f64::NAN, 1), (-1.0, 0), (-1.0 - 1e-10, 1), (-1.0 - 5e-10, 2), (-1.0 - 2e-9, 0), (-0.5, 1)];
        for (cost, stalled) in steps {
            add(&mut record, &[cost]);
            assert_eq!(record.stalled, stalled, "after {cost}");
        }
    }
}
