//! What is measured: h, R and angles, of `[model]` or of the `[[sensor]]` tables.

use super::covariance::{self, Axes};
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
    let given = ["h", "R"].iter().find_map(|key| model.get(key)).filter(|_| document.get("sensor").is_some());
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
    names: &Names,
    data: &DataSpec,
) -> Result<Observation, Fault> {
    let labels = &data.measurements;
    let h = match built_in {
        Some(h) => h,
        None => formulas(fields.need("h", "a list of formulas, one per measurement")?, labels, names)?,
    };
    let measurements = Axes { labels, what: "measurement", may_be_zero: false };
    let r = fields.need("R", "the measurement noise covariance")?;
    Ok(Observation {
        h,
        r: covariance::read(r, measurements, names, FormulaPlace::Constant)?,
        angles: (0..labels.len()).filter(|i| angles.contains(&labels[*i])).collect(),
    })
}

/// Of the `[[sensor]]` tables, in their order.
pub(super) fn of_sensors(document: &Fields<'_>, names: &Names, data: &DataSpec) -> Result<Observation, Fault> {
    let m = data.measurements.len();
    let mut all = Observation { h: Vec::new(), r: vec![Expr::number(0.0); m * m], angles: Vec::new() };
    for (fields, sensor) in sensor::tables(document)?.iter().zip(&data.sensors) {
        let (labels, first) = (&sensor.columns, all.h.len());
        all.h.extend(formulas(fields.need("h", "a list of formulas, one per measurement")?, labels, names)?);
        let axes = Axes { labels, what: "measurement", may_be_zero: false };
        let r = fields.need("R", "the covariance of its noise")?;
        let block = covariance::read(r, axes, names, FormulaPlace::Constant)?;
        let own = labels.len();
        for (i, entry) in block.into_iter().enumerate() {
            all.r[(first + i / own) * m + first + i % own] = entry;
        }
        let angles = fields.optional("angle", |n| angles(n, labels))?.unwrap_or_default();
        all.angles.extend(angles.into_iter().map(|i| first + i));
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

/// One formula per measurement.
fn formulas(node: &Node<'_>, labels: &[String], names: &Names) -> Result<Vec<Expr>, Fault> {
    node.formulas(labels, "measurement", Scope { names, place: FormulaPlace::Measurement, key: "" })
}

/// How messages call the formulas of h; none where h is that of a built-in model.
pub(super) fn keys_of_h(document: &Fields<'_>, model: &Fields<'_>) -> Result<Vec<String>, Fault> {
    let sensors = sensor::tables(document)?;
    let lists = sensors.iter().chain([model]).filter_map(|fields| fields.get("h"));
    let mut keys = Vec::new();
    for list in lists {
        keys.extend(list.list("a list of formulas")?.into_iter().map(|entry| entry.key));
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
