//! Constraints of a study, held against its winner.

use std::fmt;

use serde::Serialize;

use super::document::Section;
use crate::model::Problem;
use crate::number::{exact, significant};
use crate::objective::{Constraint, Relation};
use crate::study::Outcome;
use crate::table::{Cell, Table};

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

/// Every constraint, on training and on held-out rows where there is a split; `None` without one.
pub(super) fn section(checks: &[ConstraintCheck], held_out: Option<&[ConstraintCheck]>) -> Option<Section> {
    let head = if held_out.is_some() { "constraint, f64" } else { "constraint, in-sample, f64" };
    let mut table = Table::of([head, "rows", "baseline", "tuned", "note"]);
    let mut push = |name: String, rows: &str, check: &ConstraintCheck| {
        let [baseline, tuned] =
            [check.baseline, check.value].map(|value| value.map_or("-".into(), |v| Cell::Number(v, DIGITS)));
        table.push([name.into(), rows.into(), baseline, tuned, check.note().into()]);
    };
    for (i, check) in checks.iter().enumerate() {
        push(check.to_string(), if held_out.is_some() { "training" } else { "" }, check);
        if let Some(check) = held_out.and_then(|checks| checks.get(i)) {
            push(String::new(), "held out", check);
        }
    }
    (!checks.is_empty()).then(|| Section::untitled("Constraints").with(table))
}
