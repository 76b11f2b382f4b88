//! One filter over a log.

use serde::Serialize;

use super::Difference;
use crate::data::Log;
use crate::model::{Problem, View};
use crate::objective::{Kind, Objective};
use crate::reference;
use crate::report::{Named, Standing, StateErrors};

/// Nats in all below which a difference is none, though it may be told: what one parameter more is worth.
const ONE_PARAMETER: f64 = 1.0;

/// What one filter makes of a log. Numbers are NaN (JSON `null`) where it fails or there is nothing to measure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilterScore {
    /// Its name.
    pub filter: String,
    /// Negative log-likelihood \[nats\], without the rows that the problem's own `nll` skips.
    pub nll: f64,
    /// The same per measured row that scores.
    pub nll_per_row: f64,
    /// `nll` less that of the problem's own filter: below 0 this one is more likely.
    pub difference: f64,
    /// Standard error of `difference`, of the paired differences of the rows; NaN where these are too few. 1.96 of it are a 95 %
    /// interval.
    pub standard_error: f64,
    /// Whether it is told to be more likely than the problem's own (`better`) or less: by more than 1.96 standard errors, and
    /// by a nat or more.
    pub verdict: Standing,
    /// Sum of NIS / number of present components, over the same rows.
    pub nis_mean: f64,
    /// Root mean squared error of each state that has truth.
    pub rmse: Named<f64>,
    /// [`reference::amplification`], also `null` in JSON where it is infinite; `None` where it was not asked for.
    pub amplification: Option<f64>,
    /// Why it fails; `None` where it runs.
    pub failed: Option<String>,
    /// What it takes f and h for.
    #[serde(skip)]
    pub view: View,
}

/// A score with what each row adds to `nll`.
pub(super) struct Scored {
    pub(super) score: FilterScore,
    /// By trajectory; empty where the filter fails.
    pub(super) rows: Vec<Vec<f64>>,
}

impl Scored {
    pub(super) fn of(problem: &Problem, log: &Log, candidate: &[f64], amplifications: bool) -> Self {
        let mut problem = problem.clone();
        let own = problem.tune.objectives.iter().find(|objective| objective.kind == Kind::Nll);
        let objective = own.cloned().unwrap_or_else(|| Objective::new(Kind::Nll));
        let skip = objective.skip;
        // The walk scores what it is told to: nothing but `nll` is of use here.
        problem.tune.objectives = vec![objective];
        let mut rows = vec![Vec::new(); log.trajectories.len()];
        let (mut nis, mut components) = (0.0, 0.0);
        let mut errors = StateErrors::new(&problem, log);
        let run = reference::visit(&problem, log, candidate, &mut |trajectory, step| {
            errors.add(&log.trajectories[trajectory], step.row, &step.posterior.x);
            if let Some(update) = step.update.as_ref().filter(|_| step.row >= skip) {
                rows[trajectory].push(update.nll);
                nis += update.nis;
                components += update.present.len() as f64;
            }
        });
        let (filter, view) = (problem.filter.name().to_owned(), problem.filter.view());
        if let Err(failure) = run {
            return Self { score: FilterScore::failed(filter, view, failure.to_string()), rows: Vec::new() };
        }
        let nll: f64 = rows.iter().flatten().sum();
        let measured = rows.iter().map(Vec::len).sum::<usize>() as f64;
        let amplification =
            amplifications.then(|| reference::amplification(&problem, log, candidate).unwrap_or(f64::INFINITY));
        let score = FilterScore {
            filter,
            nll,
            nll_per_row: nll / measured,
            difference: 0.0,
            standard_error: 0.0,
            verdict: Standing::NotToldApart,
            nis_mean: nis / components,
            rmse: errors.rmse(),
            amplification,
            failed: None,
            view,
        };
        Self { score, rows }
    }

    pub(super) const fn runs(&self) -> bool {
        self.score.failed.is_none()
    }

    /// Measured rows that score.
    pub(super) fn measured(&self) -> usize {
        self.rows.iter().map(Vec::len).sum()
    }

    /// How much more likely `other` is, above 0, or less.
    pub(super) fn gain_of(&self, other: &Self) -> Difference {
        let gain = Difference::of_sums(&self.rows, &other.rows);
        let is_none = gain.difference.abs() < ONE_PARAMETER;
        Difference { verdict: if is_none { Standing::NotToldApart } else { gain.verdict }, ..gain }
    }

    /// The score with its difference from the problem's own filter.
    pub(super) fn beside(&self, own: &Self) -> FilterScore {
        let mut score = self.score.clone();
        if self.runs() && own.runs() {
            let Difference { difference, standard_error, verdict } = own.gain_of(self);
            (score.difference, score.standard_error, score.verdict) = (0.0 - difference, standard_error, verdict);
        } else {
            (score.difference, score.standard_error) = (f64::NAN, f64::NAN);
        }
        score
    }
}

impl FilterScore {
    fn failed(filter: String, view: View, reason: String) -> Self {
        Self {
            filter,
            nll: f64::NAN,
            nll_per_row: f64::NAN,
            difference: f64::NAN,
            standard_error: f64::NAN,
            verdict: Standing::NotToldApart,
            nis_mean: f64::NAN,
            rmse: Named::default(),
            amplification: None,
            failed: Some(reason),
            view,
        }
    }
}
