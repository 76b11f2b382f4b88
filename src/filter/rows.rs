//! The rows a filter runs over.

use crate::data::{Log, Trajectory};
use crate::model::{Problem, Start};
use std::ops::Range;

/// The rows a filter runs over, trajectory after trajectory.
#[derive(Debug, Clone)]
pub(crate) struct Rows<'a> {
    pub(super) log: &'a Log,
    /// For each trajectory its first used row (rows before a start from a measurement are skipped).
    pub(super) first: Vec<usize>,
    /// Whether x0 comes from the measurement of the first used row, which then gets no update.
    pub(super) from_measurement: bool,
}

impl<'a> Rows<'a> {
    pub(super) fn new(problem: &Problem, log: &'a Log) -> Self {
        let from_measurement = problem.model.x0 == Start::Measurement;
        let start = |t: &Trajectory| (0..t.len()).find(|k| t.is_complete(*k)).unwrap_or(t.len());
        let first = log.trajectories.iter().map(|t| if from_measurement { start(t) } else { 0 }).collect();
        Self { log, first, from_measurement }
    }

    /// The rows of each trajectory, counted over the whole record.
    pub(super) fn spans(&self) -> Vec<Range<usize>> {
        let mut next = 0;
        let lengths = self.log.trajectories.iter().zip(&self.first).map(|(t, first)| t.len() - first);
        lengths
            .map(|length| {
                next += length;
                next - length..next
            })
            .collect()
    }

    /// For each trajectory the interval after its first used row \[s\]; 1 where it has no row.
    pub(super) fn first_intervals(&self) -> Vec<f64> {
        let trajectories = self.log.trajectories.iter().zip(&self.first);
        trajectories.map(|(t, first)| if *first < t.len() { interval(t, *first) } else { 1.0 }).collect()
    }

    /// Number of used rows.
    pub(super) fn len(&self) -> usize {
        self.log.trajectories.iter().zip(&self.first).map(|(t, first)| t.len() - first).sum()
    }

    /// The last `window` rows of each trajectory that update the filter, those before `skip` left out.
    pub(crate) fn last_measured(&self, skip: usize, window: usize) -> Window {
        let mut measured = vec![Vec::new(); self.log.trajectories.len()];
        for place in self.places().filter(|place| place.k >= skip && place.components() > 0) {
            measured[place.index].push(place.k);
        }
        let begin =
            |rows: &Vec<usize>| rows.get(rows.len().saturating_sub(window.max(1))).copied().unwrap_or(usize::MAX);
        Window(measured.iter().map(begin).collect())
    }

    /// Every used row of every trajectory.
    pub(super) fn places(&self) -> impl Iterator<Item = Place<'_>> {
        let trajectories = self.log.trajectories.iter().zip(&self.first).enumerate();
        let from_measurement = self.from_measurement;
        trajectories.flat_map(move |(index, (trajectory, &first))| {
            (first..trajectory.len()).map(move |k| Place {
                trajectory,
                index,
                k,
                is_start: from_measurement && k == first,
                leads: k - first + usize::from(!from_measurement),
            })
        })
    }
}

/// For each trajectory the row from which its window of last measured rows begins.
pub(crate) struct Window(Vec<usize>);

impl Window {
    /// Whether a row stands in the window (rows without a measurement may stand between those that count).
    pub(crate) fn contains(&self, place: Place<'_>) -> bool {
        place.k >= self.0[place.index]
    }
}

/// One row of one trajectory.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub(super) trajectory: &'a Trajectory,
    /// Which trajectory.
    pub(crate) index: usize,
    /// Row, counted from the trajectory's first row in the log.
    pub(crate) k: usize,
    /// Whether x0 comes from this row, which therefore gets no update.
    is_start: bool,
    leads: usize,
}

impl Place<'_> {
    /// Whether measurement `i` is present and updates the filter.
    pub(crate) fn present(&self, i: usize) -> bool {
        !self.is_start && !self.trajectory.z.row(self.k)[i].is_nan()
    }

    /// The most rows ahead of which the filter could predict this one: x0 counts as the estimate of the row before the first, or
    /// where it comes from the first used row, of that.
    pub(crate) const fn leads(&self) -> usize {
        self.leads
    }

    /// Number of present components.
    pub(crate) fn components(&self) -> usize {
        (0..self.trajectory.z.columns()).filter(|i| self.present(*i)).count()
    }

    /// Truth of column `i`, NaN where unknown.
    pub(crate) fn truth(&self, i: usize) -> f64 {
        self.trajectory.truth.row(self.k)[i]
    }

    /// Interval to the next row [s]; after the last row, where nothing is predicted any more, the one before it.
    pub(super) fn dt(&self) -> f64 {
        interval(self.trajectory, self.k)
    }
}

fn interval(t: &Trajectory, k: usize) -> f64 {
    t.dt(k).or_else(|| t.dt(k.checked_sub(1)?)).unwrap_or(1.0)
}
