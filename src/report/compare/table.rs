//! The comparison as a table: one column a run.

use super::{Comparison, Run, RunHeldOut, RunValidation};
use crate::number::{count, seconds, short, significant};
use crate::report::Standing;
use crate::table::Table;

/// Digits of parameters and objectives.
const DIGITS: usize = 8;

pub(super) fn of(comparison: &Comparison) -> Table {
    let runs = &comparison.runs;
    let row = |label: &str, cell: &dyn Fn(&Run) -> String| {
        [label.to_owned()].into_iter().chain(runs.iter().map(cell)).collect::<Vec<_>>()
    };
    let mut table = Table::of(row("", &|run| run.path.clone()));
    let mut push = |row: Vec<String>| table.push(row);
    push(row("problem", &|run| run.problem.clone()));
    push(row("search", &|run| format!("{}, seed {}", run.algorithm, run.seed)));
    for (name, unit) in parameters(runs) {
        let value = |run: &Run| run.parameters.get(&name).map_or_else(|| "-".to_owned(), |v| short(*v, DIGITS));
        push(row(&format!("{name}{unit}"), &value));
    }
    for name in union(runs.iter().map(|run| run.objectives.iter().map(|(name, _)| name).collect())) {
        push(objective(comparison, &name, false));
        if runs.iter().any(|run| run.validation.is_some()) {
            push(objective(comparison, &name, true));
        }
    }
    push(row("mean NIS", &nis));
    push(row("judged on", &|run| if run.consistency_on == "held_out" { "held-out rows" } else { "in-sample" }.into()));
    push(row("verdict", &|run| run.consistency.verdict.replace('_', " ")));
    if runs.iter().any(|run| run.validation.is_some()) {
        push(row("against baseline, held out", &against_baseline));
    }
    if runs.iter().any(|run| run.feasible == Some(false)) {
        push(row("constraints", &|run| if run.feasible == Some(false) { "not met" } else { "met" }.into()));
    }
    push(row("evaluations", &|run| count(run.evaluations)));
    push(row("time", &|run| seconds(run.wall_s)));
    push(row("device", &|run| format!("{} {}", run.device.backend, run.device.precision)));
    table
}

fn objective(comparison: &Comparison, name: &str, held_out: bool) -> Vec<String> {
    let best = if held_out { &comparison.best_held_out } else { &comparison.best };
    let best = best.get(name).copied().flatten();
    let validated = comparison.runs.iter().any(|run| run.validation.is_some());
    let part = match (held_out, validated) {
        (true, _) => ", held out",
        (false, true) => ", training",
        (false, false) => "",
    };
    let cell = |(i, run): (usize, &Run)| {
        let failed = held_out && run.validation.as_ref().is_some_and(|v| v.winner.is_none());
        let star = if best == Some(i) { " *" } else { "" };
        match run.objective(name, held_out) {
            Some(value) => format!("{}{star}", significant(value, DIGITS)),
            None => if failed { "failed" } else { "-" }.to_owned(),
        }
    };
    [format!("{name}{part}")].into_iter().chain(comparison.runs.iter().enumerate().map(cell)).collect()
}

fn nis(run: &Run) -> String {
    let c = &run.consistency;
    let (Some(mean), Some(low), Some(high)) = (c.nis_mean, c.nis_low, c.nis_high) else { return "-".to_owned() };
    format!("{} (band {low:.3}..{high:.3})", short(mean, 4))
}

fn against_baseline(run: &Run) -> String {
    let told = match (&run.validation, &run.held_out) {
        (None, _) => "-",
        (Some(v), _) if v.winner.is_none() => "fails",
        (Some(v), _) if v.baseline.is_none() => "baseline fails",
        (Some(_), Some(told)) => return format!("{}{}", standing(told.verdict), by(told)),
        (Some(v), None) if v.worse => "worse",
        (Some(v), None) if is_worse_somewhere(v) => "a trade",
        (Some(_), None) => "no worse",
    };
    told.to_owned()
}

const fn standing(standing: Standing) -> &'static str {
    match standing {
        Standing::Better => "better",
        Standing::Worse => "worse",
        Standing::NotToldApart => "not told apart",
    }
}

/// The difference under the first objective, above 0 where the winner is better.
fn by(told: &RunHeldOut) -> String {
    let (Some(difference), Some(error)) = (told.difference, told.standard_error) else { return String::new() };
    format!(" ({} +- {})", significant(difference, 3), significant(error, 3))
}

/// Whether the winner is above the baseline under some objective.
fn is_worse_somewhere(validation: &RunValidation) -> bool {
    let (Some(baseline), Some(winner)) = (&validation.baseline, &validation.winner) else { return false };
    winner.iter().any(|(name, winner)| winner.zip(baseline.get(name).copied().flatten()).is_some_and(|(w, b)| w > b))
}

/// Every parameter of any run, with its unit.
fn parameters(runs: &[Run]) -> Vec<(String, String)> {
    let unit = |name: &str| {
        let unit = runs.iter().find_map(|run| run.units.get(name).cloned().flatten());
        unit.map_or_else(String::new, |unit| format!(" [{unit}]"))
    };
    let names = union(runs.iter().map(|run| run.parameters.iter().map(|(name, _)| name).collect()));
    names.into_iter().map(|name| (name.clone(), unit(&name))).collect()
}

/// Names in the order of their first appearance.
fn union<'a>(lists: impl Iterator<Item = Vec<&'a str>>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in lists.flatten() {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}
