//! What the pictures of a filter run need, collected row by row in memory that does not grow with the log.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::envelope::Envelope;
use super::histogram::Histogram;
use crate::data::{HeldOut, Log, Trajectory};
use crate::model::{ExprKind, Model, Problem, SplitBy, Symbol};
use crate::reference::{Estimate, Step, Update};
use crate::report::consistency::normalised;

/// Most states, and most measurements, that are drawn.
pub(super) const MOST: usize = 6;

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

/// One trajectory over time.
#[derive(Debug, Clone)]
pub(super) struct Track {
    pub(super) trajectory: usize,
    nis_sum: f64,
    components: usize,
    pub(super) states: Vec<StateSeries>,
    pub(super) measurements: Vec<MeasurementSeries>,
    pub(super) nis: Envelope,
    pub(super) nis_band: Envelope,
}

#[derive(Debug, Clone)]
pub(super) struct StateSeries {
    pub(super) estimate: Envelope,
    /// Plus and minus three standard deviations.
    pub(super) band: Envelope,
    /// Column of truth in the log.
    truth_column: Option<usize>,
    pub(super) truth: Envelope,
    /// Estimate minus truth, and plus and minus three standard deviations.
    pub(super) error: Envelope,
    pub(super) deviation: Envelope,
    pub(super) smoothed: Envelope,
}

#[derive(Debug, Clone)]
pub(super) struct MeasurementSeries {
    pub(super) measured: Envelope,
    /// What the filter expected.
    pub(super) predicted: Envelope,
    /// Plus and minus three of its standard deviations.
    pub(super) predicted_band: Envelope,
    pub(super) innovation: Envelope,
    /// Plus and minus two standard deviations.
    pub(super) band: Envelope,
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
            self.current = Some(Track::new(trajectory, self.log, &self.problem.model.states));
        }
        let band = step.update.as_ref().and_then(|update| self.bands.get(update.present.len())).copied();
        let counts = self.held_out.is_none_or(|held_out| step.row >= held_out.from[trajectory]);
        if let (Some(update), true) = (&step.update, counts) {
            self.judge(update, band);
        }
        if let Some(track) = &mut self.current {
            track.count(step.update.as_ref().filter(|_| counts));
            track.add(self.log, step, band);
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
        if let Some(track) = self.current.take() {
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
        for (time, estimate) in rows {
            let states = track.states.iter_mut().zip(&estimate.x);
            states.for_each(|(series, value)| series.smoothed.push(time, *value));
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

impl Track {
    fn new(trajectory: usize, log: &Log, states: &[String]) -> Self {
        let of: &Trajectory = &log.trajectories[trajectory];
        let new = || Envelope::new(of.len());
        let state = |name: &String| {
            let truth_column = log.truth.iter().position(|truth| truth == name);
            let (truth, error, deviation) = (new(), new(), new());
            let (estimate, band, smoothed) = (new(), new(), new());
            StateSeries { estimate, band, truth_column, truth, error, deviation, smoothed }
        };
        let measurement = || MeasurementSeries {
            measured: new(),
            predicted: new(),
            predicted_band: new(),
            innovation: new(),
            band: new(),
        };
        Self {
            trajectory,
            nis_sum: 0.0,
            components: 0,
            states: states.iter().take(MOST).map(state).collect(),
            measurements: std::iter::repeat_with(measurement).take(of.z.columns().min(MOST)).collect(),
            nis: new(),
            nis_band: new(),
        }
    }

    /// NaN is never the worst.
    fn mean_nis(&self) -> f64 {
        if self.components == 0 { f64::NEG_INFINITY } else { self.nis_sum / self.components as f64 }
    }

    fn count(&mut self, update: Option<&Update>) {
        self.nis_sum += update.map_or(0.0, |update| update.nis);
        self.components += update.map_or(0, |update| update.present.len());
    }

    fn add(&mut self, log: &Log, step: &Step, band: Option<[f64; 2]>) {
        let (time, trajectory) = (step.time, &log.trajectories[self.trajectory]);
        for (i, series) in self.states.iter_mut().enumerate() {
            let (x, deviation) = (step.posterior.x[i], step.posterior.p[(i, i)].sqrt());
            series.estimate.push(time, x);
            series.band.push_band(time, [x - 3.0 * deviation, x + 3.0 * deviation]);
            if let Some(column) = series.truth_column {
                let truth = trajectory.truth.row(step.row)[column];
                series.truth.push(time, truth);
                series.error.push(time, x - truth);
                series.deviation.push_band(time, [-3.0 * deviation, 3.0 * deviation]);
            }
        }
        for (series, z) in self.measurements.iter_mut().zip(trajectory.z.row(step.row)) {
            series.measured.push(time, *z);
        }
        let Some(update) = &step.update else { return };
        self.nis.push(time, update.nis);
        self.nis_band.push_band(time, band.unwrap_or([f64::NAN; 2]));
        for (at, &i) in update.present.iter().enumerate().filter(|(_, i)| **i < MOST) {
            let (nu, deviation) = (update.nu[at], update.s[(at, at)].sqrt());
            let predicted = trajectory.z.row(step.row)[i] - nu;
            let series = &mut self.measurements[i];
            series.innovation.push(time, nu);
            series.band.push_band(time, [-2.0 * deviation, 2.0 * deviation]);
            series.predicted.push(time, predicted);
            series.predicted_band.push_band(time, [predicted - 3.0 * deviation, predicted + 3.0 * deviation]);
        }
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
