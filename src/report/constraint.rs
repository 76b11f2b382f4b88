//! Constraints of a study, held against its winner.

use std::fmt;

use serde::Serialize;

use super::{Validation, exact, significant};
use crate::model::Problem;
use crate::objective::{Constraint, Relation};
use crate::study::Outcome;
use crate::table::Table;

/// Digits of values.
const DIGITS: usize = 8;

/// A constraint with the values of winner and baseline over one part of the log, by the f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConstraintCheck {
    /// What is bounded.
    pub measure: &'static str,
    /// On which side.
    pub relation: Relation,
    /// By what.
    pub limit: f64,
    /// The winner's value; `None` where it fails, or held-out rows have nothing that this measures.
    pub value: Option<f64>,
    /// The baseline's, likewise.
    pub baseline: Option<f64>,
    /// Whether the winner meets it.
    pub met: bool,
}

impl ConstraintCheck {
    fn of(constraint: &Constraint, value: Option<f64>, baseline: Option<f64>) -> Self {
        Self {
            measure: constraint.measure.name(),
            relation: constraint.relation,
            limit: constraint.limit,
            value,
            baseline,
            met: value.is_some_and(|value| constraint.violation(value) <= 0.0),
        }
    }

    /// Whether the baseline meets it; not where it fails.
    pub(super) fn met_by_baseline(&self) -> bool {
        self.baseline.is_some_and(|value| match self.relation {
            Relation::AtMost => value <= self.limit,
            Relation::AtLeast => value >= self.limit,
        })
    }

    /// "met", "not met", or why that cannot be said.
    pub(super) const fn note(&self) -> &'static str {
        match (self.value, self.met) {
            (None, _) => "not measured",
            (Some(_), true) => "met",
            (Some(_), false) => "not met",
        }
    }

    /// "nis_mean 1.5 (<= 1.2 asked)".
    fn miss(&self) -> Option<String> {
        let value = self.value.filter(|_| !self.met)?;
        Some(format!("{} {} ({} {} asked)", self.measure, significant(value, 4), self.relation, exact(self.limit)))
    }
}

impl fmt::Display for ConstraintCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.measure, self.relation, exact(self.limit))
    }
}

/// All constraints of a problem against the winner of a study; none without a winner.
#[must_use]
pub fn constraint_checks(problem: &Problem, outcome: &Outcome) -> Vec<ConstraintCheck> {
    let values = outcome.winner.as_ref().map(|winner| winner.constraints.as_slice()).unwrap_or_default();
    let baseline = outcome.baseline.constraints.as_deref().unwrap_or_default();
    let check = |(i, (constraint, value)): (usize, (&Constraint, &f64))| {
        ConstraintCheck::of(constraint, Some(*value), baseline.get(i).copied())
    };
    problem.tune.constraints.iter().zip(values).enumerate().map(check).collect()
}

/// All constraints against their measures over held-out rows; `None` of a candidate that fails there.
pub(super) fn checks_held_out(
    problem: &Problem,
    baseline: Option<&[f64]>,
    winner: Option<&[f64]>,
) -> Vec<ConstraintCheck> {
    let finite = |values: Option<&[f64]>, i: usize| values?.get(i).copied().filter(|value| value.is_finite());
    let constraints = problem.tune.constraints.iter().enumerate();
    constraints.map(|(i, constraint)| ConstraintCheck::of(constraint, finite(winner, i), finite(baseline, i))).collect()
}

/// "no candidate meets every constraint; the one that violates them least has nis_mean 1.5 (<= 1.2 asked)".
#[must_use]
pub fn unmet(checks: &[ConstraintCheck]) -> Option<String> {
    let misses = misses(checks)?;
    Some(format!(
        "no candidate meets every constraint; the one that violates them least has {misses} (search longer, widen the \
         bounds or relax the limits)",
    ))
}

/// What is measured and not met: "nis_mean 1.5 (<= 1.2 asked)"; `None` if that is nothing.
pub(super) fn misses(checks: &[ConstraintCheck]) -> Option<String> {
    let misses: Vec<String> = checks.iter().filter_map(ConstraintCheck::miss).collect();
    (!misses.is_empty()).then(|| misses.join(" and "))
}

/// The values of a check as a person reads them: baseline, tuned.
pub(super) fn cells(check: &ConstraintCheck) -> [String; 2] {
    [check.baseline, check.value].map(|value| value.map_or_else(|| "-".to_owned(), |v| significant(v, DIGITS)))
}

/// Every constraint, on training and on held-out rows where there is a split.
pub(super) fn table(checks: &[ConstraintCheck], validation: Option<&Validation>) -> Table {
    let Some(validation) = validation else {
        let mut table = Table::of(["constraint, in-sample, f64", "baseline", "tuned", "note"]);
        for check in checks {
            let [baseline, tuned] = cells(check);
            table.push([check.to_string(), baseline, tuned, check.note().to_owned()]);
        }
        return table;
    };
    let mut table = Table::of(["constraint, f64", "rows", "baseline", "tuned", "note"]);
    for (train, held_out) in checks.iter().zip(&validation.constraints) {
        let rows = [(train.to_string(), "training", train), (String::new(), "held out", held_out)];
        for (name, rows, check) in rows {
            let [baseline, tuned] = cells(check);
            table.push([name, rows.to_owned(), baseline, tuned, check.note().to_owned()]);
        }
    }
    table
}
