//! Objectives of a run, by the definitions of `docs/semantics.md`.

use std::collections::VecDeque;

use nalgebra::DVector;

use super::estimate::{Update, count};
use super::prediction::Prediction;
use super::step::{Moment, Run, Truth};
use super::uniformity::Uniformity;
use super::whiteness::Whiteness;
use crate::data::{Log, Trajectory};
use crate::model::Problem;
use crate::objective::{Kind, Objective};

/// The cost of a run under each objective; NaN where nothing scores (no measurement, or no truth).
///
/// `rmse` and `distance` take a row when truth of all their named states is there; `nees` when truth of all states is.
#[must_use]
pub fn score(problem: &Problem, log: &Log, run: &Run, objectives: &[Objective]) -> Vec<f64> {
    let truth = Truth::of(problem, log);
    let mut scorer = Scorer::new((problem, &run.candidate), &truth, objectives);
    for (index, (trajectory, steps)) in log.trajectories.iter().zip(&run.trajectories).enumerate() {
        for step in steps {
            let place = (trajectory, step.row);
            let (prior, posterior) = (&step.prior.x, &step.posterior.x);
            let seen = Seen { prior, posterior, update: step.update.as_ref(), scores: true };
            scorer.row(index, place, seen, || step.nees);
        }
    }
    scorer.costs()
}

impl Run {
    /// Sum of NIS and number of present components, rows before `skip` left out.
    #[must_use]
    pub fn nis_sum(&self, skip: usize) -> (f64, usize) {
        let updates = self.trajectories.iter().flatten().filter(|s| s.row >= skip).filter_map(|s| s.update.as_ref());
        updates.fold((0.0, 0), |(sum, components), u| (sum + u.nis, components + u.present.len()))
    }

    /// Sum of NIS / number of present components: 1 when consistent. NaN without measurements.
    #[must_use]
    pub fn nis_mean(&self) -> f64 {
        let (sum, components) = self.nis_sum(0);
        sum / count(components)
    }

    /// Sum of NEES and number of rows that have it, rows before `skip` left out.
    #[must_use]
    pub fn nees_sum(&self, skip: usize) -> (f64, usize) {
        let values = self.trajectories.iter().flatten().filter(|s| s.row >= skip).filter_map(|s| s.nees);
        values.fold((0.0, 0), |(sum, rows), nees| (sum + nees, rows + 1))
    }
}

/// What is scored of a row.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    prior: &'a DVector<f64>,
    posterior: &'a DVector<f64>,
    update: Option<&'a Update>,
    /// Whether the row counts; what is predicted from it may count later.
    scores: bool,
}

impl<'a> Seen<'a> {
    pub(super) const fn of(moment: &Moment<'a>, scores: bool) -> Self {
        Self { prior: &moment.state.prior.x, posterior: &moment.state.posterior.x, update: moment.update, scores }
    }
}

/// Adds up objectives row by row; rows come trajectory by trajectory, in order.
pub(super) struct Scorer<'a> {
    truth: &'a Truth,
    sums: Vec<Sum<'a>>,
    trajectory: usize,
}

/// One objective so far.
struct Sum<'a> {
    objective: &'a Objective,
    /// The states that `rmse` and `distance` compare: the named ones, or all that have truth.
    states: Vec<usize>,
    total: f64,
    count: usize,
    /// `mismatch`: (trace of nu nu', trace of S) of the latest measured rows of the current trajectory.
    window: VecDeque<(f64, f64)>,
    uniformity: Uniformity,
    whiteness: Whiteness,
    prediction: Option<Prediction>,
}

impl<'a> Scorer<'a> {
    pub(super) fn new((problem, candidate): (&Problem, &[f64]), truth: &'a Truth, objectives: &'a [Objective]) -> Self {
        let with_truth = || (0..truth.column.len()).filter(|&i| truth.column[i].is_some()).collect();
        let prediction = |objective: &Objective| {
            let ahead = objective.horizons();
            (objective.kind == Kind::Prediction).then(|| Prediction::new(problem, candidate, ahead))
        };
        let sum = |objective: &'a Objective| Sum {
            objective,
            states: if objective.states.is_empty() { with_truth() } else { objective.states.clone() },
            total: 0.0,
            count: 0,
            window: VecDeque::new(),
            uniformity: Uniformity::default(),
            whiteness: Whiteness::new(objective.lags),
            prediction: prediction(objective),
        };
        Self { truth, sums: objectives.iter().map(sum).collect(), trajectory: 0 }
    }

    /// One row of trajectory number `index`; `nees` is asked for only where an objective needs it.
    pub(super) fn row(
        &mut self,
        index: usize,
        (trajectory, row): (&Trajectory, usize),
        Seen { prior, posterior: x, update, scores }: Seen<'_>,
        nees: impl Fn() -> Option<f64>,
    ) {
        if index != self.trajectory {
            self.sums.iter_mut().for_each(Sum::close);
            self.trajectory = index;
        }
        for sum in &mut self.sums {
            let scores = scores && row >= sum.objective.skip;
            if let Some(prediction) = &mut sum.prediction {
                prediction.row(index, (trajectory, row), (prior, update), scores);
                continue;
            }
            if !scores {
                continue;
            }
            match (sum.objective.kind, update) {
                (Kind::Rmse | Kind::Distance, _) => sum.add_error(self.truth, (trajectory, row), x),
                (Kind::Nees | Kind::NeesMean, _) => sum.add(nees(), 1),
                (_, Some(update)) => sum.add_update(update),
                (_, None) => {}
            }
        }
    }

    pub(super) fn costs(mut self) -> Vec<f64> {
        self.sums.iter_mut().for_each(Sum::close);
        let states = count(self.truth.column.len());
        self.sums.iter().map(|sum| sum.cost(states)).collect()
    }
}

impl Sum<'_> {
    fn add(&mut self, value: Option<f64>, weight: usize) {
        if let Some(value) = value {
            self.total += value;
            self.count += weight;
        }
    }

    fn add_update(&mut self, update: &Update) {
        let components = update.present.len();
        match self.objective.kind {
            Kind::Nll => self.add(Some(update.nll), components),
            Kind::MseInnovation => self.add(Some(update.nu.norm_squared()), components),
            Kind::Rejected => self.add(Some(update.rejected), 1),
            Kind::Nis | Kind::NisMean => self.add(Some(update.nis), components),
            Kind::NisDistribution => self.uniformity.add(update),
            Kind::Whiteness => self.whiteness.add(update),
            _ => {
                if self.window.len() == self.objective.window {
                    self.window.pop_front();
                }
                self.window.push_back((update.nu.norm_squared(), update.s.trace()));
            }
        }
    }

    fn add_error(&mut self, truth: &Truth, (trajectory, row): (&Trajectory, usize), x: &DVector<f64>) {
        let squares = self.states.iter().map(|&i| truth.error(trajectory, row, i, x).map(|e| e * e));
        let Some(squared) = squares.sum::<Option<f64>>() else { return };
        let value = if self.objective.kind == Kind::Distance { squared.sqrt() } else { squared };
        self.add(Some(value), 1);
    }

    /// Ends a trajectory: its mismatch joins the mean, and no pair of innovations goes beyond it.
    fn close(&mut self) {
        self.whiteness.close();
        let Some(&(_, last)) = self.window.back() else { return };
        let ca: f64 = self.window.iter().map(|(ca, _)| ca).sum();
        let ct: f64 = self.window.iter().map(|(_, ct)| ct).sum();
        let ct = if self.objective.ct_last { last * count(self.window.len()) } else { ct };
        self.window.clear();
        self.add(Some((ca / ct - 1.0).abs()), 1);
    }

    fn cost(&self, states: f64) -> f64 {
        let mean = self.total / count(self.count);
        match self.objective.kind {
            Kind::Nll => self.total,
            Kind::Distance => {
                if self.count == 0 {
                    f64::NAN
                } else {
                    self.total
                }
            }
            Kind::MseInnovation | Kind::Mismatch | Kind::NisMean | Kind::Rejected => mean,
            Kind::Nis => (mean - 1.0).abs(),
            Kind::NisDistribution => self.uniformity.cost(),
            Kind::Whiteness => self.whiteness.cost(),
            Kind::Prediction => self.prediction.as_ref().map_or(f64::NAN, Prediction::cost),
            Kind::Nees => (mean / states - 1.0).abs(),
            Kind::NeesMean => mean / states,
            Kind::Rmse => mean.sqrt(),
        }
    }
}
