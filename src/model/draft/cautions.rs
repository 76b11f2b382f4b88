//! What a person should know before tuning a draft.

use super::roles::Roles;
use super::survey::{Content, Survey};

/// About columns named like inputs.
pub(super) fn inputs(survey: &Survey, roles: &Roles) -> Option<String> {
    let names = |columns: &[usize]| {
        let names = columns.iter().take(6).map(|&i| format!("{:?}", survey.columns[i].name));
        names.collect::<Vec<_>>().join(", ")
    };
    let measured = roles.measures_inputs.then(|| {
        format!(
            "{} named like known inputs, and measured here because nothing else is: known inputs belong in `inputs`, and in \
             formulas of `f`",
            is_or_are(&names(&roles.candidates), roles.candidates.len())
        )
    });
    let left_out = (!roles.inputs.is_empty()).then(|| {
        format!(
            "{} named like known inputs and left out: put them in `inputs` and in formulas of `f`, or in `measurements`",
            is_or_are(&names(&roles.inputs), roles.inputs.len())
        )
    });
    let both: Vec<String> = measured.into_iter().chain(left_out).collect();
    (!both.is_empty()).then(|| both.join("; "))
}

fn is_or_are(names: &str, count: usize) -> String {
    if count == 1 { format!("column {names} is") } else { format!("columns {names} are") }
}

/// Columns that are numbers but for some cells, and what those are.
pub(super) fn flaws(survey: &Survey) -> Vec<String> {
    let flawed = survey.columns.iter().filter(|c| matches!(c.content, Content::Numbers)).filter_map(|column| {
        let flaw = column.flaw()?;
        let (name, line, text) = (&column.name, flaw.place.line, &flaw.text);
        Some(format!(
            "column {name:?} is left out, because line {line} holds {text:?} among its numbers (empty the cell)"
        ))
    });
    flawed.collect()
}
