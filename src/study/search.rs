//! The one loop of ask, evaluate, tell.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::record::Record;
use super::{Coordinates, Observer, Snapshot, StopReason, StudyError, stop};
use crate::evaluate::{Evaluator, Population};
use crate::model::TuneSpec;
use crate::optimize::Optimizer;

pub(super) struct Search<'s> {
    tune: &'s TuneSpec,
    coordinates: &'s Coordinates,
    optimizer: &'s mut dyn Optimizer,
    evaluator: &'s mut dyn Evaluator,
    record: &'s mut Record,
    /// The optimiser's state after the last finished generation, where an observer keeps states. It is taken before the
    /// next [`Optimizer::ask`], which may move the population and then be the last.
    saved: Option<Vec<u8>>,
}

impl<'s> Search<'s> {
    pub(super) const fn new(
        tune: &'s TuneSpec,
        coordinates: &'s Coordinates,
        optimizer: &'s mut dyn Optimizer,
        evaluator: &'s mut dyn Evaluator,
        record: &'s mut Record,
    ) -> Self {
        Self { tune, coordinates, optimizer, evaluator, record, saved: None }
    }

    /// With the state that the optimiser was restored from.
    pub(super) fn restored(mut self, saved: Option<&[u8]>) -> Self {
        self.saved = saved.map(<[u8]>::to_vec);
        self
    }

    /// Until something ends it.
    pub(super) fn run(
        &mut self,
        observers: &mut [&mut dyn Observer],
        interrupt: &AtomicBool,
    ) -> Result<StopReason, StudyError> {
        let keeps_states = observers.iter().any(|observer| observer.keeps_states());
        loop {
            let ended = match stop::reason(self.tune, self.record, interrupt) {
                Some(reason) => Some(reason),
                None => self.generation(interrupt)?,
            };
            if let Some(reason) = ended {
                self.end(observers);
                return Ok(reason);
            }
            self.saved = if keeps_states { self.optimizer.save() } else { None };
            self.show_generation(observers);
            self.show_state(observers, false);
        }
    }

    /// One generation, in as many parts as the optimiser has it; the reason if the search ends instead. Of the stops
    /// only those that cannot wait are looked at between parts.
    fn generation(&mut self, interrupt: &AtomicBool) -> Result<Option<StopReason>, StudyError> {
        loop {
            let Some(positions) = self.optimizer.ask() else {
                return Ok(Some(StopReason::Generations));
            };
            if !self.fits(positions.len())? {
                return Ok(Some(StopReason::Evaluations));
            }
            self.part(&positions)?;
            if self.optimizer.generation_finished() {
                self.record.finish_generation();
                return Ok(None);
            }
            if interrupt.load(Ordering::Relaxed) {
                return Ok(Some(StopReason::Interrupted));
            }
        }
    }

    /// Whether so many candidates fit in the evaluations allowed; the first ones must.
    fn fits(&self, population: usize) -> Result<bool, StudyError> {
        let allowed = self.tune.evaluations.unwrap_or(u64::MAX);
        let fits = self.record.evaluations + population as u64 <= allowed;
        if !fits && self.record.evaluations == 0 {
            return Err(StudyError::BudgetTooSmall { evaluations: allowed, population });
        }
        Ok(fits)
    }

    fn part(&mut self, positions: &Population) -> Result<(), StudyError> {
        let candidates = self.coordinates.candidates(positions);
        let clock = Instant::now();
        let costs = super::evaluate(self.evaluator, &candidates)?;
        self.record.evaluate_s += clock.elapsed().as_secs_f64();
        self.optimizer.tell(positions, &costs.penalised());
        if let Some(start) = self.coordinates.start().filter(|_| self.record.generations() == 0) {
            self.record.keep_start(start, &candidates, &costs);
        }
        self.record.add(&candidates, &costs);
        Ok(())
    }

    /// What was evaluated of a generation that did not end is a row of the history, but nothing to resume from: that
    /// stays the generation before.
    fn end(&mut self, observers: &mut [&mut dyn Observer]) {
        if self.record.is_unfinished() {
            self.record.finish_generation();
            self.show_generation(observers);
        } else {
            self.show_state(observers, true);
        }
    }

    fn show_generation(&self, observers: &mut [&mut dyn Observer]) {
        let best = self.record.archive.best();
        let row = self.record.history.last();
        row.iter().for_each(|row| observers.iter_mut().for_each(|observer| observer.generation(row, best)));
    }

    fn show_state(&self, observers: &mut [&mut dyn Observer], ended: bool) {
        let Some(saved) = &self.saved else { return };
        let make = || Snapshot::of(self.optimizer.name(), saved.clone(), self.record, self.evaluator.device());
        observers.iter_mut().for_each(|observer| observer.state(&make, ended));
    }
}
