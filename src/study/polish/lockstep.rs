//! Local searches side by side: one batch holds what all of them ask for.

use super::{Ended, Place};
use crate::evaluate::{Evaluation, Population};
use crate::optimize::LocalSearch;
use crate::study::{Archive, StudyError};

/// The one number that a search minimises.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Goal {
    /// This objective.
    One(usize),
    /// The sum of all, each measured from its best in units of its range.
    Scaled(Vec<[f64; 2]>),
}

impl Goal {
    fn of(&self, costs: &[f64]) -> f64 {
        match self {
            Self::One(j) => costs[*j],
            Self::Scaled(ranges) => costs.iter().zip(ranges).map(|(c, [best, range])| (c - best) / range).sum(),
        }
    }

    /// What a search for one number is told: infeasible candidates cost more than every other.
    fn costs(&self, told: &Evaluation, rows: std::ops::Range<usize>) -> Evaluation {
        let status = rows.clone().map(|i| told.status(i)).collect();
        let costs = rows.clone().map(|i| self.of(told.costs(i))).collect();
        let violation = rows.map(|i| told.violation(i)).collect();
        Evaluation::new(1, costs, status).with_violation(violation).penalised().into_owned()
    }
}

/// One search, and the best candidates that it was told of.
pub(super) struct Run {
    pub(super) search: Box<dyn LocalSearch>,
    pub(super) goal: Goal,
    pub(super) seen: Archive,
}

impl Run {
    pub(super) fn new(search: impl LocalSearch + 'static, goal: Goal) -> Self {
        Self { search: Box::new(search), goal, seen: Archive::new(1) }
    }

    /// Where it has come to.
    pub(super) fn cost(&self) -> f64 {
        self.search.best().map_or(f64::INFINITY, |(_, cost)| cost)
    }
}

impl Place<'_> {
    /// Until every search has ended, `enough` holds, or something stops them: then why. Gives the evaluations too.
    pub(super) fn lockstep(
        &mut self,
        runs: &mut [Run],
        enough: impl Fn(&[Run]) -> bool,
    ) -> Result<(usize, Ended), StudyError> {
        let mut evaluations = 0;
        loop {
            if let Some(why) = self.stopped() {
                return Ok((evaluations, why));
            }
            let asked: Vec<Option<Population>> = runs.iter_mut().map(|run| run.search.ask()).collect();
            let mut batch = Population::new(self.coordinates.dimension());
            asked.iter().flatten().flat_map(Population::rows).for_each(|row| batch.push(row));
            if batch.is_empty() || enough(runs) {
                return Ok((evaluations, Ended::Done));
            }
            let candidates = self.coordinates.candidates(&batch);
            let told = crate::study::evaluate(self.evaluator, &candidates)?;
            evaluations += batch.len();
            let mut from = 0;
            for (run, asked) in runs.iter_mut().zip(asked) {
                let Some(asked) = asked else { continue };
                let rows = from..from + asked.len();
                from = rows.end;
                let costs = run.goal.costs(&told, rows.clone());
                let mut own = Population::new(candidates.dimension());
                rows.for_each(|i| own.push(candidates.row(i)));
                run.seen.add(&own, &costs);
                run.search.tell(&asked, &costs);
            }
        }
    }
}
