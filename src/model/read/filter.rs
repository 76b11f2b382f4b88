//! The `[filter]` table.

use super::node::{Fields, Node};
use crate::model::error::{Cause, Fault, nearest};
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::{Expr, FilterKind, Model, Parameters};
use crate::words::shorten;

/// The buffer of the fuzzy kind is carried from row to row, one value a row of it and component.
const MAX_WINDOW: u32 = 128;

/// Reads `[filter]`; the linear Kalman filter without one.
pub(super) fn read(
    document: &Fields<'_>,
    model: &Model,
    parameters: &Parameters,
    names: &Names,
) -> Result<FilterKind, Fault> {
    let Some(node) = document.get("filter") else { return Ok(FilterKind::Kalman) };
    let kind = node.table("a table", &[])?.optional("kind", find)?.unwrap_or(FilterKind::NAMES[0]);
    let fields = |own: &[&str]| node.table("a table", &[&["kind"], own].concat());
    let number = |fields: &Fields<'_>, key: &str, default: f64| {
        let scope = Scope { names, place: FormulaPlace::Constant, key: "" };
        fields.optional(key, |n| n.formula(scope)).map(|found| found.unwrap_or_else(|| Expr::number(default)))
    };
    let (fields, filter) = match kind {
        "sage-husa" => {
            let fields = fields(&["forgetting"])?;
            let forgetting = number(&fields, "forgetting", 0.98)?;
            (fields, FilterKind::SageHusa { forgetting })
        }
        "sage-husa-r" => {
            let fields = fields(&["forgetting", "floor"])?;
            let (forgetting, floor) = (number(&fields, "forgetting", 0.98)?, number(&fields, "floor", 0.01)?);
            (fields, FilterKind::SageHusaR { forgetting, floor })
        }
        "fuzzy" => {
            let fields = fields(&["window", "gain", "width"])?;
            let window = fields.optional("window", |n| n.count(1, MAX_WINDOW))?.unwrap_or(15);
            let (gain, width) = (number(&fields, "gain", 0.1)?, number(&fields, "width", 0.5)?);
            (fields, FilterKind::Fuzzy { window, gain, width })
        }
        _ => (fields(&[])?, FilterKind::Kalman),
    };
    check_settings(&fields, &filter, parameters)?;
    check_noise(&fields, &filter, model)?;
    Ok(filter)
}

fn find(node: &Node<'_>) -> Result<&'static str, Fault> {
    let name = node.string()?;
    FilterKind::NAMES.into_iter().find(|known| *known == name).ok_or_else(|| {
        let nearest = nearest(name, FilterKind::NAMES);
        let known = FilterKind::NAMES.map(str::to_owned).to_vec();
        node.fault(Cause::NoSuch { key: node.key.clone(), what: "the filter", name: shorten(name), nearest, known })
    })
}

/// Settings are in their ranges at the start values.
fn check_settings(fields: &Fields<'_>, filter: &FilterKind, parameters: &Parameters) -> Result<(), Fault> {
    let values = parameters.resolve(&parameters.baseline());
    for setting in filter.settings() {
        let value = setting.value(&values);
        if let (false, Some(node)) = (setting.range.contains(value), fields.get(setting.key)) {
            return Err(node.bad_value(value, format!("{} at the start values", setting.range)));
        }
    }
    Ok(())
}

/// What adapts R does so component by component.
fn check_noise(fields: &Fields<'_>, filter: &FilterKind, model: &Model) -> Result<(), Fault> {
    let m = model.measurements.len();
    let off_diagonal = || (0..m * m).filter(|i| i / m != i % m);
    let adapts_r = matches!(filter, FilterKind::SageHusaR { .. } | FilterKind::Fuzzy { .. });
    match fields.get("kind") {
        Some(kind) if adapts_r && off_diagonal().any(|i| !model.r[i].is_zero()) => Err(kind.invalid(format!(
            "\"{}\" adapts the variance of each measurement by itself and needs a diagonal R: give R as a list of variances",
            filter.name()
        ))),
        _ => Ok(()),
    }
}
