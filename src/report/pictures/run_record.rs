//! What the pictures of a filter run need, collected row by row in memory that does not grow with the log.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::histogram::Histogram;
use super::plan::{Axes, MOST};
use super::track::Track;
use crate::data::{HeldOut, Log, SplitBy};
use crate::model::{ExprKind, Model, Problem, Symbol};
use crate::reference::{Estimate, Step, Update};
use crate::report::consistency::normalised;

/// A filter run as its pictures need it.
///
/// Histograms are of all trajectories; what is drawn over time is of one, that with the largest mean NIS. Where held-out
/// rows are shown, these alone count for histograms, NIS and the choice of that trajectory.
#[derive(Debug, Clone)]
pub struct RunRecord<'a> {
    pub(super) problem: &'a Problem,
    pub(super) log: &'a Log,
    /// The first row of each trajectory that counts, where held-out rows are shown.
    held_out: Option<&'a HeldOut>,
    /// For each state that is drawn, the measurement that is this state.
    pub(super) measured_as: Vec<Option<usize>>,
    /// 95 % of NIS with 0, 1, 2, ... components lie in these.
    bands: Vec<[f64; 2]>,
    /// The states that are a place on a plane.
    pub(super) axes: Option<Axes>,
    /// Normalised innovations by measurement.
    pub(super) histograms: Vec<Histogram>,
    pub(super) nis: Nis,
    current: Option<Track>,
    worst: Option<Track>,
}

/// NIS over the whole log.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Nis {
    pub(super) sum: f64,
    pub(super) components: usize,
    pub(super) rows: usize,
    /// Rows within their 95 % band.
    pub(super) inside: usize,
}

impl<'a> RunRecord<'a> {
    /// Nothing yet, for a run of `problem` over `log`.
    #[must_use]
    pub fn new(problem: &'a Problem, log: &'a Log) -> Self {
        let m = log.measurements.len();
        let states = problem.model.states.len().min(MOST);
        Self {
            problem,
            log,
            held_out: None,
            measured_as: (0..states).map(|state| measurement_of(&problem.model, state)).collect(),
            bands: (0..=m).map(nis_band).collect(),
            axes: Axes::of(problem, log),
            histograms: vec![Histogram::default(); m],
            nis: Nis::default(),
            current: None,
            worst: None,
        }
    }

    /// Nothing yet, for a run of `problem` over what is held out and the rows before it.
    #[must_use]
    pub fn of_held_out(problem: &'a Problem, held_out: &'a HeldOut) -> Self {
        Self { held_out: Some(held_out), ..Self::new(problem, &held_out.log) }
    }

    /// The next row of trajectory number `trajectory`; rows come in order, trajectory by trajectory.
    ///
    /// # Panics
    /// If the log has no such trajectory or row.
    pub fn add(&mut self, trajectory: usize, step: &Step) {
        if self.current.as_ref().is_none_or(|track| track.trajectory != trajectory) {
            self.close();
            self.current = Some(Track::new(trajectory, self.log, self.problem, self.axes));
        }
        let band = step.update.as_ref().and_then(|update| self.bands.get(update.present.len())).copied();
        let counts = self.held_out.is_none_or(|held_out| step.row >= held_out.from[trajectory]);
        if let (Some(update), true) = (&step.update, counts) {
            self.judge(update, band);
        }
        if let Some(track) = &mut self.current {
            track.add(self.log, step, band, counts);
        }
    }

    fn judge(&mut self, update: &Update, band: Option<[f64; 2]>) {
        self.nis.sum += update.nis;
        self.nis.components += update.present.len();
        self.nis.rows += 1;
        self.nis.inside += usize::from(band.is_some_and(|[low, high]| (low..=high).contains(&update.nis)));
        for (&i, value) in update.present.iter().zip(normalised(update)) {
            self.histograms[i].add(value);
        }
    }

    /// Ends a trajectory: the one with the largest mean NIS stays, the first of equals.
    fn close(&mut self) {
        if let Some(mut track) = self.current.take() {
            track.close();
            let worse = self.worst.as_ref().is_none_or(|worst| track.mean_nis() > worst.mean_nis());
            if worse {
                self.worst = Some(track);
            }
        }
    }

    /// Ends the run. Gives the index of the trajectory that is drawn over time; `None` if no row came.
    pub fn finish(&mut self) -> Option<usize> {
        self.close();
        self.worst.as_ref().map(|track| track.trajectory)
    }

    /// The smoothed estimates of the trajectory that [`Self::finish`] gave, in order of time.
    pub fn add_smoothed<'e>(&mut self, rows: impl IntoIterator<Item = (f64, &'e Estimate)>) {
        let Some(track) = &mut self.worst else { return };
        for (row, (time, estimate)) in rows.into_iter().enumerate() {
            let states = track.states.iter_mut().zip(&estimate.x);
            states.for_each(|(series, value)| series.smoothed.push(time, *value));
            if let Some(plan) = &mut track.plan {
                plan.add_smoothed(row, estimate);
            }
        }
    }

    pub(super) const fn track(&self) -> Option<&Track> {
        self.worst.as_ref()
    }

    /// What is held out of the rows shown, if held-out rows are shown.
    pub(super) fn held_out_by(&self) -> Option<SplitBy> {
        self.held_out.map(|held_out| held_out.by)
    }

    /// Time between the last training row and the first held-out row of the trajectory drawn, where both are shown.
    pub(super) fn boundary(&self) -> Option<f64> {
        let (held_out, track) = (self.held_out?, self.track()?);
        let times = &self.log.trajectories[track.trajectory].time;
        let first = held_out.from[track.trajectory];
        let before = times.get(first.checked_sub(1)?)?;
        Some(before.midpoint(*times.get(first)?))
    }
}

/// The measurement that is state number `state` and nothing else.
fn measurement_of(model: &Model, state: usize) -> Option<usize> {
    model.h.iter().position(|h| h.kind == ExprKind::Symbol(Symbol::State(state)))
}

/// 95 % of chi-square with so many degrees of freedom.
fn nis_band(components: usize) -> [f64; 2] {
    let chi2 = ChiSquared::new(components as f64);
    [0.025, 0.975].map(|share| chi2.as_ref().map_or(f64::NAN, |chi2| chi2.inverse_cdf(share)))
}
