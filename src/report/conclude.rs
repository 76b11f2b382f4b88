//! From a finished search to what is said of it.

use super::effort::{objectives, parameters};
use super::validation::Trained;
use super::warnings::mixed_units;
use super::{
    Bound, Certificate, Effort, Evidence, Linearity, Matrices, Named, Polish, Rows, Scored, StartOf, Tuning,
    Uncertainty, Validation, Warning, constraint_checks, front, raw_rmse,
};
use crate::data::HeldOut;
use crate::model::Problem;
use crate::number::short;
use crate::reference::{self, Failure};
use crate::study::{self, Ended, Outcome, Split, Winner};

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
        reference::visit(problem, log, &winner.candidate, &mut |trajectory, step| evidence.add(trajectory, step))?;
        let at_bound = problem
            .parameters
            .searched()
            .zip(&winner.candidate)
            .filter_map(|((parameter, search), value)| Some((parameter.name.clone(), Bound::of(search, *value)?)));
        let from = vec![0; log.trajectories.len()];
        let raw = problem.tune.objectives.iter().filter_map(|o| Some((o.name(), raw_rmse(problem, log, &from, o)?)));
        let held_out = split.held_out.as_ref().and_then(|held| on_held_out(problem, held, &winner.candidate));
        let mut consistency = held_out.as_ref().unwrap_or(&evidence).judge(problem, &winner.candidate);
        // How well the parameters are determined is a matter of the rows that determined them.
        consistency.uncertainty = Uncertainty::of(problem, log, &winner.candidate);
        let consistency_on = if held_out.is_some() { Rows::HeldOut } else { Rows::InSample };
        let validation = validation(problem, split, &effort.baseline, winner);
        let (points, summary) = front(problem, outcome, split).unzip();
        let mut tuning = Self {
            parameters: parameters(problem, &winner.candidate),
            at_bound: at_bound.collect(),
            simulated_with: simulated_with(problem),
            objectives: objectives(problem, &winner.objectives),
            measured_rows: evidence.measured_rows(),
            held_out: validation.as_ref().map(|validation| validation.difference.clone()),
            start_of: StartOf::of(problem),
            validation,
            consistency,
            consistency_on,
            linearity: Linearity::of_winner(problem, log, &winner.candidate),
            certificate: Certificate::of(problem, &winner.certificate),
            constraints: constraint_checks(problem, outcome),
            feasible: winner.violation <= 0.0,
            front: points,
            front_summary: summary,
            polish: winner.polish.as_ref().map(|polish| Polish::of(problem, polish)),
            converged: winner.polish.as_ref().and_then(|polish| polish.converged),
            gradient_norm: winner.polish.as_ref().and_then(|polish| polish.gradient_norm),
            matrices: Matrices::of(problem, log, &winner.candidate),
            raw_measurements: raw.collect(),
            effort,
        };
        let found = [Warning::of(&tuning), mixed_units(problem)].concat();
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
            largest_gap: certificate.largest_gap,
            order_held: certificate.order_held,
            amplification: certificate.amplification,
            promise_holds: certificate.promise_holds(),
            amplified: certificate.amplified,
            candidates: certificate.finalists,
            refused: certificate.refused,
            dropped: certificate.dropped,
        }
    }
}

impl Polish {
    fn of(problem: &Problem, polish: &study::Polish) -> Self {
        let names = problem.parameters.names();
        Self {
            evaluations: polish.evaluations,
            starts: polish.starts,
            before: objectives(problem, &polish.before),
            after: objectives(problem, &polish.after),
            ended: polish.ended,
            left_at_start: polish.left_at_start.iter().map(|i| names[*i].to_owned()).collect(),
            members: polish.members,
            note: note(problem, polish),
        }
    }
}

/// Why a winner is not known to be an optimum.
fn note(problem: &Problem, polish: &study::Polish) -> Option<String> {
    if problem.tune.objectives.len() > 1 || polish.converged == Some(true) {
        return None;
    }
    let objective = problem.tune.objectives.first().map_or("", |objective| objective.name());
    let far = polish.gradient_norm.map_or_else(String::new, |norm| {
        format!(", by its gradient {} standard errors from the optimum", short(norm, 2))
    });
    Some(match polish.ended {
        Ended::Interrupted => format!("the local search was interrupted{far}"),
        Ended::WallTime => format!("the time allowed was over before the local search was done{far}"),
        Ended::Evaluations => format!("the local search used up its evaluations{far}"),
        Ended::Stuck => format!("the local search found no way down although {objective} is not flat there{far}"),
        Ended::Done if polish.converged.is_none() => format!(
            "{objective} has no gradient to judge by, at a kink or at the edge of a constraint: a simplex search ended by \
             itself"
        ),
        Ended::Done => "the reference does not find what the local search found".to_owned(),
    })
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
fn on_held_out<'a>(problem: &Problem, held_out: &'a HeldOut, candidate: &[f64]) -> Option<Evidence<'a>> {
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
