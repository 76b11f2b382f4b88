//! One trajectory of a filter run, as its pictures need it.

use super::fan::{DOTS, Fan};
use super::plan::{Axes, MOST, Plan};
use crate::chart::{Envelope, longest};
use crate::data::{Log, Trajectory};
use crate::model::{Angles, Problem};
use crate::reference::{Step, Update};

/// One trajectory over time.
#[derive(Debug, Clone)]
pub(super) struct Track {
    pub(super) trajectory: usize,
    angles: Angles,
    nis_sum: f64,
    components: usize,
    pub(super) states: Vec<StateSeries>,
    pub(super) measurements: Vec<MeasurementSeries>,
    pub(super) nis: Envelope,
    pub(super) nis_band: Envelope,
    /// Of a long trajectory.
    pub(super) nis_fan: Option<Fan>,
    /// Where two states are a place on a plane.
    pub(super) plan: Option<Plan>,
    /// Probabilities of the modes after each row.
    pub(super) modes: Vec<Envelope>,
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
    pub(super) error_fan: Option<Fan>,
    /// Rows whose error lies within three standard deviations.
    pub(super) within: Share,
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
    pub(super) fan: Option<Fan>,
    /// Plus and minus two standard deviations.
    pub(super) band: Envelope,
    /// Innovation / sqrt(S).
    pub(super) normalised: Envelope,
    pub(super) normalised_fan: Option<Fan>,
    /// Rows whose innovation lies within two standard deviations.
    pub(super) within: Share,
}

/// How many rows of those that count are within a band.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Share {
    pub(super) inside: usize,
    pub(super) rows: usize,
}

impl Share {
    fn add(&mut self, counts: bool, is_inside: bool) {
        self.rows += usize::from(counts);
        self.inside += usize::from(counts && is_inside);
    }

    /// In per cent; 0 without rows.
    pub(super) fn per_cent(self) -> f64 {
        100.0 * self.inside as f64 / self.rows.max(1) as f64
    }
}

/// A fan for a series with values at these times, where they are too many for dots.
fn fan(times: &[f64]) -> Option<Fan> {
    (times.len() > DOTS).then(|| Fan::new(times.len(), longest(times.iter().copied())))
}

/// Times of the rows that `is_there` says.
fn times_where(trajectory: &Trajectory, is_there: impl Fn(usize) -> bool) -> Vec<f64> {
    (0..trajectory.len()).filter(|k| is_there(*k)).map(|k| trajectory.time[k]).collect()
}

fn push(fan: &mut Option<Fan>, time: f64, value: f64) {
    if let Some(fan) = fan {
        fan.push(time, value);
    }
}

impl StateSeries {
    fn new(log: &Log, trajectory: &Trajectory, name: &str) -> Self {
        let new = || Envelope::new(trajectory.len());
        let truth_column = log.truth.iter().position(|truth| truth == name);
        let known = |k: usize| truth_column.is_some_and(|column| !trajectory.truth.row(k)[column].is_nan());
        Self {
            estimate: new(),
            band: new(),
            truth_column,
            truth: new(),
            error: new(),
            deviation: new(),
            error_fan: fan(&times_where(trajectory, known)),
            within: Share::default(),
            smoothed: new(),
        }
    }
}

impl MeasurementSeries {
    fn new(trajectory: &Trajectory, i: usize) -> Self {
        let new = || Envelope::new(trajectory.len());
        let fan = fan(&times_where(trajectory, |k| !trajectory.z.row(k)[i].is_nan()));
        Self {
            measured: new(),
            predicted: new(),
            predicted_band: new(),
            innovation: new(),
            fan: fan.clone(),
            band: new(),
            normalised: new(),
            normalised_fan: fan,
            within: Share::default(),
        }
    }

    /// The innovation `nu` of a measured value with its standard deviation.
    fn add(&mut self, time: f64, z: f64, [nu, deviation]: [f64; 2], counts: bool) {
        let predicted = z - nu;
        self.innovation.push(time, nu);
        self.band.push_band(time, [-2.0 * deviation, 2.0 * deviation]);
        self.normalised.push(time, nu / deviation);
        push(&mut self.fan, time, nu);
        push(&mut self.normalised_fan, time, nu / deviation);
        self.within.add(counts, nu.abs() <= 2.0 * deviation);
        self.predicted.push(time, predicted);
        self.predicted_band.push_band(time, [predicted - 3.0 * deviation, predicted + 3.0 * deviation]);
    }
}

impl Track {
    pub(super) fn new(trajectory: usize, log: &Log, problem: &Problem, axes: Option<Axes>) -> Self {
        let model = &problem.model;
        let of: &Trajectory = &log.trajectories[trajectory];
        let measured = times_where(of, |k| of.z.row(k).iter().any(|z| !z.is_nan()));
        Self {
            trajectory,
            angles: model.angles.clone(),
            nis_sum: 0.0,
            components: 0,
            states: model.states.iter().take(MOST).map(|name| StateSeries::new(log, of, name)).collect(),
            measurements: (0..of.z.columns().min(MOST)).map(|i| MeasurementSeries::new(of, i)).collect(),
            nis: Envelope::new(of.len()),
            nis_band: Envelope::new(of.len()),
            nis_fan: fan(&measured),
            plan: axes.map(|axes| Plan::new(axes, of.len())),
            modes: problem.modes.iter().map(|_| Envelope::new(of.len())).collect(),
        }
    }

    /// NaN is never the worst.
    pub(super) fn mean_nis(&self) -> f64 {
        if self.components == 0 { f64::NEG_INFINITY } else { self.nis_sum / self.components as f64 }
    }

    /// The next row; `counts` where it is one of those that are judged.
    pub(super) fn add(&mut self, log: &Log, step: &Step, band: Option<[f64; 2]>, counts: bool) {
        let (time, trajectory) = (step.time, &log.trajectories[self.trajectory]);
        for (i, series) in self.states.iter_mut().enumerate() {
            let (x, deviation) = (step.posterior.x[i], step.posterior.p[(i, i)].sqrt());
            series.estimate.push(time, x);
            series.band.push_band(time, [x - 3.0 * deviation, x + 3.0 * deviation]);
            if let Some(column) = series.truth_column {
                let truth = trajectory.truth.row(step.row)[column];
                let error = self.angles.between_states(i, x - truth);
                // An angle is drawn on the turn of its estimate.
                series.truth.push(time, if self.angles.state(i) { x - error } else { truth });
                series.error.push(time, error);
                series.deviation.push_band(time, [-3.0 * deviation, 3.0 * deviation]);
                push(&mut series.error_fan, time, error);
                series.within.add(counts && !truth.is_nan(), error.abs() <= 3.0 * deviation);
            }
        }
        for (series, z) in self.measurements.iter_mut().zip(trajectory.z.row(step.row)) {
            series.measured.push(time, *z);
        }
        for (series, probability) in self.modes.iter_mut().zip(&step.modes) {
            series.push(time, *probability);
        }
        if let Some(plan) = &mut self.plan {
            plan.add(trajectory, step);
        }
        if let Some(update) = &step.update {
            self.update(trajectory.z.row(step.row), update, (time, band), counts);
        }
    }

    fn update(&mut self, z: &[f64], update: &Update, (time, band): (f64, Option<[f64; 2]>), counts: bool) {
        if counts {
            self.nis_sum += update.nis;
            self.components += update.present.len();
        }
        self.nis.push(time, update.nis);
        self.nis_band.push_band(time, band.unwrap_or([f64::NAN; 2]));
        push(&mut self.nis_fan, time, update.nis);
        for (at, &i) in update.present.iter().enumerate().filter(|(_, i)| **i < MOST) {
            self.measurements[i].add(time, z[i], [update.nu[at], update.s[(at, at)].sqrt()], counts);
        }
    }

    /// Ends the trajectory.
    pub(super) fn close(&mut self) {
        let fans = self.measurements.iter_mut().flat_map(|m| [&mut m.fan, &mut m.normalised_fan]);
        let fans = fans.chain(self.states.iter_mut().map(|s| &mut s.error_fan)).chain([&mut self.nis_fan]);
        fans.flatten().for_each(Fan::close);
    }
}
