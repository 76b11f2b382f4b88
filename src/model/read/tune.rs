//! The `[tune]` table.

use super::node::{Fields, Node, shorten};
use crate::model::error::{Cause, Fault, nearest};
use crate::model::{DataSpec, TuneSpec};
use crate::objective::{Kind, Objective};
use crate::optimize::ALGORITHMS;

const MAX_POPULATION: u32 = 16_777_216;
const MAX_GENERATIONS: u32 = 1_000_000;
const KEYS: [&str; 8] =
    ["algorithm", "objectives", "population", "generations", "seed", "stop", "include_start", "polish"];

/// Reads `[tune]`, filling in defaults.
pub(super) fn tune(document: &Fields<'_>, data: &DataSpec, states: &[String]) -> Result<TuneSpec, Fault> {
    let node = document.get("tune");
    let Some(fields) = node.map(|n| n.table("a table", &KEYS)).transpose()? else { return Ok(defaults()) };
    let default = defaults();
    let objectives = match fields.get("objectives") {
        Some(node) => read_objectives(node, data, states)?,
        None => default.objectives,
    };
    let stop = fields.optional("stop", |n| n.table("a table", &["evaluations", "wall_time", "stall", "target"]))?;
    let stop = stop.as_ref();
    let stop_of = |key: &str| stop.and_then(|s| s.get(key));
    Ok(TuneSpec {
        algorithm: fields.optional("algorithm", read_algorithm)?.unwrap_or(default.algorithm),
        population: fields.optional("population", |n| n.count(1, MAX_POPULATION))?.unwrap_or(default.population),
        generations: fields.optional("generations", |n| n.count(0, MAX_GENERATIONS))?.unwrap_or(default.generations),
        seed: fields.optional("seed", |n| n.integer(0, u64::MAX))?.unwrap_or(default.seed),
        evaluations: stop_of("evaluations").map(|n| n.integer(1, u64::MAX)).transpose()?,
        wall_time: stop_of("wall_time").map(Node::positive).transpose()?,
        stall: stop_of("stall").map(|n| n.count(1, MAX_GENERATIONS)).transpose()?,
        target: stop_of("target").map(Node::number).transpose()?,
        include_start: fields.optional("include_start", Node::boolean)?.unwrap_or(default.include_start),
        polish: fields.optional("polish", Node::boolean)?.unwrap_or(objectives.len() == 1),
        objectives,
    })
}

fn defaults() -> TuneSpec {
    TuneSpec {
        algorithm: "pso".to_owned(),
        objectives: vec![Objective::new(Kind::Nll)],
        population: 256,
        generations: 60,
        seed: 1,
        evaluations: None,
        wall_time: None,
        stall: None,
        target: None,
        include_start: true,
        polish: true,
    }
}

fn read_algorithm(node: &Node<'_>) -> Result<String, Fault> {
    let name = node.string()?;
    let names = || ALGORITHMS.iter().map(|a| a.name);
    if names().any(|known| known == name) {
        return Ok(name.to_owned());
    }
    let nearest = nearest(name, names());
    let known = names().map(str::to_owned).collect();
    let (key, name) = (node.key.clone(), shorten(name));
    Err(node.fault(Cause::NoSuch { key, what: "the algorithm", name, nearest, known }))
}

fn read_objectives(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Objective>, Fault> {
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
    if node.value.is_str() {
        return with_truth(node, Objective::new(find_objective(node)?), data, states);
    }
    let fields =
        node.table("the name of an objective, or a table with `name`", &["name", "states", "skip", "window", "ct"])?;
    let mut objective = Objective::new(find_objective(fields.need("name", "the name of an objective")?)?);
    let kind = objective.kind;
    let refuse = |key: &str, applies: bool| match fields.get(key) {
        Some(n) if !applies => {
            Err(n.invalid(format!("it does not apply to the objective `{}`: remove it", kind.name())))
        }
        _ => Ok(()),
    };
    refuse("states", matches!(kind, Kind::Rmse | Kind::Distance))?;
    refuse("window", kind == Kind::Mismatch)?;
    refuse("ct", kind == Kind::Mismatch)?;
    objective.skip = fields.optional("skip", |n| n.count(0, u32::MAX))?.unwrap_or(0);
    objective.window = fields.optional("window", |n| n.count(1, u32::MAX))?.unwrap_or(objective.window);
    objective.ct_last = match fields.optional("ct", |n| Ok((n.clone(), n.string()?)))? {
        None | Some((_, "mean")) => false,
        Some((_, "last")) => true,
        Some((n, other)) => return Err(n.bad_value(format!("\"{}\"", shorten(other)), "\"mean\" or \"last\"")),
    };
    objective.states = fields.optional("states", |n| read_states(n, data, states))?.unwrap_or_default();
    with_truth(node, objective, data, states)
}

fn find_objective(node: &Node<'_>) -> Result<Kind, Fault> {
    let name = node.string()?;
    Kind::ALL.iter().find(|(known, _)| *known == name).map(|(_, kind)| *kind).ok_or_else(|| {
        let nearest = nearest(name, Kind::ALL.iter().map(|(known, _)| *known));
        let known = Kind::ALL.iter().map(|(known, _)| (*known).to_owned()).collect();
        let (key, name) = (node.key.clone(), shorten(name));
        node.fault(Cause::NoSuch { key, what: "the objective", name, nearest, known })
    })
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

/// Checks that the truth an objective needs is there; `rmse` and `distance` default to all states that have it.
fn with_truth(
    node: &Node<'_>,
    mut objective: Objective,
    data: &DataSpec,
    states: &[String],
) -> Result<Objective, Fault> {
    let has_truth = |state: &String| data.truth.iter().any(|(s, _)| s == state);
    let name = objective.name();
    if objective.kind.needs_truth() && data.truth.is_empty() {
        return Err(
            node.invalid(format!("the objective `{name}` needs the true states: give their columns in data.truth"))
        );
    }
    if objective.kind == Kind::Nees
        && let Some(state) = states.iter().find(|s| !has_truth(s))
    {
        return Err(node.invalid(format!("the objective `nees` needs truth of all states, and `{state}` has none")));
    }
    if matches!(objective.kind, Kind::Rmse | Kind::Distance) && objective.states.is_empty() {
        objective.states = states.iter().enumerate().filter(|(_, s)| has_truth(s)).map(|(i, _)| i).collect();
    }
    Ok(objective)
}
