//! `h = "range-bearing"`: a built-in sensor in the place of formulas, and where it stands.

use super::node::{Fields, Node};
use crate::model::error::{Fault, nearest};
use crate::model::formula::{FormulaPlace, Names, Scope, parse};
use crate::model::library::{SENSORS, Sensor, offset};
use crate::model::{Expr, Span};
use crate::words::shorten;

/// The names of positions and velocities, one per axis; fewer velocities where the model has none.
pub(super) struct Places {
    pub(super) positions: Vec<String>,
    pub(super) velocities: Vec<String>,
}

impl Places {
    /// Those of typed models: x, y, z and vx, vy, vz, as far as states or `[model.let]` have them.
    pub(super) fn named(names: &Names) -> Self {
        let known = |name: &String| names.states.contains(name) || names.lets.iter().any(|own| own.name == *name);
        let of = |prefix: &str| {
            let all = ["x", "y", "z"].map(|axis| format!("{prefix}{axis}"));
            all.into_iter().take_while(known).collect()
        };
        Self { positions: of(""), velocities: of("v") }
    }
}

/// Refuses the keys of built-in sensors where h is something else.
pub(super) fn refuse_keys(fields: &Fields<'_>) -> Result<(), Fault> {
    let given = ["at", "velocity"].iter().find_map(|key| fields.get(key));
    let list = || SENSORS.iter().map(|sensor| format!("\"{}\"", sensor.name)).collect::<Vec<_>>().join(", ");
    given.map_or(Ok(()), |node| {
        Err(node.invalid(format!("it belongs to an `h` that names a sensor ({}): remove it", list())))
    })
}

/// The formulas of the sensor that h names, one per measurement, and which of them are angles.
pub(super) fn read(
    fields: &Fields<'_>,
    node: &Node<'_>,
    labels: &[String],
    (names, places): (&Names, &Places),
) -> Result<(Vec<Expr>, Vec<usize>), Fault> {
    let sensor = find(node)?;
    check(node, sensor, places)?;
    let count = if sensor.has_beacons() { labels.len() } else { sensor.measures };
    if count != labels.len() {
        let problem = format!(
            "a sensor \"{}\" measures {count} {}, and there are {} ({})",
            sensor.name,
            if count == 1 { "number" } else { "numbers" },
            labels.len(),
            labels.join(", ")
        );
        return Err(node.invalid(problem));
    }
    let scope = Scope { names, place: FormulaPlace::Measurement, key: &node.key };
    let own: Vec<Option<Vec<Expr>>> = if sensor.has_beacons() {
        beacons(fields, labels, places, scope)?.into_iter().map(Some).collect()
    } else {
        vec![fields.optional("at", |n| vector(n, &places.positions, scope))?]
    };
    let rates = match fields.get("velocity") {
        Some(n) if !sensor.rates => {
            return Err(n.invalid(format!("a sensor \"{}\" measures no velocity: remove it", sensor.name)));
        }
        given => given.map(|n| vector(n, &places.positions, scope)).transpose()?,
    };
    let rates = if sensor.rates { relative(node, &places.velocities, rates, scope)? } else { Vec::new() };
    let mut h = Vec::with_capacity(count);
    for at in own {
        h.extend((sensor.h)(&relative(node, &places.positions, at, scope)?, &rates));
    }
    let placed = |span: Span| if span == Span::default() { node.span } else { span };
    h.iter_mut().for_each(|formula| formula.map_spans(&placed));
    Ok((h, sensor.angles.to_vec()))
}

fn find(node: &Node<'_>) -> Result<&'static Sensor, Fault> {
    let name = node.string()?;
    SENSORS.iter().find(|sensor| sensor.name == name).ok_or_else(|| {
        let known = SENSORS.iter().map(|sensor| format!("\"{}\"", sensor.name)).collect::<Vec<_>>().join(", ");
        let meant = nearest(name, SENSORS.iter().map(|sensor| sensor.name));
        let meant = meant.map_or_else(String::new, |meant| format!("; did you mean \"{meant}\"?"));
        let expected = format!("a list of formulas, or the name of a sensor ({known}){meant}");
        node.bad_value(format!("\"{}\"", shorten(name)), expected)
    })
}

/// Whether the model has what the sensor sees.
fn check(node: &Node<'_>, sensor: &Sensor, places: &Places) -> Result<(), Fault> {
    let needed = |prefix: &str| {
        let all = ["x", "y", "z"].map(|axis| format!("`{prefix}{axis}`"));
        all[..sensor.axes].join(", ")
    };
    let lacks = |what: &str, prefix: &str| {
        node.invalid(format!(
            "a sensor \"{}\" needs {what} in {} axes or more: call states or names of [model.let] {}, take a built-in model \
             that has them, or type formulas",
            sensor.name,
            sensor.axes,
            needed(prefix)
        ))
    };
    if places.positions.len() < sensor.axes {
        return Err(lacks("positions", ""));
    }
    if sensor.rates && places.velocities.len() < places.positions.len() {
        return Err(lacks("velocities", "v"));
    }
    Ok(())
}

/// One formula per axis.
fn vector(node: &Node<'_>, axes: &[String], scope: Scope<'_>) -> Result<Vec<Expr>, Fault> {
    node.formulas(axes, "axis", scope)
}

/// A position per measurement.
fn beacons(fields: &Fields<'_>, labels: &[String], places: &Places, scope: Scope<'_>) -> Result<Vec<Vec<Expr>>, Fault> {
    let node = fields.need("at", "the positions of its beacons, one per measurement, such as [[0, 0], [10, 0]]")?;
    let entries = node.list("a list of positions, one per measurement")?;
    if entries.len() != labels.len() {
        let expected = format!("{} positions, one per measurement ({})", labels.len(), labels.join(", "));
        return Err(node.wrong_count(entries.len(), expected));
    }
    entries.iter().map(|entry| vector(entry, &places.positions, scope)).collect()
}

/// What is named, less the sensor's own; messages about it point at h.
fn relative(node: &Node<'_>, named: &[String], own: Option<Vec<Expr>>, scope: Scope<'_>) -> Result<Vec<Expr>, Fault> {
    let mut own = own.map(Vec::into_iter);
    let of = |name: &String| {
        let mut state = parse(name, scope)?;
        state.map_spans(&|_| node.span);
        Ok(state)
    };
    let less = |state: Expr| offset(state, own.as_mut().and_then(Iterator::next));
    named.iter().map(of).collect::<Result<Vec<_>, Fault>>().map(|states| states.into_iter().map(less).collect())
}
