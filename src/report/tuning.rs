//! What a study found, as one object: `kfgpu tune --json`, result.json and the text report are this.

use serde::Serialize;

use super::validation::Trained;
use super::{
    Bound, Consistency, ConstraintCheck, Evidence, FrontPoint, FrontSummary, Matrices, Named, Rows, Validation,
    Warning, constraint_checks, front, matrices, raw_rmse,
};
use crate::data::{HeldOut, Log, Split};
use crate::evaluate::Device;
use crate::model::Problem;
use crate::objective::Objective;
use crate::reference::{self, Failure};
use crate::study::{self, Outcome, StopReason, Winner};

/// How a study went, found or not.
#[derive(Debug, Clone, Serialize)]
pub struct Effort {
    /// Problem file.
    pub problem: String,
    /// The log.
    pub log: LogFacts,
    /// Optimiser, by its name in the registry.
    pub algorithm: String,
    /// Units of the searched parameters, where the problem file gives them.
    pub units: Named<Option<String>>,
    /// The user's start values.
    pub baseline: Scored,
    /// Candidates evaluated, polish apart.
    pub evaluations: u64,
    /// How many of them failed.
    pub failed: u64,
    /// Generations after the initial one.
    pub generations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Why the search ended.
    pub stop: StopReason,
    /// Where candidates were computed.
    pub device: Device,
    /// The whole study \[s\].
    pub wall_s: f64,
    /// The part of it spent evaluating \[s\].
    pub evaluate_s: f64,
    /// What the user should look at.
    pub warnings: Vec<String>,
}

/// The log of a study.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LogFacts {
    /// File name.
    pub source: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of trajectories.
    pub trajectories: usize,
}

/// The result of a study. Objectives are values of the f64 reference over what was tuned on: the whole log, or its
/// training rows where `validation` says so. Parameters are in their own units.
#[derive(Debug, Clone, Serialize)]
pub struct Tuning {
    /// The winner.
    pub parameters: Named<f64>,
    /// Bounds that the winner sits on, of the parameters that do.
    pub at_bound: Named<Bound>,
    /// Values that the log was simulated with, of the parameters whose baseline they are not.
    pub simulated_with: Named<f64>,
    /// The winner's objectives.
    pub objectives: Named<f64>,
    /// Rows that updated the tuned filter: nll / this is the nll per step.
    pub measured_rows: usize,
    /// Scores on held-out rows, where there are any.
    pub validation: Option<Validation>,
    /// Whether the tuned filter's innovations are what its covariances say.
    pub consistency: Consistency,
    /// The rows that this was judged on: held-out ones where there are any and the filter runs there.
    pub consistency_on: Rows,
    /// Search costs against the reference.
    pub certificate: Certificate,
    /// Constraints, held against the winner.
    pub constraints: Vec<ConstraintCheck>,
    /// Whether the winner meets all of them.
    pub feasible: bool,
    /// The non-dominated candidates of a study of several objectives, of which the winner is the recommended one.
    pub front: Option<Vec<FrontPoint>>,
    /// What that front offers.
    pub front_summary: Option<FrontSummary>,
    /// The local search in f64 that ended the study.
    pub polish: Option<Polish>,
    /// The tuned filter.
    pub matrices: Matrices,
    /// RMSE of the raw measurements, for `rmse` objectives whose states are measured directly.
    pub raw_measurements: Named<f64>,
    /// How it was found.
    #[serde(flatten)]
    pub effort: Effort,
}

/// The result of a study without a usable candidate: everything that a [`Tuning`] would add is null.
#[derive(Debug, Clone, Serialize)]
#[expect(missing_docs, reason = "as in Tuning")]
pub struct Nothing {
    pub parameters: (),
    pub objectives: (),
    pub validation: (),
    pub consistency: (),
    pub consistency_on: (),
    pub certificate: (),
    pub constraints: (),
    pub feasible: (),
    pub front: (),
    pub front_summary: (),
    pub polish: (),
    pub matrices: (),
    #[serde(flatten)]
    pub effort: Effort,
}

/// Parameters and their objectives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scored {
    /// Values in their own units.
    pub parameters: Named<f64>,
    /// Objectives; `None` when the filter could not run with these parameters.
    pub objectives: Option<Named<f64>>,
}

/// The best candidates of the search, scored again by the independent f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// The winner before polish, by the reference.
    pub objectives_f64: Named<f64>,
    /// The same candidate, as the search scored it.
    pub objectives_search: Named<f64>,
    /// Largest relative difference of the two over the re-scored candidates.
    pub largest_relative_gap: f64,
    /// Whether both rank the re-scored candidates alike.
    pub order_held: bool,
    /// Number of candidates re-scored.
    pub candidates: usize,
    /// How many of them the reference could not run.
    pub refused: usize,
    /// How many of them it finds infeasible or, of a front, dominated by another.
    pub dropped: usize,
}

/// The local search that ended a study of one objective.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Polish {
    /// Evaluations it took, not counted among the search's.
    pub evaluations: usize,
    /// Objectives it started from, by the reference.
    pub before: Named<f64>,
    /// And ended with.
    pub after: Named<f64>,
}

impl LogFacts {
    /// Of a whole log, before anything is held out.
    #[must_use]
    pub fn of(log: &Log) -> Self {
        Self { source: log.source.clone(), rows: log.rows(), trajectories: log.trajectories.len() }
    }
}

impl Effort {
    /// Of a finished study of `problem` over `log`, computed on `device`.
    #[must_use]
    pub fn of(problem: &Problem, log: LogFacts, outcome: &Outcome, device: Device, warnings: Vec<String>) -> Self {
        let baseline = &outcome.baseline;
        let searched = problem.parameters.searched().map(|(parameter, _)| parameter);
        let units = searched.map(|p| p.unit.clone());
        Self {
            problem: problem.source.clone(),
            log,
            algorithm: outcome.algorithm.to_owned(),
            units: Named::new(problem.parameters.names(), units),
            baseline: Scored {
                parameters: parameters(problem, &baseline.candidate),
                objectives: baseline.objectives.as_ref().map(|values| objectives(problem, values)),
            },
            evaluations: outcome.evaluations,
            failed: outcome.failed,
            generations: outcome.generations.saturating_sub(1),
            seed: problem.tune.seed,
            stop: outcome.stop,
            device,
            wall_s: outcome.wall_s,
            evaluate_s: outcome.evaluate_s,
            warnings,
        }
    }

    /// The result without a usable candidate.
    #[must_use]
    pub const fn without_winner(self) -> Nothing {
        Nothing {
            effort: self,
            parameters: (),
            objectives: (),
            validation: (),
            consistency: (),
            consistency_on: (),
            certificate: (),
            constraints: (),
            feasible: (),
            front: (),
            front_summary: (),
            polish: (),
            matrices: (),
        }
    }
}

impl Tuning {
    /// The result of a study over `split.train`, and its winner, which runs once more through the reference, and through
    /// what is held out.
    ///
    /// # Errors
    /// If the run over the training rows fails; it does not for a winner of [`study::run`].
    pub fn of(
        effort: Effort,
        problem: &Problem,
        split: &Split,
        (outcome, winner): (&Outcome, &Winner),
    ) -> Result<Self, Failure> {
        let log = &split.train;
        let mut evidence = Evidence::new(problem, log);
        let mut last_gain = None;
        reference::visit(problem, log, &winner.candidate, &mut |trajectory, step| {
            evidence.add(trajectory, step);
            matrices::keep_complete_gain(&mut last_gain, step, log.measurements.len());
        })?;
        let at_bound = problem
            .parameters
            .searched()
            .zip(&winner.candidate)
            .filter_map(|((parameter, search), value)| Some((parameter.name.clone(), Bound::of(search, *value)?)));
        let from = vec![0; log.trajectories.len()];
        let raw = problem.tune.objectives.iter().filter_map(|o| Some((o.name(), raw_rmse(problem, log, &from, o)?)));
        let held_out = split.held_out.as_ref().and_then(|held| on_held_out(problem, held, &winner.candidate));
        let consistency_on = if held_out.is_some() { Rows::HeldOut } else { Rows::InSample };
        let (points, summary) = front(problem, outcome, split.held_out.as_ref()).unzip();
        let mut tuning = Self {
            parameters: parameters(problem, &winner.candidate),
            at_bound: at_bound.collect(),
            simulated_with: simulated_with(problem),
            objectives: objectives(problem, &winner.objectives),
            measured_rows: evidence.measured_rows(),
            validation: validation(problem, split, &effort.baseline, winner),
            consistency: held_out.as_ref().unwrap_or(&evidence).judge(problem, &winner.candidate),
            consistency_on,
            certificate: Certificate::of(problem, &winner.certificate),
            constraints: constraint_checks(problem, outcome),
            feasible: winner.violation <= 0.0,
            front: points,
            front_summary: summary,
            polish: winner.polish.as_ref().map(|polish| Polish::of(problem, polish)),
            matrices: Matrices::of(problem, log, &winner.candidate, last_gain),
            raw_measurements: raw.collect(),
            effort,
        };
        let found = Warning::of(&tuning);
        tuning.effort.warnings.extend(found.iter().map(ToString::to_string));
        Ok(tuning)
    }
}

impl Certificate {
    fn of(problem: &Problem, certificate: &study::Certificate) -> Self {
        Self {
            objectives_f64: objectives(problem, &certificate.objectives_f64),
            objectives_search: objectives(problem, &certificate.objectives_search),
            largest_relative_gap: certificate.largest_relative_gap,
            order_held: certificate.order_held,
            candidates: certificate.finalists,
            refused: certificate.refused,
            dropped: certificate.dropped,
        }
    }
}

impl Polish {
    fn of(problem: &Problem, polish: &study::Polish) -> Self {
        Self {
            evaluations: polish.evaluations,
            before: objectives(problem, &polish.before),
            after: objectives(problem, &polish.after),
        }
    }
}

/// Scores of baseline and winner on what is held out, if anything is.
fn validation(problem: &Problem, split: &Split, baseline: &Scored, winner: &Winner) -> Option<Validation> {
    let values = |named: &Named<f64>| named.iter().map(|(_, value)| *value).collect::<Vec<f64>>();
    let (candidate, objectives) = (values(&baseline.parameters), baseline.objectives.as_ref().map(values));
    let baseline = Trained { candidate: &candidate, objectives: objectives.as_deref() };
    let winner = Trained { candidate: &winner.candidate, objectives: Some(&winner.objectives) };
    Validation::of(problem, split, baseline, winner)
}

/// The evidence of the held-out rows; `None` where the filter fails.
fn on_held_out(problem: &Problem, held_out: &HeldOut, candidate: &[f64]) -> Option<Evidence> {
    let mut evidence = Evidence::new(problem, &held_out.log);
    let run = reference::visit(problem, &held_out.log, candidate, &mut |trajectory, step| {
        if step.row >= held_out.from[trajectory] {
            evidence.add(trajectory, step);
        } else {
            evidence.pass(trajectory, step);
        }
    });
    run.is_ok().then_some(evidence)
}

fn simulated_with(problem: &Problem) -> Named<f64> {
    let spec = problem.simulate.as_ref().filter(|_| problem.data.file.is_none());
    spec.into_iter().flat_map(|spec| spec.parameters.iter().cloned()).collect()
}

fn parameters(problem: &Problem, candidate: &[f64]) -> Named<f64> {
    Named::new(problem.parameters.names(), candidate.iter().copied())
}

fn objectives(problem: &Problem, values: &[f64]) -> Named<f64> {
    Named::new(problem.tune.objectives.iter().map(Objective::name), values.iter().copied())
}
