//! What the tuned filter does on rows that the search never saw.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{ConstraintCheck, HeldOutDifference, Named, Standing, StartOf, constraint, raw_rmse, short, significant};
use crate::data::{HeldOut, Log, SplitBy};
use crate::model::Problem;
use crate::objective::{Kind, Objective};
use crate::reference;
use crate::study::{Split, scoring_rows};

/// Trajectories held out, listed by name up to this many.
const NAMED: usize = 1000;

/// Scores on held-out rows beside those on the training rows. All are the f64 reference's.
///
/// The *improvement* of the winner over the baseline is (baseline - winner) / |baseline| of an objective. For `nll`,
/// whose zero depends on the unit of measurement, it is (baseline - winner) / scoring rows, in nats a row. The *overfit
/// gap* is the improvement on the training rows less that on the held-out rows: about 0 when what was learned holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validation {
    /// What is held out.
    pub by: SplitBy,
    /// Whether those are realisations drawn for the purpose.
    pub fresh: bool,
    /// The share asked for.
    pub share: f64,
    /// What the search saw.
    pub train: Part,
    /// What it did not see.
    pub held_out: Part,
    /// Names of the trajectories held out; none by time, or when more than 1,000.
    pub trajectories: Vec<String>,
    /// The baseline's objectives on the held-out rows; `None` where its filter fails.
    pub baseline: Option<Named<f64>>,
    /// The winner's.
    pub winner: Option<Named<f64>>,
    /// Improvement on the training rows; `None` where it is not defined.
    pub improvement_train: Named<Option<f64>>,
    /// Improvement on the held-out rows.
    pub improvement_held_out: Named<Option<f64>>,
    /// The former less the latter.
    pub overfit_gap: Named<Option<f64>>,
    /// Whether the winner is worse than the baseline on the held-out rows, as far as these can tell: told worse under one
    /// objective and better under none; or it fails there, and the baseline does not.
    pub worse: bool,
    /// The differences with their standard errors.
    #[serde(skip)]
    pub difference: HeldOutDifference,
    /// Whose the baseline's values are.
    #[serde(skip)]
    pub start_of: StartOf,
    /// RMSE of the raw measurements over the held-out rows, as in the result itself.
    pub raw_measurements: Named<f64>,
    /// The constraints over the held-out rows.
    pub constraints: Vec<ConstraintCheck>,
}

/// The size of a part of the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Rows.
    pub rows: usize,
    /// Trajectories that have any of them.
    pub trajectories: usize,
}

/// Which rows something was judged on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rows {
    /// Those that were tuned on.
    InSample,
    /// Those that were not.
    HeldOut,
}

/// A candidate with its objectives on the training rows.
#[derive(Clone, Copy)]
pub(super) struct Trained<'a> {
    pub(super) candidate: &'a [f64],
    pub(super) objectives: Option<&'a [f64]>,
}

impl Validation {
    /// Scores both candidates on what `split` holds out; `None` if that is nothing.
    pub(super) fn of(problem: &Problem, split: &Split, baseline: Trained<'_>, winner: Trained<'_>) -> Option<Self> {
        let held_out = split.held_out.as_ref()?;
        let on_held_out = [baseline, winner].map(|trained| Scores::of(problem, held_out, trained.candidate));
        let [baseline_held, winner_held] = on_held_out.each_ref().map(|scores| scores.objectives.as_ref());
        let [baseline_bound, winner_bound] = on_held_out.each_ref().map(|scores| scores.constraints.as_deref());
        let train_from = vec![0; split.train.trajectories.len()];
        let train = improvements(problem, (&split.train, &train_from), baseline.objectives, winner.objectives);
        let held = (&held_out.log, &held_out.from[..]);
        let held = improvements(problem, held, baseline_held.map(Vec::as_slice), winner_held.map(Vec::as_slice));
        let gap: Vec<Option<f64>> = train.iter().zip(&held).map(|(train, held)| Some((*train)? - (*held)?)).collect();
        let costs = [baseline_held, winner_held].map(|costs| costs.map(Vec::as_slice));
        let difference =
            HeldOutDifference::of(problem, held_out, (baseline.candidate, costs[0]), (winner.candidate, costs[1]));
        let names = || problem.tune.objectives.iter().map(Objective::name);
        let raw = |o: &Objective| Some((o.name(), raw_rmse(problem, &held_out.log, &held_out.from, o)?));
        Some(Self {
            by: held_out.by,
            fresh: held_out.by == SplitBy::Trajectory && problem.data.file.is_none(),
            share: held_out.share,
            train: Part::of(&split.train, &train_from),
            held_out: Part::of(&held_out.log, &held_out.from),
            trajectories: names_of(held_out),
            worse: difference.verdict == Standing::Worse,
            difference,
            start_of: StartOf::of(problem),
            improvement_train: Named::new(names(), train),
            improvement_held_out: Named::new(names(), held),
            overfit_gap: Named::new(names(), gap),
            raw_measurements: problem.tune.objectives.iter().filter_map(raw).collect(),
            constraints: constraint::checks_held_out(problem, baseline_bound, winner_bound),
            baseline: baseline_held.map(|costs| Named::new(names(), costs.iter().copied())),
            winner: winner_held.map(|costs| Named::new(names(), costs.iter().copied())),
        })
    }

    /// The judgement in one sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let judgement = self.judgement();
        format!("{}{}.", judgement[..1].to_uppercase(), &judgement[1..])
    }

    /// The judgement as a clause that starts in lower case.
    pub(super) fn judgement(&self) -> String {
        let (difference, than) = (&self.difference, self.start_of);
        match (&self.baseline, &self.winner) {
            (_, None) => "the tuned filter fails on held-out data".to_owned(),
            (None, Some(_)) => {
                let fails = than.verb("your filter fails", "the drafted filter fails");
                format!("{fails} on held-out data, and the tuned one runs")
            }
            _ if difference.is_trade() => format!(
                "on held-out data the tuned parameters are better than {than} under one objective and worse under another: \
                 better in {}, worse in {}",
                difference.amounts(Standing::Better),
                difference.amounts(Standing::Worse)
            ),
            _ => match difference.verdict {
                Standing::NotToldApart => format!(
                    "no difference between the tuned parameters and {than} that the held-out rows can tell: {}",
                    difference.untold()
                ),
                told => format!(
                    "the tuned parameters are {} than {than} on held-out data: {}",
                    if told == Standing::Better { "better" } else { "worse" },
                    difference.amounts(told)
                ),
            },
        }
    }
}

impl Part {
    fn of(log: &Log, from: &[usize]) -> Self {
        let rows = || log.trajectories.iter().zip(from).map(|(t, from)| t.len() - from);
        Self { rows: rows().sum(), trajectories: rows().filter(|rows| *rows > 0).count() }
    }
}

/// A candidate over the held-out rows; `None` where its filter fails.
struct Scores {
    /// Finite; `None` also where one is not.
    objectives: Option<Vec<f64>>,
    /// What the constraints bound, NaN where no held-out row measures it.
    constraints: Option<Vec<f64>>,
}

impl Scores {
    fn of(problem: &Problem, held_out: &HeldOut, candidate: &[f64]) -> Self {
        let scores = reference::scores_held_out(problem, held_out, candidate).ok();
        let (objectives, constraints) = scores
            .map(|mut objectives| {
                let constraints = objectives.split_off(problem.tune.objectives.len());
                (objectives, constraints)
            })
            .unzip();
        let finite = |costs: &Vec<f64>| costs.iter().all(|cost| cost.is_finite());
        Self { objectives: objectives.filter(finite), constraints }
    }
}

/// The improvement under each objective, over rows of `log` from `from` on.
fn improvements(
    problem: &Problem,
    (log, from): (&Log, &[usize]),
    baseline: Option<&[f64]>,
    winner: Option<&[f64]>,
) -> Vec<Option<f64>> {
    let improvement = |(i, objective): (usize, &Objective)| {
        let (baseline, winner) = (baseline?.get(i)?, winner?.get(i)?);
        let scale = match objective.kind {
            Kind::Nll => scoring_rows(problem, log, from, objective) as f64,
            _ => baseline.abs(),
        };
        Some((baseline - winner) / scale).filter(|share| share.is_finite())
    };
    problem.tune.objectives.iter().enumerate().map(improvement).collect()
}

fn names_of(held_out: &HeldOut) -> Vec<String> {
    let trajectories = &held_out.log.trajectories;
    if held_out.by == SplitBy::Time || trajectories.len() > NAMED {
        return Vec::new();
    }
    trajectories.iter().map(|t| t.id.clone()).collect()
}

/// An improvement or a gap as a person reads it.
pub(super) fn improvement_text(objective: &str, value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(value) if objective == "nll" => format!("{} nats a row", significant(value, 3)),
        Some(value) => format!("{} %", significant(100.0 * value, 3)),
    }
}

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::InSample => "in-sample",
            Self::HeldOut => "held-out rows",
        })
    }
}

/// What is held out, in a sentence.
impl fmt::Display for Validation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const LISTED: usize = 8;
        let Self { train, held_out, .. } = self;
        let plural =
            |count: usize, one: &str, several: &str| if count == 1 { one.to_owned() } else { several.to_owned() };
        match (self.by, self.fresh) {
            (SplitBy::Time, _) => write!(
                f,
                "the last {} % of the rows{} are held out, {} of {}; the filter runs through all of them",
                short(100.0 * self.share, 4),
                if train.trajectories > 1 { " of each trajectory" } else { "" },
                held_out.rows,
                train.rows + held_out.rows,
            ),
            (SplitBy::Trajectory, true) => write!(
                f,
                "{} fresh {} held out beside {} that {} tuned on",
                held_out.trajectories,
                plural(held_out.trajectories, "realisation is", "realisations are"),
                train.trajectories,
                plural(train.trajectories, "is", "are"),
            ),
            (SplitBy::Trajectory, false) => {
                let all = train.trajectories + held_out.trajectories;
                let are = plural(held_out.trajectories, "is", "are");
                write!(f, "{} of {all} trajectories {are} held out", held_out.trajectories)?;
                let listed = self.trajectories.iter().take(LISTED).map(|t| format!("`{t}`")).collect::<Vec<_>>();
                let more = if held_out.trajectories > LISTED { ", ..." } else { "" };
                write!(f, " ({}{more})", listed.join(", "))
            }
        }
    }
}
