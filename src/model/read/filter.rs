//! The `[filter]` table.

use super::node::{Fields, Node};
use super::observation::keys_of_h;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::family::Settings;
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::{Adapts, Expr, FilterKind, Model, Parameters, Start, linear};
use crate::words::shorten;

/// Reads `[filter]`; the linear Kalman filter without one.
pub(super) fn read(
    document: &Fields<'_>,
    model: &Model,
    parameters: &Parameters,
    names: &Names,
) -> Result<FilterKind, Fault> {
    let Some(node) = document.get("filter") else { return checked(document, model, FilterKind::default()) };
    let kind = node.table("a table", &[])?.optional("kind", find)?.unwrap_or(FilterKind::NAMES[0]);
    let fields = node.table("a table", &[&["kind"], FilterKind::keys(kind)].concat())?;
    let filter = FilterKind::read(kind, &Keys { fields: &fields, names, states: model.states.len() })?;
    check_settings(&fields, &filter, parameters)?;
    check_noise(&fields, &filter, model)?;
    checked(document, model, filter)
}

/// A filter that fits f and h.
fn checked(document: &Fields<'_>, model: &Model, filter: FilterKind) -> Result<FilterKind, Fault> {
    let node = document.need("model", "a table")?;
    let fields = node.table("a table", &[])?;
    if filter.is_linear() {
        let of_f = fields.get("f").map_or(Ok(Vec::new()), |f| f.list("a list of formulas"))?;
        let keys: Vec<String> = of_f.into_iter().map(|entry| entry.key).collect();
        check_linear(node, keys, &model.f, &filter)?;
        check_linear(node, keys_of_h(document, &fields)?, &model.h, &filter)?;
    }
    match fields.get("x0") {
        Some(x0) if model.x0 == Start::Measurement && model.h.iter().any(|h| linear::check(h).is_err()) => {
            Err(x0.invalid("\"measurement\" inverts h, which has to be linear for that: give numbers or formulas"))
        }
        _ => Ok(filter),
    }
}

/// Formulas are affine in the states; without `keys` they are those of a built-in model.
fn check_linear(node: &Node<'_>, keys: Vec<String>, formulas: &[Expr], filter: &FilterKind) -> Result<(), Fault> {
    for (formula, key) in formulas.iter().zip(keys) {
        let Err(offender) = linear::check(formula) else { continue };
        let (text, filter) = (shorten(node.source(offender.span)), filter.name());
        let others = FilterKind::nonlinear().map(|name| format!("\"{name}\"")).collect();
        let cause = Cause::Nonlinear { text, key, filter, others };
        return Err(Fault::new(offender.span, cause));
    }
    Ok(())
}

/// What stands under the keys of the table.
struct Keys<'a> {
    fields: &'a Fields<'a>,
    names: &'a Names,
    states: usize,
}

impl Settings for Keys<'_> {
    fn states(&self) -> usize {
        self.states
    }

    fn formula(&self, key: &'static str, default: f64) -> Result<Expr, Fault> {
        let scope = Scope { names: self.names, place: FormulaPlace::Constant, key: "" };
        let found = self.fields.optional(key, |node| node.formula(scope))?;
        Ok(found.unwrap_or_else(|| Expr::number(default)))
    }

    fn count(&self, key: &'static str, default: usize, largest: u32) -> Result<usize, Fault> {
        Ok(self.fields.optional(key, |node| node.count(1, largest))?.unwrap_or(default))
    }
}

fn find(node: &Node<'_>) -> Result<&'static str, Fault> {
    let name = node.string()?;
    FilterKind::NAMES.iter().copied().find(|known| *known == name).ok_or_else(|| {
        let nearest = nearest(name, FilterKind::NAMES.iter().copied());
        let known = FilterKind::NAMES.iter().map(|known| (*known).to_owned()).collect();
        node.fault(Cause::NoSuch { key: node.key.clone(), what: "the filter", name: shorten(name), nearest, known })
    })
}

/// Settings are in their ranges at the start values.
fn check_settings(fields: &Fields<'_>, filter: &FilterKind, parameters: &Parameters) -> Result<(), Fault> {
    let values = parameters.resolve(&parameters.baseline());
    for setting in filter.settings() {
        let value = setting.value(&values);
        if setting.range.contains(value) {
            continue;
        }
        // A condition can be broken by the defaults of others as well.
        let node =
            fields.get(setting.key).or_else(|| setting.condition.and_then(|_| fields.entries.last().map(|e| &e.2)));
        let Some(node) = node else { continue };
        return Err(match setting.condition {
            None => node.bad_value(value, format!("{} at the start values", setting.range)),
            Some(what) => node.invalid(format!("{what} is {value} at the start values, and must be {}", setting.range)),
        });
    }
    Ok(())
}

/// What adapts R does so component by component.
fn check_noise(fields: &Fields<'_>, filter: &FilterKind, model: &Model) -> Result<(), Fault> {
    let m = model.measurements.len();
    let off_diagonal = || (0..m * m).filter(|i| i / m != i % m);
    let adapts_r = filter.facts().adapts == Adapts::MeasurementNoise;
    match fields.get("kind") {
        Some(kind) if adapts_r && off_diagonal().any(|i| !model.r[i].is_zero()) => Err(kind.invalid(format!(
            "\"{}\" adapts the variance of each measurement by itself and needs a diagonal R: give R as a list of variances",
            filter.name()
        ))),
        _ => Ok(()),
    }
}
