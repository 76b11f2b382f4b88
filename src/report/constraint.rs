//! Constraints of a study, held against its winner.

use serde::Serialize;

use super::{TextTable, significant};
use crate::model::Problem;
use crate::objective::{Constraint, Relation};
use crate::study::Outcome;

/// Digits of values.
const DIGITS: usize = 8;

/// A constraint with the values of winner and baseline, by the f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConstraintCheck {
    /// What is bounded.
    pub measure: &'static str,
    /// On which side.
    pub relation: Relation,
    /// By what.
    pub limit: f64,
    /// The winner's value.
    pub value: f64,
    /// The baseline's; `None` where it fails.
    pub baseline: Option<f64>,
    /// Whether the winner meets it.
    pub met: bool,
}

impl ConstraintCheck {
    /// Whether the baseline meets it; not where it fails.
    pub(super) fn met_by_baseline(&self) -> bool {
        self.baseline.is_some_and(|value| match self.relation {
            Relation::AtMost => value <= self.limit,
            Relation::AtLeast => value >= self.limit,
        })
    }
}

/// All constraints of a problem against the winner of a study; none without a winner.
#[must_use]
pub fn constraint_checks(problem: &Problem, outcome: &Outcome) -> Vec<ConstraintCheck> {
    let values = outcome.winner.as_ref().map(|winner| winner.constraints.as_slice()).unwrap_or_default();
    let baseline = outcome.baseline.constraints.as_deref().unwrap_or_default();
    let check = |(i, (constraint, value)): (usize, (&Constraint, &f64))| ConstraintCheck {
        measure: constraint.measure.name(),
        relation: constraint.relation,
        limit: constraint.limit,
        value: *value,
        baseline: baseline.get(i).copied(),
        met: constraint.violation(*value) <= 0.0,
    };
    problem.tune.constraints.iter().zip(values).enumerate().map(check).collect()
}

/// "no candidate meets every constraint; the one that violates them least has nis_mean 1.5 (<= 1.2 asked)".
#[must_use]
pub fn unmet(checks: &[ConstraintCheck]) -> Option<String> {
    let misses: Vec<String> = checks
        .iter()
        .filter(|check| !check.met)
        .map(|c| format!("{} {} ({} {} asked)", c.measure, significant(c.value, 4), c.relation, c.limit))
        .collect();
    (!misses.is_empty()).then(|| {
        format!(
            "no candidate meets every constraint; the one that violates them least has {} (search longer, widen the \
             bounds or relax the limits)",
            misses.join(" and ")
        )
    })
}

pub(super) fn table(checks: &[ConstraintCheck]) -> TextTable {
    let mut table = TextTable::new(["constraint, in-sample, f64", "baseline", "tuned", "note"]);
    for check in checks {
        let baseline = check.baseline.map_or_else(|| "failed".to_owned(), |value| significant(value, DIGITS));
        let note = if check.met { "met" } else { "not met" };
        let name = format!("{} {} {}", check.measure, check.relation, check.limit);
        table.push([name, baseline, significant(check.value, DIGITS), note.to_owned()]);
    }
    table
}
