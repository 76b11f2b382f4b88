//! What a run says about its filter, collected row by row so that no run needs to be kept.

use super::band::Band;
use super::rows::{RowNis, SETTLING, Sum, number};
use super::sensors::Sensors;
use super::whiteness::{Whiteness, normalised};
use super::{
    Consistency, ModeUse, Nees, NisDistribution, NisOverTime, Rejected, Uncertainty, Verdict, dominating, findings,
    mean, over_time,
};
use crate::data::Log;
use crate::model::Problem;
use crate::reference::{Run, Step};

/// The evidence of a run so far. It holds the NIS of each measured row and the normalised innovations, one number per
/// measured component.
#[derive(Debug, Clone)]
pub struct Evidence<'a> {
    log: &'a Log,
    /// Number of states.
    states: usize,
    rows: Vec<RowNis>,
    nees: Sum,
    sensors: Sensors,
    /// What robust updates left out; `None` where they are plain.
    rejected: Option<Rejected>,
    /// Measured rows of each trajectory.
    measured: Vec<usize>,
    /// Normalised innovations by measurement and trajectory.
    series: Vec<Vec<Vec<f64>>>,
    /// How many of them are of the first [`SETTLING`] measured rows.
    unsettled: Vec<Vec<usize>>,
    modes: Vec<ModeUse>,
}

impl<'a> Evidence<'a> {
    /// None yet, for a run of `problem` over `log`.
    #[must_use]
    pub fn new(problem: &Problem, log: &'a Log) -> Self {
        let (measurements, trajectories) = (log.measurements.len(), log.trajectories.len());
        Self {
            log,
            states: problem.model.states.len(),
            rows: Vec::new(),
            nees: Sum::default(),
            sensors: Sensors::of(&problem.data),
            rejected: problem.robust.as_ref().map(|_| Rejected::default()),
            measured: vec![0; trajectories],
            series: vec![vec![Vec::new(); trajectories]; measurements],
            unsettled: vec![vec![0; trajectories]; measurements],
            modes: problem.modes.iter().map(|mode| ModeUse::none(&mode.name)).collect(),
        }
    }

    /// The next row of a trajectory.
    ///
    /// # Panics
    /// If the log has no such trajectory.
    pub fn add(&mut self, trajectory: usize, step: &Step) {
        if let Some(nees) = step.nees {
            self.nees = Sum { total: self.nees.total + nees, count: self.nees.count + 1 };
        }
        ModeUse::add(&mut self.modes, &step.modes);
        let Some(update) = &step.update else { return };
        self.sensors.add(update);
        self.measured[trajectory] += 1;
        let number = self.measured[trajectory];
        if self.rejected.as_mut().is_some_and(|rejected| rejected.add(update.rejected)) {
            return;
        }
        let components = u32::try_from(update.present.len()).unwrap_or(u32::MAX);
        self.rows.push(RowNis { trajectory, row: step.row, nis: update.nis, components, number });
        for (&i, value) in update.present.iter().zip(normalised(update)) {
            self.series[i][trajectory].push(value);
            self.unsettled[i][trajectory] += usize::from(number <= SETTLING);
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

    /// The judgement on the whole run of `candidate`. Where the first rows are to blame, all else is judged on the rows
    /// after them; since the filter is accused then anyway, this second look costs no false alarm.
    #[must_use]
    pub fn judge(&self, problem: &Problem, candidate: &[f64]) -> Consistency {
        let (first, settled): (Vec<&RowNis>, Vec<&RowNis>) = self.rows.iter().partition(|row| row.is_first());
        let (first, settled_sum) = (Sum::of(first), Sum::of(settled.iter().copied()));
        let start = mean::start_test(first, settled_sum);
        let next = Sum::of(settled.iter().copied().filter(|row| row.is_next()));
        let is_outside = start.as_ref().is_some_and(|test| !test.pass) && mean::differ(first, next);
        let start_is_wrong = is_outside && !self.has_outliers_all_along(&settled);
        let judged = if start_is_wrong { settled } else { self.rows.iter().collect() };
        let all = Sum::of(&self.rows);
        let nis = Band::of(all.total, number(all.count));
        let (dominating_rows, dominating) = dominating::rows(self.log, &judged);
        let whiteness = Whiteness::of(&self.log.measurements, &self.judged_series(start_is_wrong));
        let nis_distribution = NisDistribution::of(&judged, self.log.measurements.len());
        let nis_over_time = NisOverTime::of(self.log, &judged);
        let tests = [
            start,
            mean::test(Sum::of(judged.iter().copied())),
            nis_over_time.as_ref().map(NisOverTime::test),
            dominating,
        ]
        .into_iter()
        .flatten()
        .chain(nis_distribution.iter().flat_map(NisDistribution::tests))
        .chain(Whiteness::tests(&whiteness, self.log.measurements.len()));
        let mut consistency = Consistency {
            nis_mean: nis.mean,
            nis_low: nis.low,
            nis_high: nis.high,
            nis_first: first.mean(),
            nis_settled: settled_sum.mean(),
            components: all.count,
            sensors: self.sensors.judge(),
            judged_after: if start_is_wrong { SETTLING } else { 0 },
            verdict: Verdict::NothingMeasured,
            findings: Vec::new(),
            tests: tests.collect(),
            nis_distribution,
            nis_over_time,
            dominating_rows,
            whiteness,
            nees: self.nees(),
            modes: self.modes.clone(),
            rejected: self.rejected,
            uncertainty: Uncertainty::default(),
        };
        consistency.findings = findings::of(&consistency, &self.log.source, &problem.parameters, candidate);
        if let Some(headline) = consistency.findings.first() {
            consistency.verdict = headline.verdict;
        }
        consistency
    }

    /// Whether the `settled` rows have heavy tails and the first ones lie among them by rank: then it is outliers that their
    /// mean is off by, as that of other stretches is, and not P0.
    fn has_outliers_all_along(&self, settled: &[&RowNis]) -> bool {
        let first: Vec<&RowNis> = self.rows.iter().filter(|row| row.is_first()).collect();
        let heavy = |found: NisDistribution| found.has_heavy_tails();
        NisDistribution::of(settled, self.log.measurements.len()).is_some_and(heavy)
            && over_time::by_ranks(&[&first, settled]) > over_time::ALIKE
    }

    /// The normalised innovations, of settled rows alone or of all.
    fn judged_series(&self, settled: bool) -> Vec<Vec<&[f64]>> {
        self.series
            .iter()
            .zip(&self.unsettled)
            .map(|(all, unsettled)| {
                let judged = all.iter().zip(unsettled);
                judged.map(|(series, first)| &series[if settled { *first } else { 0 }..]).collect()
            })
            .collect()
    }

    fn nees(&self) -> Option<Nees> {
        let Sum { total, count: rows } = self.nees;
        let band = Band::of(total, number(rows * self.states));
        let nees = Nees { nees_mean: band.mean, nees_low: band.low, nees_high: band.high, rows };
        (rows > 0).then_some(nees)
    }
}

impl Consistency {
    /// Judges the run of `candidate` (searched parameters in their own units) over `log`.
    #[must_use]
    pub fn of(problem: &Problem, log: &Log, candidate: &[f64], run: &Run) -> Self {
        let mut evidence = Evidence::new(problem, log);
        for (trajectory, steps) in run.trajectories.iter().enumerate() {
            steps.iter().for_each(|step| evidence.add(trajectory, step));
        }
        evidence.judge(problem, candidate)
    }
}
