//! The `[data]` table.

use toml::de::DeValue;

use super::format;
use super::names::{check_name, limit};
use super::node::{Fields, Node};
use super::sensor;
use crate::data::{DataSpec, SplitBy, ValidateSpec};
use crate::model::Span;
use crate::model::error::{Cause, Fault, nearest};
use crate::words::shorten;

const MAX_MEASUREMENTS: usize = 32;
const MAX_INPUTS: usize = 64;
#[rustfmt::skip]
const KEYS: [&str; 15] = [
    "file", "time", "measurements", "inputs", "truth", "trajectory", "validate",
    // See `super::format`.
    "time_unit", "separator", "decimal", "thousands", "header_line", "skip_lines",
    "sensor", "ignore_sensors",
];

/// Reads it; truth is checked against the states later, by [`check_truth`].
pub(super) fn read(document: &Fields<'_>) -> Result<DataSpec, Fault> {
    let node = document.need("data", "a table with `file` and `measurements`")?;
    let fields = node.table("a table", &KEYS)?;
    let file = fields.optional("file", Node::name)?;
    if file.is_none() && document.get("simulate").is_none() {
        fields.need("file", "the log's file name, relative to the problem file, or a [simulate] table")?;
    }
    let expected = "a list of column names";
    let sensors = sensor::list(document, &fields)?;
    let measurements = match (&sensors, fields.get("measurements")) {
        (None, _) => fields.need("measurements", expected)?.names(expected)?,
        (Some(sensors), given) => sensor::names(sensors, given)?,
    };
    let inputs = fields.get("inputs");
    let time = fields.optional("time", Node::name)?;
    let spec = DataSpec {
        file,
        time_unit: format::read_time_unit(&fields, time.is_some())?,
        time,
        measurements,
        sensors: sensors.unwrap_or_default().into_iter().map(|sensor| sensor.spec).collect(),
        sensor: fields.optional("sensor", Node::name)?,
        ignore_sensors: fields.optional("ignore_sensors", |n| n.names("a list of labels"))?.unwrap_or_default(),
        readers: Vec::new(),
        inputs: fields.optional("inputs", |n| n.names(expected))?.unwrap_or_default(),
        truth: fields.optional("truth", read_truth)?.unwrap_or_default(),
        trajectory: fields.optional("trajectory", Node::name)?,
        validate: fields.optional("validate", read_validate)?.flatten(),
        format: format::read(&fields)?,
    };
    let at = fields.get("measurements").or_else(|| document.get("sensor")).map_or(node.span, |n| n.span);
    limit(at, spec.measurements.len(), "measurements", MAX_MEASUREMENTS)?;
    if let Some(inputs) = inputs {
        limit(inputs.span, spec.inputs.len(), "inputs", MAX_INPUTS)?;
        for (node, name) in inputs.list(expected)?.iter().zip(&spec.inputs) {
            check_name(name, node.span)?;
        }
    }
    Ok(spec)
}

/// `{ state = "column" }`, in file order.
fn read_truth(node: &Node<'_>) -> Result<Vec<(String, String)>, Fault> {
    let fields = node.table("a table of state = \"column\"", &[])?;
    fields.entries.iter().map(|(state, _, column)| Ok(((*state).to_owned(), column.name()?))).collect()
}

/// A share, `{ share = 0.3, by = "time" }`, or `false`.
fn read_validate(node: &Node<'_>) -> Result<Option<ValidateSpec>, Fault> {
    match node.value {
        DeValue::Boolean(false) => Ok(None),
        DeValue::Integer(_) | DeValue::Float(_) => Ok(Some(ValidateSpec { share: read_share(node)?, by: None })),
        DeValue::Table(_) => {
            let fields = node.table("a table", &["share", "by"])?;
            let share = read_share(fields.need("share", "the share to hold out, such as 0.3")?)?;
            Ok(Some(ValidateSpec { share, by: fields.optional("by", read_by)? }))
        }
        _ => Err(node.wrong_type("a share such as 0.3, a table with `share` and `by`, or false")),
    }
}

fn read_share(node: &Node<'_>) -> Result<f64, Fault> {
    let share = node.number()?;
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err(node.bad_value(share, "a share above 0 and below 1, or false to hold nothing out"))
}

fn read_by(node: &Node<'_>) -> Result<SplitBy, Fault> {
    match node.string()? {
        "trajectory" => Ok(SplitBy::Trajectory),
        "time" => Ok(SplitBy::Time),
        other => Err(node.bad_value(format!("\"{}\"", shorten(other)), "\"trajectory\" or \"time\"")),
    }
}

/// Refuses truth of states that the model does not have.
pub(super) fn check_truth(document: &Fields<'_>, states: &[String]) -> Result<(), Fault> {
    let Some(data) = document.get("data") else { return Ok(()) };
    let Some(truth) = data.table("a table", &KEYS)?.get("truth").cloned() else { return Ok(()) };
    for (name, span, _) in &truth.table("a table", &[])?.entries {
        if !states.iter().any(|s| s == name) {
            let nearest = nearest(name, states.iter().map(String::as_str));
            let (key, name, known) = (truth.key, shorten(name), states.to_vec());
            return Err(Fault::new(*span, Cause::NoSuch { key, what: "the state", name, nearest, known }));
        }
    }
    Ok(())
}

/// Where input `i` is typed.
pub(super) fn input_span(document: &Fields<'_>, i: usize) -> Span {
    let inputs = || document.get("data")?.table("a table", &KEYS).ok()?.get("inputs")?.list("a list").ok();
    inputs().and_then(|list| list.get(i).map(|n| n.span)).unwrap_or_default()
}
