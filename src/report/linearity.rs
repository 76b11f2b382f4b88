//! What it costs that a filter takes f and h for other functions: the same problem, log and parameters by several filters.
//!
//! Filters of curved f and h differ in the gaussian that they put in the place of each prediction. On the same rows with the
//! same Q and R the one whose gaussians are nearer the truth has the larger likelihood, whatever Q and R are; a search
//! of Q and R, which widens these gaussians, would hide the difference instead of ending it.

mod score;
mod verdict;

#[cfg(test)]
mod tests;

use std::fmt;

use serde::Serialize;

use super::difference::{Difference, Standing};
use crate::data::Log;
use crate::model::{FilterKind, Problem, View};
use crate::table::{Cell, Table};

pub use score::FilterScore;
use score::Scored;
pub use verdict::{Linearising, LinearityVerdict};

/// States whose errors a table shows.
const SHOWN: usize = 6;

/// Several filters over one log, and whether linearising costs there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Linearity {
    /// The problem's own filter, then the others in their order.
    pub filters: Vec<FilterScore>,
    /// What they say together.
    pub verdict: LinearityVerdict,
}

impl Linearity {
    /// `candidate` (searched parameters in their own units) over `log` by `own` and by the others, which are the same problem
    /// ([`Problem::with_filter`]). A filter that fails has its reason. With `amplifications` each runs four times, else once.
    ///
    /// # Panics
    /// If `candidate` does not have one value per searched parameter.
    #[must_use]
    pub fn of(own: &Problem, others: &[Problem], log: &Log, candidate: &[f64], amplifications: bool) -> Self {
        let mut problems: Vec<&Problem> = vec![own];
        for other in others {
            if problems.iter().all(|problem| problem.filter.name() != other.filter.name()) {
                problems.push(other);
            }
        }
        let score = |problem: &&Problem| Scored::of(problem, log, candidate, amplifications);
        let scored: Vec<Scored> = problems.iter().map(score).collect();
        let verdict = LinearityVerdict::of(own, &scored);
        let filters = scored.iter().map(|one| one.beside(&scored[0])).collect();
        Self { filters, verdict }
    }

    /// What the report of a study says of its winner: the problem's own filter, the extended one, and one with sigma points.
    /// `None` where f and h are affine, or the filter is one that needs this.
    pub(super) fn of_winner(problem: &Problem, log: &Log, candidate: &[f64]) -> Option<Self> {
        let view = problem.filter.view();
        if view == View::None || problem.model.is_affine() {
            return None;
        }
        let missing = [View::Tangent, View::Points].into_iter().filter(|other| *other != view);
        let names = missing.filter_map(FilterKind::viewing);
        let others: Vec<Problem> = names.filter_map(|name| problem.with_filter(name).ok()).collect();
        Some(Self::of(problem, &others, log, candidate, false))
    }

    /// One sentence on the winner of a study.
    pub(super) fn of_the_tuned(&self) -> String {
        let Some(own) = self.filters.first() else { return String::new() };
        let is_tangent = [View::Tangent, View::TangentAgain].contains(&own.view);
        let is_worse = self.filters.iter().any(|other| other.verdict == Standing::Worse);
        // Q and R that suit one filter need not suit another: they may have taken in what its view of f and h costs.
        let may_hide = match self.verdict.linearising {
            Linearising::NoProblem => is_worse,
            Linearising::NotToldApart => true,
            Linearising::Exact | Linearising::Costs => false,
        };
        let hidden = if may_hide && is_tangent {
            format!(
                "; Q and R were tuned for the {} filter, which may hide what linearising costs: tune with another `kind` as \
                 well, and compare",
                own.filter
            )
        } else {
            String::new()
        };
        format!("With the tuned parameters, on the rows tuned on: {}{hidden}.", self.verdict.sentence)
    }

    /// A filter a row.
    pub(super) fn table(&self) -> Table {
        let states: Vec<&str> = self
            .filters
            .iter()
            .map(|one| one.rmse.iter().map(|(name, _)| name).take(SHOWN).collect::<Vec<_>>())
            .max_by_key(Vec::len)
            .unwrap_or_default();
        let heads = ["filter", "nll", "nll a row", "nll less own", "+-", "NIS"].map(str::to_owned).into_iter();
        let heads = heads.chain(states.iter().map(|state| format!("rmse {state}")));
        let mut table = Table::of(heads.chain(["amplification", "failed"].map(str::to_owned)));
        let number = |value: f64, digits: usize| if value.is_nan() { Cell::Empty } else { Cell::Number(value, digits) };
        for (place, one) in self.filters.iter().enumerate() {
            let name = if place == 0 { format!("{} (own)", one.filter) } else { one.filter.clone() };
            let beside = |value: f64| if place == 0 { Cell::Empty } else { number(value, 3) };
            let scores = [number(one.nll, 8), number(one.nll_per_row, 5), beside(one.difference)];
            let errors = states.iter().map(|state| one.rmse.get(state).map_or(Cell::Empty, |rmse| number(*rmse, 4)));
            let row = [Cell::text(name)].into_iter().chain(scores);
            let row = row.chain([beside(one.standard_error), number(one.nis_mean, 4)]).chain(errors);
            let amplification = number(one.amplification.unwrap_or(f64::NAN), 2);
            let failed = one.failed.as_ref().map_or(Cell::Empty, Cell::text);
            table.push(row.chain([amplification, failed]));
        }
        table
    }
}

impl fmt::Display for Linearity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n{}", self.table(), self.verdict)
    }
}
