//! What a run says about its filter, collected row by row so that no run needs to be kept.

use super::band::Band;
use super::distribution::Counts;
use super::whiteness::{Whiteness, normalised, number};
use super::{Consistency, Nees, Uncertainty, Verdict, verdict};
use crate::data::Log;
use crate::model::Problem;
use crate::reference::Step;

/// Measured rows of each trajectory after which P0 and x0 are taken to be forgotten.
pub(super) const SETTLING: usize = 20;

/// The evidence of a run so far. Beyond sums it holds the normalised innovations, one number per measured component.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// Number of states.
    states: usize,
    measurements: Vec<String>,
    nis: Sum,
    /// NIS without the first [`SETTLING`] measured rows of each trajectory.
    settled: Sum,
    nees: Sum,
    /// NIS of single rows.
    distribution: Counts,
    /// Measured rows of each trajectory.
    measured: Vec<usize>,
    /// Normalised innovations by measurement and trajectory.
    series: Vec<Vec<Vec<f64>>>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    total: f64,
    count: usize,
}

impl Sum {
    fn add(&mut self, value: f64, count: usize) {
        self.total += value;
        self.count += count;
    }
}

impl Evidence {
    /// None yet, for a run of `problem` over `log`.
    #[must_use]
    pub fn new(problem: &Problem, log: &Log) -> Self {
        let trajectories = log.trajectories.len();
        Self {
            states: problem.model.states.len(),
            measurements: log.measurements.clone(),
            nis: Sum::default(),
            settled: Sum::default(),
            nees: Sum::default(),
            distribution: Counts::new(log.measurements.len()),
            measured: vec![0; trajectories],
            series: vec![vec![Vec::new(); trajectories]; log.measurements.len()],
        }
    }

    /// The next row of a trajectory.
    ///
    /// # Panics
    /// If the log has no such trajectory.
    pub fn add(&mut self, trajectory: usize, step: &Step) {
        if let Some(nees) = step.nees {
            self.nees.add(nees, 1);
        }
        let Some(update) = &step.update else { return };
        self.nis.add(update.nis, update.present.len());
        self.distribution.add(update.nis, update.present.len());
        self.measured[trajectory] += 1;
        if self.measured[trajectory] > SETTLING {
            self.settled.add(update.nis, update.present.len());
        }
        for (&i, value) in update.present.iter().zip(normalised(update)) {
            self.series[i][trajectory].push(value);
        }
    }

    /// A row that is not judged, before those that are: it counts only towards forgetting P0 and x0.
    ///
    /// # Panics
    /// As [`Self::add`].
    pub fn pass(&mut self, trajectory: usize, step: &Step) {
        self.measured[trajectory] += usize::from(step.update.is_some());
    }

    /// Rows that updated the filter so far.
    #[must_use]
    pub fn measured_rows(&self) -> usize {
        self.measured.iter().sum()
    }

    /// The judgement on the whole run of `candidate`.
    #[must_use]
    pub fn judge(&self, problem: &Problem, candidate: &[f64]) -> Consistency {
        let nis = Band::of(self.nis.total, number(self.nis.count));
        let mut consistency = Consistency {
            nis_mean: nis.mean,
            nis_low: nis.low,
            nis_high: nis.high,
            nis_settled: self.settled.total / number(self.settled.count),
            components: self.nis.count,
            verdict: Verdict::NothingMeasured,
            findings: Vec::new(),
            whiteness: Whiteness::of(&self.measurements, &self.series),
            nees: self.nees(),
            nis_distribution: self.distribution.judge(),
            uncertainty: Uncertainty::default(),
        };
        consistency.findings = verdict::findings(&consistency, &problem.parameters, candidate);
        if let Some(headline) = consistency.findings.first() {
            consistency.verdict = headline.verdict;
        }
        consistency
    }

    fn nees(&self) -> Option<Nees> {
        let Sum { total, count: rows } = self.nees;
        let band = Band::of(total, number(rows * self.states));
        let nees = Nees { nees_mean: band.mean, nees_low: band.low, nees_high: band.high, rows };
        (rows > 0).then_some(nees)
    }
}
