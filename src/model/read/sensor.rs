//! The `[[sensor]]` tables, as far as the log is concerned: who measures which columns, and in which rows.

use super::node::{Fields, Node};
use crate::data::SensorSpec;
use crate::model::error::{Cause, Fault};
use crate::words::shorten;

const KEYS: [&str; 8] = ["name", "measurements", "h", "at", "velocity", "R", "angle", "when"];
const COLUMNS: &str = "a list of column names";

/// A sensor, and what its measurements are called.
pub(super) struct Sensor {
    pub(super) spec: SensorSpec,
    pub(super) names: Vec<String>,
}

/// The tables, which messages call by their number; none where the file has no sensors.
pub(super) fn tables<'a>(document: &Fields<'a>) -> Result<Vec<Fields<'a>>, Fault> {
    let Some(node) = document.get("sensor") else { return Ok(Vec::new()) };
    let entries = node.list("[[sensor]] tables")?;
    if entries.is_empty() {
        return Err(node.wrong_count(0, "a [[sensor]] table for each sensor"));
    }
    let table = |(number, entry): (usize, &Node<'a>)| {
        let mut fields = entry.table("a table", &KEYS)?;
        fields.name = format!("[[sensor]] number {number}");
        Ok(fields)
    };
    (1..).zip(&entries).map(table).collect()
}

/// Reads names, columns and labels; `None` where the file has no sensors.
pub(super) fn list(document: &Fields<'_>, data: &Fields<'_>) -> Result<Option<Vec<Sensor>>, Fault> {
    let tables = tables(document)?;
    check_column(data, &tables)?;
    if tables.is_empty() {
        return Ok(None);
    }
    let mut specs: Vec<SensorSpec> = Vec::with_capacity(tables.len());
    for fields in &tables {
        let spec = read(fields)?;
        check_beside(fields, &spec, &specs)?;
        specs.push(spec);
    }
    let mut sensors: Vec<Sensor> = Vec::with_capacity(specs.len());
    for (spec, fields) in specs.iter().zip(&tables) {
        let names = measurement_names(spec, &specs);
        if let Some(taken) = names.iter().find(|name| sensors.iter().any(|other| other.names.contains(name))) {
            let at = fields.get("name").map_or(fields.span, |node| node.span);
            return Err(Fault::new(at, Cause::NameTaken { name: shorten(taken), taken: "a measurement" }));
        }
        sensors.push(Sensor { spec: spec.clone(), names });
    }
    Ok(Some(sensors))
}

/// The names of all measurements; where `[data]` lists them, it lists the same.
pub(super) fn names(sensors: &[Sensor], given: Option<&Node<'_>>) -> Result<Vec<String>, Fault> {
    let names: Vec<String> = sensors.iter().flat_map(|sensor| sensor.names.iter().cloned()).collect();
    match given {
        Some(node) if node.names(COLUMNS)? != names => {
            let list: Vec<String> = names.iter().map(|name| format!("\"{}\"", shorten(name))).collect();
            let list = list.join(", ");
            Err(node.invalid(format!("with [[sensor]] tables it must be [{list}] in this order, or be left out")))
        }
        _ => Ok(names),
    }
}

fn read(fields: &Fields<'_>) -> Result<SensorSpec, Fault> {
    Ok(SensorSpec {
        name: fields.need("name", "a name for messages and reports")?.name()?,
        columns: fields.need("measurements", COLUMNS)?.names(COLUMNS)?,
        when: fields.optional("when", Node::name)?,
    })
}

/// `[data] sensor` is there where some sensor has `when`, and only there.
fn check_column(data: &Fields<'_>, tables: &[Fields<'_>]) -> Result<(), Fault> {
    let labels = || tables.iter().filter_map(|fields| fields.get("when"));
    let Some(column) = data.get("sensor") else {
        return match (labels().next(), data.get("ignore_sensors")) {
            (Some(when), _) => {
                Err(when.invalid("a label needs the column that it stands in: give `sensor = \"COLUMN\"` in [data]"))
            }
            (None, Some(ignored)) => {
                Err(ignored.invalid("labels need the column that they stand in: give `sensor = \"COLUMN\"` in [data]"))
            }
            (None, None) => Ok(()),
        };
    };
    if labels().next().is_none() {
        return Err(column.invalid(
            "no [[sensor]] has `when`, the label that the rows of this sensor have in the column: give each one",
        ));
    }
    let Some(ignored) = data.get("ignore_sensors") else { return Ok(()) };
    for (entry, label) in ignored.list("a list of labels")?.iter().zip(ignored.names("a list of labels")?) {
        if labels().any(|when| when.value.as_str() == Some(&label)) {
            return Err(
                entry.invalid(format!("`{}` is `when` of a [[sensor]]: take it off one of them", shorten(&label)))
            );
        }
    }
    Ok(())
}

/// A sensor is another one than those before it, and shares columns with such alone that rows tell apart.
fn check_beside(fields: &Fields<'_>, spec: &SensorSpec, before: &[SensorSpec]) -> Result<(), Fault> {
    for other in before {
        if other.name == spec.name {
            let name = fields.need("name", "a name")?;
            return Err(name.fault(Cause::NameTaken { name: shorten(&spec.name), taken: "a sensor" }));
        }
        if let (Some(when), true) = (fields.get("when"), other.when.is_some() && other.when == spec.when) {
            return Err(when.invalid(format!("sensor `{}` has the same label: give another", shorten(&other.name))));
        }
        let shared = spec.columns.iter().position(|column| other.columns.contains(column));
        let Some(shared) = shared.filter(|_| spec.when.is_none() || other.when.is_none()) else { continue };
        let columns = fields.need("measurements", COLUMNS)?.list(COLUMNS)?;
        return Err(columns[shared].invalid(format!(
            "sensor `{}` measures this column too, so both need `when`, the label of their rows in the column that \
             [data] names as `sensor`",
            shorten(&other.name)
        )));
    }
    Ok(())
}

/// A column's own name, or `SENSOR_column` where sensors share it.
fn measurement_names(spec: &SensorSpec, all: &[SensorSpec]) -> Vec<String> {
    let shared = |column: &String| all.iter().filter(|other| other.columns.contains(column)).count() > 1;
    let name = |column: &String| if shared(column) { format!("{}_{column}", spec.name) } else { column.clone() };
    spec.columns.iter().map(name).collect()
}
