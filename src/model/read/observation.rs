//! What is measured: h, R and angles, of `[model]` or of the `[[sensor]]` tables.

use super::covariance::{self, Axes};
use super::named_sensor::{self, Places};
use super::node::{Fields, Node};
use super::parameters::Factor;
use super::sensor;
use crate::data::DataSpec;
use crate::model::error::Fault;
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::{Expr, Problem, Symbol};
use crate::words::shorten;

/// h, R and angles of all measurements.
pub(super) struct Observation {
    /// m formulas.
    pub(super) h: Vec<Expr>,
    /// m x m, block diagonal where there are sensors.
    pub(super) r: Vec<Expr>,
    /// Indices of measurements, ascending.
    pub(super) angles: Vec<usize>,
}

/// h and R stand in `[model]`, or in the `[[sensor]]` tables where there are some.
pub(super) fn refuse_in_model(document: &Fields<'_>, model: &Fields<'_>) -> Result<(), Fault> {
    let given =
        ["h", "at", "velocity", "R"].iter().find_map(|key| model.get(key)).filter(|_| document.get("sensor").is_some());
    given.map_or(Ok(()), |node| Err(node.invalid("every [[sensor]] has its own: move it there")))
}

/// Factors of the R of sensors.
pub(super) fn factors(document: &Fields<'_>, data: &DataSpec) -> Result<Vec<Factor>, Fault> {
    let mut factors = Vec::new();
    for (fields, sensor) in sensor::tables(document)?.iter().zip(&data.sensors) {
        factors.extend(fields.optional("R", |n| covariance::factor(n, "R", sensor.columns.len()))?.flatten());
    }
    Ok(factors)
}

/// Of `[model]`, whose h is that of a built-in model where it is given; `angles` are the names under `angle`.
pub(super) fn of_model(
    fields: &Fields<'_>,
    (built_in, angles): (Option<Vec<Expr>>, &[String]),
    (names, places): (&Names, &Places),
    data: &DataSpec,
) -> Result<Observation, Fault> {
    let labels = &data.measurements;
    let (h, own) = match built_in {
        Some(h) if fields.get("h").is_none() => {
            named_sensor::refuse_keys(fields)?;
            (h, Vec::new())
        }
        _ => formulas(fields, labels, (names, places))?,
    };
    let measurements = Axes { labels, what: "measurement", may_be_zero: false };
    let r = fields.need("R", "the measurement noise covariance")?;
    Ok(Observation {
        h,
        r: covariance::read(r, measurements, names, FormulaPlace::Constant)?,
        angles: (0..labels.len()).filter(|i| angles.contains(&labels[*i]) || own.contains(i)).collect(),
    })
}

/// Of the `[[sensor]]` tables, in their order.
pub(super) fn of_sensors(
    document: &Fields<'_>,
    (names, places): (&Names, &Places),
    data: &DataSpec,
) -> Result<Observation, Fault> {
    let m = data.measurements.len();
    let mut all = Observation { h: Vec::new(), r: vec![Expr::number(0.0); m * m], angles: Vec::new() };
    for (fields, sensor) in sensor::tables(document)?.iter().zip(&data.sensors) {
        let (labels, first) = (&sensor.columns, all.h.len());
        let (h, own) = formulas(fields, labels, (names, places))?;
        all.h.extend(h);
        let axes = Axes { labels, what: "measurement", may_be_zero: false };
        let r = fields.need("R", "the covariance of its noise")?;
        let block = covariance::read(r, axes, names, FormulaPlace::Constant)?;
        let count = labels.len();
        for (i, entry) in block.into_iter().enumerate() {
            all.r[(first + i / count) * m + first + i % count] = entry;
        }
        let angles = fields.optional("angle", |n| angles(n, labels))?.unwrap_or_default();
        all.angles.extend((0..labels.len()).filter(|i| angles.contains(i) || own.contains(i)).map(|i| first + i));
    }
    Ok(all)
}

/// The columns of a sensor that are angles, ascending.
fn angles(node: &Node<'_>, columns: &[String]) -> Result<Vec<usize>, Fault> {
    let named = node.names("a list of its measurements")?;
    for (name, entry) in named.iter().zip(node.list("a list")?) {
        if !columns.contains(name) {
            let known = columns.iter().map(|column| shorten(column)).collect::<Vec<_>>().join(", ");
            return Err(
                entry.bad_value(format!("\"{}\"", shorten(name)), format!("a measurement of the sensor ({known})"))
            );
        }
    }
    Ok((0..columns.len()).filter(|i| named.contains(&columns[*i])).collect())
}

/// One formula per measurement, and which of them are angles by what the sensor is.
fn formulas(
    fields: &Fields<'_>,
    labels: &[String],
    (names, places): (&Names, &Places),
) -> Result<(Vec<Expr>, Vec<usize>), Fault> {
    let node = fields.need("h", "a list of formulas, one per measurement, or the name of a sensor")?;
    if node.value.is_str() {
        return named_sensor::read(fields, node, labels, (names, places));
    }
    named_sensor::refuse_keys(fields)?;
    let scope = Scope { names, place: FormulaPlace::Measurement, key: "" };
    Ok((node.formulas(labels, "measurement", scope)?, Vec::new()))
}

/// How messages call the `m` formulas of h; none where h is that of a built-in model.
pub(super) fn keys_of_h(document: &Fields<'_>, model: &Fields<'_>, m: usize) -> Result<Vec<String>, Fault> {
    let sensors = sensor::tables(document)?;
    let mut keys = Vec::new();
    for (fields, node) in sensors.iter().chain([model]).filter_map(|fields| Some((fields, fields.get("h")?))) {
        if node.value.is_str() {
            let own = fields.optional("measurements", |n| Ok(n.list("a list of column names")?.len()))?.unwrap_or(m);
            keys.extend(std::iter::repeat_n(node.key.clone(), own));
        } else {
            keys.extend(node.list("a list of formulas")?.into_iter().map(|entry| entry.key));
        }
    }
    Ok(keys)
}

/// For each input the measurements whose h alone reads it; `None` where f or a condition on a mode does. Nothing where one row
/// measures all.
pub(super) fn readers(problem: &Problem) -> Vec<Option<Vec<usize>>> {
    if problem.data.sensors.is_empty() {
        return Vec::new();
    }
    let reads = |formula: &Expr, i: usize| formula.mentions(|symbol| symbol == Symbol::Input(i));
    let moving =
        || problem.models().flat_map(|model| &model.f).chain(problem.modes.iter().filter_map(|m| m.allowed.as_ref()));
    // All models have the h of the sensors.
    let h = &problem.model.h;
    let readers = |i: usize| {
        let idle = !moving().any(|f| reads(f, i));
        idle.then(|| (0..h.len()).filter(|m| reads(&h[*m], i)).collect())
    };
    (0..problem.model.inputs.len()).map(readers).collect()
}
