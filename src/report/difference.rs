//! How far apart two candidates are on held-out rows, and whether these rows are enough to tell.

mod parts;
mod per_row;
mod standard_error;

#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Named, significant};
use crate::data::HeldOut;
use crate::model::Problem;
use crate::objective::Objective;
use per_row::{Influence, PerRow, per_row};

/// Standard errors beyond which a difference is told: those of a 95 % interval.
const TOLD: f64 = 1.96;

/// What held-out rows say of the winner beside the baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// Better by more than 1.96 standard errors; or it runs where the baseline fails.
    Better,
    /// Worse by more than that; or it fails where the baseline runs.
    Worse,
    /// Neither, or too few rows to say.
    NotToldApart,
}

/// The difference under one objective.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// Baseline less winner, in the objective's own unit: above 0 the winner is better. NaN where one fails.
    pub difference: f64,
    /// Its standard error; NaN where there are too few rows. Difference +- 1.96 of it is a 95 % interval.
    pub standard_error: f64,
    /// Whether the difference is more than that.
    pub verdict: Standing,
}

/// The differences under all objectives. The verdict is better or worse where one objective says so and none says the
/// contrary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeldOutDifference {
    /// The first objective, whose difference follows.
    pub objective: String,
    /// As [`Difference::difference`].
    pub difference: f64,
    /// As [`Difference::standard_error`].
    pub standard_error: f64,
    /// Of all objectives together.
    pub verdict: Standing,
    /// One entry an objective.
    pub by_objective: Named<Difference>,
}

impl Difference {
    fn of(difference: f64, standard_error: f64) -> Self {
        // A standard error of 0 is that of candidates alike in every row.
        let told = difference.abs() > TOLD * standard_error;
        let verdict = match difference {
            d if told && d > 0.0 => Standing::Better,
            d if told && d < 0.0 => Standing::Worse,
            _ => Standing::NotToldApart,
        };
        Self { difference, standard_error, verdict }
    }

    /// Of two runs over the same rows by what each row adds to a sum, as to `nll`: by trajectory and row.
    pub(super) fn of_sums(baseline: &[Vec<f64>], other: &[Vec<f64>]) -> Self {
        let [baseline, other] = [baseline, other].map(|rows| {
            let measured: Vec<&Vec<f64>> = rows.iter().filter(|rows| !rows.is_empty()).collect();
            let total: f64 = measured.iter().copied().flatten().sum();
            let mean = total / measured.iter().map(|rows| rows.len()).sum::<usize>() as f64;
            let around = |rows: &Vec<f64>| rows.iter().map(|row| row - mean).collect();
            (total, Influence { rows: measured.into_iter().map(around).collect(), trajectories: None })
        });
        let error = standard_error::paired(baseline.1, &other.1);
        Self::of(baseline.0 - other.0, error.unwrap_or(f64::NAN))
    }

    /// "35.1 +- 4.2 nats", without its sign.
    pub(super) fn amount(&self, objective: &str) -> String {
        let digits = |value: f64| significant(value, 3);
        let unit = if objective == "nll" { " nats" } else { "" };
        let error = if self.standard_error.is_nan() { "?".to_owned() } else { digits(self.standard_error) };
        format!("{} +- {error}{unit}", digits(self.difference.abs()))
    }
}

impl HeldOutDifference {
    /// Of two candidates with their objectives on the held-out rows, each `None` where its filter fails there.
    pub(super) fn of(
        problem: &Problem,
        held_out: &HeldOut,
        (baseline, baseline_costs): (&[f64], Option<&[f64]>),
        (winner, winner_costs): (&[f64], Option<&[f64]>),
    ) -> Self {
        let objectives = &problem.tune.objectives;
        let names = || objectives.iter().map(Objective::name);
        let (Some(baseline_costs), Some(winner_costs)) = (baseline_costs, winner_costs) else {
            let verdict = match (baseline_costs, winner_costs) {
                (None, Some(_)) => Standing::Better,
                (Some(_), None) => Standing::Worse,
                _ => Standing::NotToldApart,
            };
            let none = Difference { difference: f64::NAN, standard_error: f64::NAN, verdict };
            return Self::together(Named::new(names(), objectives.iter().map(|_| none)));
        };
        let rows = [baseline, winner].map(|candidate| per_row(problem, held_out, candidate));
        let error = |i: usize| match &rows {
            [Some(baseline), Some(winner)] => {
                let of = |rows: &[PerRow]| rows.get(i).map(|rows| rows.influence(&objectives[i]));
                standard_error::paired(of(baseline)?, &of(winner)?)
            }
            _ => None,
        };
        let differences = baseline_costs.iter().zip(winner_costs).enumerate();
        let differences = differences.map(|(i, (b, w))| Difference::of(b - w, error(i).unwrap_or(f64::NAN)));
        Self::together(Named::new(names(), differences))
    }

    fn together(by_objective: Named<Difference>) -> Self {
        let says = |standing: Standing| by_objective.iter().any(|(_, d)| d.verdict == standing);
        let verdict = match (says(Standing::Better), says(Standing::Worse)) {
            (true, false) => Standing::Better,
            (false, true) => Standing::Worse,
            _ => Standing::NotToldApart,
        };
        let first = by_objective.iter().next().map(|(name, d)| (name.to_owned(), *d));
        let (objective, first) = first.unwrap_or_else(|| (String::new(), Difference::of(f64::NAN, f64::NAN)));
        let Difference { difference, standard_error, .. } = first;
        Self { objective, difference, standard_error, verdict, by_objective }
    }

    /// Whether the winner is better under one objective and worse under another, and both are told.
    #[must_use]
    pub fn is_trade(&self) -> bool {
        let says = |standing: Standing| self.by_objective.iter().any(|(_, d)| d.verdict == standing);
        says(Standing::Better) && says(Standing::Worse)
    }

    /// By how much, under the objectives that `standing` holds for, or under all: "nll 35.1 +- 4.2 nats".
    pub(super) fn amounts(&self, standing: Standing) -> String {
        let chosen = self.by_objective.iter().filter(|(_, d)| d.verdict == standing && !d.difference.is_nan());
        let one = |(name, d): (&str, &Difference)| format!("`{name}` by {}", d.amount(name));
        chosen.map(one).collect::<Vec<_>>().join(" and ")
    }

    /// The objectives that are not told apart: "`nll` 1.19 +- 2.3 nats worse".
    pub(super) fn untold(&self) -> String {
        let one = |(name, d): (&str, &Difference)| {
            let side = if d.difference < 0.0 { "worse" } else { "better" };
            format!("`{name}` is {} {side}", d.amount(name))
        };
        self.by_objective.iter().filter(|(_, d)| !d.difference.is_nan()).map(one).collect::<Vec<_>>().join(", ")
    }
}

/// Whose values the winner is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StartOf {
    /// The user's.
    Yours,
    /// Those that `kfgpu init` guessed.
    Drafted,
}

impl StartOf {
    pub(super) fn of(problem: &Problem) -> Self {
        if problem.is_drafted() { Self::Drafted } else { Self::Yours }
    }

    /// What to do with it where the winner is no better.
    pub(super) const fn keep(self) -> &'static str {
        match self {
            Self::Yours => "Keep your own parameters",
            Self::Drafted => "Keep the drafted start",
        }
    }

    /// The verb for it: "which yours do", "which the drafted start does".
    pub(super) const fn verb(self, yours: &'static str, drafted: &'static str) -> &'static str {
        match self {
            Self::Yours => yours,
            Self::Drafted => drafted,
        }
    }
}

impl fmt::Display for StartOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.verb("yours", "the drafted start"))
    }
}
