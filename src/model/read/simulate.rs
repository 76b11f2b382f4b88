//! The `[simulate]` table.

use super::covariance::{self, Axes};
use super::node::{Fields, Node};
use crate::data::DataSpec;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::formula::{FormulaPlace, Names};
use crate::model::{Expr, Model, Parameters, SimulateSpec};
use crate::words::shorten;

const KEYS: [&str; 9] = ["steps", "dt", "parameters", "x0", "Q", "missing", "skip_first", "trajectories", "seed"];
const MAX_STEPS: u32 = 100_000_000;
const MAX_TRAJECTORIES: u32 = 1_000_000;

/// Reads it, if there is one.
pub(super) fn read(
    document: &Fields<'_>,
    model: &Model,
    parameters: &Parameters,
    names: &Names,
    data: &DataSpec,
) -> Result<Option<SimulateSpec>, Fault> {
    let Some(node) = document.get("simulate") else { return Ok(None) };
    let fields = node.table("a table", &KEYS)?;
    if !data.inputs.is_empty() {
        return Err(node.invalid("a log with inputs cannot be simulated, because nothing says what the inputs are"));
    }
    let missing = match fields.get("missing") {
        None => 0.0,
        Some(n) => {
            let share = n.number()?;
            if !(0.0..1.0).contains(&share) {
                return Err(n.bad_value(share, "a share from 0 to below 1"));
            }
            share
        }
    };
    Ok(Some(SimulateSpec {
        steps: fields.need("steps", "the number of rows after row 0")?.count(1, MAX_STEPS)?,
        dt: fields.optional("dt", Node::positive)?.unwrap_or(1.0),
        parameters: fields.optional("parameters", |n| read_parameters(n, parameters))?.unwrap_or_default(),
        x0: fields.optional("x0", |n| read_x0(n, &model.states))?,
        q: fields.optional("Q", |n| read_q(n, &model.states, names))?,
        missing,
        skip_first: fields.optional("skip_first", Node::boolean)?.unwrap_or(false),
        trajectories: fields.optional("trajectories", |n| n.count(1, MAX_TRAJECTORIES))?.unwrap_or(1),
        seed: fields.optional("seed", |n| n.integer(0, u64::MAX))?.unwrap_or(1),
    }))
}

/// `{ name = value }` for searched parameters.
fn read_parameters(node: &Node<'_>, parameters: &Parameters) -> Result<Vec<(String, f64)>, Fault> {
    let fields = node.table("a table of name = value", &[])?;
    let searched = parameters.names();
    let read = |(name, span, value): &(&str, _, Node<'_>)| {
        if searched.contains(name) {
            return Ok(((*name).to_owned(), value.number()?));
        }
        let nearest = nearest(name, searched.iter().copied());
        let known = searched.iter().map(|s| (*s).to_owned()).collect();
        let (key, name) = (node.key.clone(), shorten(name));
        Err(Fault::new(*span, Cause::NoSuch { key, what: "the searched parameter", name, nearest, known }))
    };
    fields.entries.iter().map(read).collect()
}

fn read_x0(node: &Node<'_>, states: &[String]) -> Result<Vec<f64>, Fault> {
    let entries = node.list("a list of numbers")?;
    if entries.len() != states.len() {
        let expected = format!("{}, one per state ({})", states.len(), states.join(", "));
        return Err(node.wrong_count(entries.len(), expected));
    }
    entries.iter().map(Node::number).collect()
}

/// Any covariance, or 0 for a truth without process noise.
fn read_q(node: &Node<'_>, states: &[String], names: &Names) -> Result<Vec<Expr>, Fault> {
    if (node.value.is_integer() || node.value.is_float()) && node.number()?.abs() == 0.0 {
        return Ok(vec![Expr::number(0.0); states.len() * states.len()]);
    }
    let axes = Axes { labels: states, what: "state", may_be_zero: true };
    covariance::read(node, axes, names, FormulaPlace::ProcessNoise)
}
