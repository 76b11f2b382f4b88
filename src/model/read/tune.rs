//! The `[tune]` table.

use super::node::{Fields, Node};
use super::{constraints, objectives, pick};
use crate::data::DataSpec;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::{Pick, Robust, TuneSpec};
use crate::objective::{Kind, Objective};
use crate::optimize::ALGORITHMS;
use crate::words::shorten;

const MAX_POPULATION: u32 = 16_777_216;
const MAX_GENERATIONS: u32 = 1_000_000;
const KEYS: [&str; 10] = [
    "algorithm",
    "objectives",
    "constraints",
    "pick",
    "population",
    "generations",
    "seed",
    "stop",
    "include_start",
    "polish",
];
/// Of one objective, and of several.
const DEFAULT_ALGORITHMS: [&str; 2] = ["pso", "nsga2"];

/// What a constraint bounds is there.
pub(super) fn check_robust(document: &Fields<'_>, tune: &TuneSpec, robust: Option<&Robust>) -> Result<(), Fault> {
    if robust.is_some() || tune.constraints.iter().all(|constraint| constraint.measure.kind != Kind::Rejected) {
        return Ok(());
    }
    let fields = document.need("tune", "a table")?.table("a table", &[])?;
    Err(fields.need("constraints", "a list of constraints")?.invalid(
        "without robust updates no row is rejected: set `robust` in [filter], or remove the constraint on `rejected`",
    ))
}

/// Reads `[tune]`, filling in defaults.
pub(super) fn tune(document: &Fields<'_>, data: &DataSpec, states: &[String]) -> Result<TuneSpec, Fault> {
    let node = document.get("tune");
    let Some(fields) = node.map(|n| n.table("a table", &KEYS)).transpose()? else { return Ok(defaults()) };
    let default = defaults();
    let objectives = match fields.get("objectives") {
        Some(node) => objectives::read(node, data, states)?,
        None => default.objectives,
    };
    let several = objectives.len() > 1;
    let by_default = || DEFAULT_ALGORITHMS[usize::from(several)].to_owned();
    let stop = fields.optional("stop", |n| n.table("a table", &["evaluations", "wall_time", "stall", "target"]))?;
    let stop = stop.as_ref();
    let stop_of = |key: &str| stop.and_then(|s| s.get(key));
    Ok(TuneSpec {
        algorithm: fields.optional("algorithm", read_algorithm)?.unwrap_or_else(by_default),
        constraints: fields.optional("constraints", |n| constraints::read(n, data, states))?.unwrap_or_default(),
        pick: fields.optional("pick", |n| pick::read(n, &objectives))?.unwrap_or_default(),
        population: fields.optional("population", |n| n.count(1, MAX_POPULATION))?.unwrap_or(default.population),
        generations: fields.optional("generations", |n| n.count(0, MAX_GENERATIONS))?.unwrap_or(default.generations),
        seed: fields.optional("seed", |n| n.integer(0, u64::MAX))?.unwrap_or(default.seed),
        evaluations: stop_of("evaluations").map(|n| n.integer(1, u64::MAX)).transpose()?,
        wall_time: stop_of("wall_time").map(Node::positive).transpose()?,
        stall: stop_of("stall").map(|n| n.count(1, MAX_GENERATIONS)).transpose()?,
        target: stop_of("target").map(Node::number).transpose()?,
        include_start: fields.optional("include_start", Node::boolean)?.unwrap_or(default.include_start),
        polish: fields.optional("polish", Node::boolean)?.unwrap_or(default.polish),
        objectives,
    })
}

fn defaults() -> TuneSpec {
    TuneSpec {
        algorithm: DEFAULT_ALGORITHMS[0].to_owned(),
        objectives: vec![Objective::new(Kind::Nll)],
        constraints: Vec::new(),
        pick: Pick::Knee,
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
