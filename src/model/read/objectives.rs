//! `[tune] objectives`, and what constraints share with them.

use super::node::{Fields, Node};
use crate::data::DataSpec;
use crate::model::error::{Cause, Fault, nearest};
use crate::objective::{Kind, Objective};
use crate::words::shorten;

/// The keys of what an objective or a constraint counts.
pub(super) const OPTIONS: [&str; 6] = ["states", "skip", "window", "ct", "lags", "ahead"];

/// Most lags of `whiteness`: each is a number that every candidate carries.
const LAGS: u32 = 64;

/// Most rows that `prediction` looks ahead: a candidate carries all states for each.
const AHEAD: u32 = 64;

/// Reads `objectives`: a list of different ones, at least one.
pub(super) fn read(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Objective>, Fault> {
    let entries = node.list("a list of objectives, such as [\"nll\"]")?;
    if entries.is_empty() {
        return Err(node.wrong_count(0, "at least one objective, such as [\"nll\"]"));
    }
    let mut objectives: Vec<Objective> = Vec::with_capacity(entries.len());
    for entry in &entries {
        let objective = read_objective(entry, data, states)?;
        if objectives.iter().any(|o| o.kind == objective.kind) {
            return Err(entry.invalid(format!("the objective `{}` is listed twice", objective.name())));
        }
        objectives.push(objective);
    }
    Ok(objectives)
}

/// `"rmse"` or `{ name = "rmse", states = ["d"], skip = 1 }`.
fn read_objective(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Objective, Fault> {
    let what = "the objective";
    if node.value.is_str() {
        return with_truth(node, Objective::new(find(node, what, &Kind::ALL)?), data, (states, what));
    }
    let fields = node.table("the name of an objective, or a table with `name`", &[&["name"], &OPTIONS[..]].concat())?;
    let kind = find(fields.need("name", "the name of an objective")?, what, &Kind::ALL)?;
    let objective = with_options(&fields, kind, data, states)?;
    with_truth(node, objective, data, (states, what))
}

/// The options of `kind` in a table that names it.
pub(super) fn with_options(
    fields: &Fields<'_>,
    kind: Kind,
    data: &DataSpec,
    states: &[String],
) -> Result<Objective, Fault> {
    let mut objective = Objective::new(kind);
    let refuse = |key: &str, applies: bool| match fields.get(key) {
        Some(n) if !applies => {
            Err(n.invalid(format!("it does not apply to the objective `{}`: remove it", kind.name())))
        }
        _ => Ok(()),
    };
    refuse("states", matches!(kind, Kind::Rmse | Kind::Distance))?;
    refuse("window", kind == Kind::Mismatch)?;
    refuse("ct", kind == Kind::Mismatch)?;
    refuse("lags", kind == Kind::Whiteness)?;
    refuse("ahead", kind == Kind::Prediction)?;
    objective.skip = fields.optional("skip", |n| n.count(0, u32::MAX))?.unwrap_or(0);
    objective.window = fields.optional("window", |n| n.count(1, u32::MAX))?.unwrap_or(objective.window);
    objective.lags = fields.optional("lags", |n| n.count(1, LAGS))?.unwrap_or(objective.lags);
    objective.ahead = fields.optional("ahead", read_ahead)?.unwrap_or_default();
    objective.ct_last = match fields.optional("ct", |n| Ok((n.clone(), n.string()?)))? {
        None | Some((_, "mean")) => false,
        Some((_, "last")) => true,
        Some((n, other)) => return Err(n.bad_value(format!("\"{}\"", shorten(other)), "\"mean\" or \"last\"")),
    };
    objective.states = fields.optional("states", |n| read_states(n, data, states))?.unwrap_or_default();
    Ok(objective)
}

fn find(node: &Node<'_>, what: &'static str, kinds: &[(&str, Kind)]) -> Result<Kind, Fault> {
    kind(node, node.string()?, what, kinds).map_err(|cause| node.fault(cause))
}

/// The kind called `name`, in messages about `node`.
pub(super) fn kind(node: &Node<'_>, name: &str, what: &'static str, kinds: &[(&str, Kind)]) -> Result<Kind, Cause> {
    kinds.iter().find(|(known, _)| *known == name).map(|(_, kind)| *kind).ok_or_else(|| {
        let nearest = nearest(name, kinds.iter().map(|(known, _)| *known));
        let known = kinds.iter().map(|(known, _)| (*known).to_owned()).collect();
        Cause::NoSuch { key: node.key.clone(), what, name: shorten(name), nearest, known }
    })
}

/// `5` or `[1, 5, 20]`: different distances in rows.
fn read_ahead(node: &Node<'_>) -> Result<Vec<usize>, Fault> {
    if !node.value.is_array() {
        return Ok(vec![node.count(1, AHEAD)?]);
    }
    let entries = node.list("a number of rows, or a list of them")?;
    if entries.is_empty() {
        return Err(node.wrong_count(0, "at least one number of rows, such as [1, 5]"));
    }
    let mut ahead = Vec::with_capacity(entries.len());
    for entry in &entries {
        let rows = entry.count(1, AHEAD)?;
        if ahead.contains(&rows) {
            return Err(entry.invalid(format!("{rows} rows ahead are listed twice: remove one")));
        }
        ahead.push(rows);
    }
    Ok(ahead)
}

/// Indices of named states, each with truth.
fn read_states(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<usize>, Fault> {
    let names = node.names("a list of state names")?;
    let entries = node.list("a list of state names")?;
    names
        .iter()
        .zip(&entries)
        .map(|(name, entry)| {
            let index = states.iter().position(|s| s == name).ok_or_else(|| {
                let nearest = nearest(name, states.iter().map(String::as_str));
                let (key, name, known) = (entry.key.clone(), shorten(name), states.to_vec());
                entry.fault(Cause::NoSuch { key, what: "the state", name, nearest, known })
            })?;
            match data.truth.iter().any(|(state, _)| state == name) {
                true => Ok(index),
                false => Err(entry.invalid(format!("the state `{name}` has no truth: give its column in data.truth"))),
            }
        })
        .collect()
}

/// Checks that the truth is there which an objective or constraint (`what`) needs; `rmse` and `distance` default to all
/// states that have it.
pub(super) fn with_truth(
    node: &Node<'_>,
    mut objective: Objective,
    data: &DataSpec,
    (states, what): (&[String], &str),
) -> Result<Objective, Fault> {
    let has_truth = |state: &String| data.truth.iter().any(|(s, _)| s == state);
    let name = objective.name();
    if objective.kind.needs_truth() && data.truth.is_empty() {
        return Err(node.invalid(format!("{what} `{name}` needs the true states: give their columns in data.truth")));
    }
    if matches!(objective.kind, Kind::Nees | Kind::NeesMean)
        && let Some(state) = states.iter().find(|s| !has_truth(s))
    {
        return Err(node.invalid(format!("{what} `{name}` needs truth of all states, and `{state}` has none")));
    }
    if matches!(objective.kind, Kind::Rmse | Kind::Distance) && objective.states.is_empty() {
        objective.states = states.iter().enumerate().filter(|(_, s)| has_truth(s)).map(|(i, _)| i).collect();
    }
    Ok(objective)
}
