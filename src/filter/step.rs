//! One step of a filter, traced for the rows of one kind.

use super::carried::Role;
use super::error::TraceError;
use super::evidence::Evidence;
use super::form::Carrying;
use super::leads::Leads;
use super::memory::{Recall, Remembering};
use super::nominal::Nominal;
use super::row::Row;
use super::score::{Scoring, Traced};
use super::tracer::Tracer;
use super::units::Units;
use crate::objective::Objective;
use crate::tape::Id;

/// What is to be traced.
pub(super) struct Request<'a> {
    pub(super) objectives: &'a [Objective],
    /// Around which the deviation form is traced; the absolute form without one.
    pub(super) nominal: Option<&'a Nominal>,
    pub(super) carrying: Carrying,
    pub(super) units: &'a Units,
    pub(super) watch: Option<&'a dyn Watch>,
}

/// Adds sums of its own behind those of the objectives.
pub(super) trait Watch {
    /// What is to be summed up in a row.
    fn sums(&self, t: &mut Tracer<'_>, prior: &[Id], evidence: &Evidence, posterior: &[Id]) -> Vec<(Role, Id)>;
}

/// A traced step, not yet scheduled.
pub(super) struct Traces {
    /// What is carried, after the step.
    pub(super) next: Vec<Id>,
    /// What is summed up or multiplied, as often as it was asked for.
    pub(super) sums: Vec<(Role, Id)>,
    /// What a candidate fails without, besides products.
    pub(super) positive: Vec<Id>,
    /// For each objective its sums, by their place among those asked for.
    pub(super) traced: Vec<Traced>,
}

impl Traces {
    /// Traces update, objectives and prediction from what is carried: the entries of a prior, and the memory.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    pub(super) fn new(
        t: &mut Tracer<'_>,
        filter: &Remembering,
        carried: &[Id],
        request: &Request<'_>,
    ) -> Result<Self, TraceError> {
        let (prior, remembered) = carried.split_at(carried.len() - filter.memory.len());
        let row = Row::new(t)?;
        let (evidence, posterior) = filter.family.update(t, &row, prior)?;
        let mut recall = Recall::new(&filter.memory, remembered);
        let horizons = request.objectives.iter().flat_map(|objective| objective.horizons().iter().copied());
        let leads = Leads::trace(t, filter.family.as_ref(), &row, prior, &mut recall, horizons)?;
        let mut scoring = Scoring::new(t, &evidence, &leads, recall);
        let traced =
            request.objectives.iter().enumerate().map(|(i, objective)| objective.trace(scoring.asked_by(i))).collect();
        let (mut sums, mut positive, memory) = scoring.finish();
        if let Some(watch) = request.watch {
            sums.extend(watch.sums(t, prior, &evidence, &posterior));
        }
        let predicted = filter.family.predict(t, &row, &posterior)?;
        positive.extend(predicted.positive);
        Ok(Self { next: [predicted.prior, memory].concat(), sums, positive, traced })
    }

    /// All that the step is made of.
    pub(super) fn roots(&self) -> Vec<Id> {
        let sums = self.sums.iter().map(|(_, value)| *value);
        self.next.iter().copied().chain(sums).chain(self.positive.iter().copied()).collect()
    }

    /// Puts others in the place of the [roots](Self::roots), in their order.
    pub(super) fn replace(&mut self, roots: &[Id]) {
        let sums = self.sums.iter_mut().map(|(_, value)| value);
        let own = self.next.iter_mut().chain(sums).chain(&mut self.positive);
        own.zip(roots).for_each(|(own, root)| *own = *root);
    }
}
