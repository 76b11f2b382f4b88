//! The winner of one objective.

use super::lockstep::{Goal, Run};
use super::{Ended, Place, Polish, Polished, undetermined};
use crate::evaluate::{Population, Precision};
use crate::optimize::Standing;
use crate::study::finish::Verdict;
use crate::study::{Scored, StudyError};

/// Ends closer than this to each other \[nats\] are one optimum.
const SAME: f64 = 1e-5;
/// The same where the rounding of the cost is coarser, relative to it.
const SAME_ROUNDING: f64 = 1e-12;
/// Of a distance from 0, the part of a standard error that nobody needs closer.
const CLOSE: f64 = 1e-4;
/// Ends that the oracle is asked about.
const ASKED: usize = 3;

/// Where the local searches have come to.
struct End {
    candidate: Vec<f64>,
    cost: f64,
    standing: Standing,
    gradient_norm: Option<f64>,
}

/// Local searches from the winner and other starts. What they find replaces the winner only if the oracle finds it better;
/// then parameters that the cost does not depend on go back to their start.
pub(in crate::study) fn polish(
    winner: Polished<'_>,
    finalists: &[Scored],
    place: &mut Place<'_>,
) -> Result<Polish, StudyError> {
    let before = winner.verdict.objectives.clone();
    let nat = place.kind(0).nat(before[0], place.rows());
    let mut polish = Polish {
        after: before.clone(),
        before,
        evaluations: 0,
        starts: 0,
        ended: Ended::Done,
        converged: None,
        gradient_norm: None,
        left_at_start: Vec::new(),
        members: 0,
    };
    let mut ends = Vec::new();
    if place.kind(0).is_smooth() {
        ends = place.descend(winner.candidate, nat, &mut polish)?;
    }
    let settled = ends.first().is_some_and(|end: &End| end.standing != Standing::Stuck);
    if !settled && polish.ended == Ended::Done {
        ends.extend(place.contract(winner.candidate, &ends, finalists, &mut polish)?);
        ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
    place.choose(winner.candidate, winner.verdict, &ends, nat, &mut polish);
    if !matches!(polish.ended, Ended::WallTime | Ended::Interrupted) {
        undetermined::put_back(winner, place, &mut polish)?;
    }
    Ok(polish)
}

impl Place<'_> {
    /// Quasi-Newton searches, until two of them agree on the best optimum.
    fn descend(&mut self, winner: &[f64], nat: f64, polish: &mut Polish) -> Result<Vec<End>, StudyError> {
        let starts = self.starts(winner);
        let search = |start: &Vec<f64>| Ok(Run::new(self.quasi_newton(start, nat)?, Goal::One(0)));
        let mut runs = starts.iter().map(search).collect::<Result<Vec<Run>, StudyError>>()?;
        let (evaluations, ended) = self.lockstep(&mut runs, |runs| agree(runs, nat))?;
        polish.evaluations += evaluations;
        polish.starts += runs.len();
        polish.ended = ended;
        let mut ends: Vec<End> = runs.iter().filter_map(|run| self.end(run)).collect();
        // Of one optimum the end that has converged, before one that was still on its way when two agreed.
        let best = ends.iter().map(|end| end.cost).fold(f64::INFINITY, f64::min);
        let last = |end: &End| end.standing != Standing::Converged || end.cost > best + same(best, nat);
        ends.sort_by(|a, b| last(a).cmp(&last(b)).then(a.cost.total_cmp(&b.cost)));
        Ok(ends)
    }

    fn end(&self, run: &Run) -> Option<End> {
        let (x, cost) = run.search.best()?;
        let rows = Population::from_rows(x.len(), x.to_vec());
        let candidate = self.coordinates.candidates(&rows).row(0).to_vec();
        Some(End { candidate, cost, standing: run.search.standing(), gradient_norm: run.search.gradient_norm() })
    }

    /// A simplex search, from where the others got stuck or from the winner.
    fn contract(
        &mut self,
        winner: &[f64],
        ends: &[End],
        finalists: &[Scored],
        polish: &mut Polish,
    ) -> Result<Option<End>, StudyError> {
        let start = ends.first().map_or(winner, |end| &end.candidate);
        let others: Vec<Vec<f64>> = finalists.iter().map(|f| self.coordinates.position(&f.candidate)).collect();
        let search = self.simplex(&self.coordinates.position(start), &others)?;
        let mut runs = [Run::new(search, Goal::One(0))];
        let (evaluations, ended) = self.lockstep(&mut runs, |_| false)?;
        polish.evaluations += evaluations;
        polish.starts += 1;
        polish.ended = ended;
        let [Run { search, seen, .. }] = &runs;
        let end = |found: &Scored| End {
            candidate: found.candidate.clone(),
            cost: found.costs[0],
            standing: search.standing(),
            gradient_norm: None,
        };
        Ok(seen.best().map(end))
    }

    /// The best end by the oracle, if that is better than the winner; and whether the winner has converged.
    fn choose(&self, candidate: &mut Vec<f64>, verdict: &mut Verdict, ends: &[End], nat: f64, polish: &mut Polish) {
        let stopped = matches!(polish.ended, Ended::WallTime | Ended::Interrupted);
        polish.converged = stopped.then_some(false);
        let better = |a: &(&End, Verdict), b: &(&End, Verdict)| {
            // The ends come best first; only more than rounding turns them round.
            let apart = b.1.objectives[0] - a.1.objectives[0];
            a.1.violation < b.1.violation || (a.1.violation <= b.1.violation && apart > same(a.1.objectives[0], nat))
        };
        let asked =
            ends.iter().take(ASKED).filter_map(|end| Some((end, self.bounds.ask(self.oracle, &end.candidate)?)));
        let Some((end, exact)) = asked.reduce(|best, next| if better(&next, &best) { next } else { best }) else {
            return;
        };
        let (cost, lost) = (exact.objectives[0], exact.objectives[0] - verdict.objectives[0]);
        // What was minimised must be what the oracle sees: else the end is one of rounding.
        let trusted = (end.cost - cost).abs() <= 100.0 * self.kind(0).resolution(Precision::F64, cost, self.rows());
        let reached = !self.kind(0).is_smooth() && exact.violation <= 0.0 && cost <= CLOSE * nat;
        if exact.order(verdict).is_lt() {
            candidate.clone_from(&end.candidate);
            *verdict = exact;
        }
        polish.after.clone_from(&verdict.objectives);
        polish.gradient_norm = end.gradient_norm;
        polish.converged = match end.standing {
            Standing::Converged => Some(trusted && lost <= same(cost, nat)),
            _ if reached => Some(true),
            Standing::Collapsed => None,
            Standing::Unfinished | Standing::Stuck => Some(false),
        };
        polish.ended = match (polish.ended, end.standing) {
            (Ended::Done, Standing::Unfinished) => Ended::Evaluations,
            (Ended::Done, Standing::Stuck) => Ended::Stuck,
            (ended, _) => ended,
        };
    }
}

/// Costs closer than this to each other are one optimum.
fn same(cost: f64, nat: f64) -> f64 {
    (SAME * nat).max(SAME_ROUNDING * cost.abs())
}

/// Whether the best of the searches has converged and another one has to the same cost.
fn agree(runs: &[Run], nat: f64) -> bool {
    let best = runs.iter().map(Run::cost).fold(f64::INFINITY, f64::min);
    let there = |run: &&Run| run.search.standing() == Standing::Converged && run.cost() <= best + same(best, nat);
    runs.iter().filter(there).count() > 1
}
