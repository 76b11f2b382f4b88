//! The `[filter]` table.

use super::node::{Fields, Node};
use super::observation::keys_of_h;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::family::Settings;
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::{Adapts, Expr, FilterKind, Model, Parameters, Robust, Setting, Start, linear};
use crate::words::shorten;

/// Reads `[filter]`, and how its updates withstand outliers; the linear Kalman filter without one.
pub(super) fn read(
    document: &Fields<'_>,
    model: &Model,
    parameters: &Parameters,
    names: &Names,
    modes: usize,
) -> Result<(FilterKind, Option<Robust>), Fault> {
    let Some(node) = document.get("filter") else {
        return Ok((checked(document, model, FilterKind::default())?, None));
    };
    let named = node.table("a table", &[])?;
    let kind = named.optional("kind", |node| find(node, "the filter", FilterKind::NAMES))?;
    let kind = kind.unwrap_or(FilterKind::NAMES[0]);
    let robust = named.optional("robust", |node| find(node, "the robust update", &Robust::NAMES))?;
    let own = robust.map_or_else(Vec::new, Robust::keys);
    let fields = node.table("a table", &[&["kind", "robust"], FilterKind::keys(kind), &own].concat())?;
    let (states, measurements) = (model.states.len(), model.measurements.len());
    let keys = Keys { fields: &fields, names, states, measurements, modes };
    let filter = FilterKind::read(kind, &keys)?;
    let robust = robust.map(|name| Robust::read(name, &keys)).transpose()?;
    check_settings(&fields, &filter.settings(), parameters)?;
    check_settings(&fields, &robust.as_ref().map_or_else(Vec::new, Robust::settings), parameters)?;
    check_noise(&fields, &filter, model)?;
    check_robust(&fields, &filter, modes)?;
    Ok((checked(document, model, filter)?, robust))
}

/// Robust updates are those of filters that adapt nothing.
fn check_robust(fields: &Fields<'_>, filter: &FilterKind, modes: usize) -> Result<(), Fault> {
    match fields.get("robust") {
        Some(robust) if modes > 0 => Err(robust.invalid(
            "with several models outliers are one more of them: add a mode with a large R in place of `robust`, or \
             remove `robust`",
        )),
        Some(robust) if filter.facts().adapts != Adapts::Nothing => Err(robust.invalid(format!(
            "the {} filter adapts its noise to what a robust update takes for outliers: set `kind` to a filter that adapts \
             nothing, or remove `robust`",
            filter.name()
        ))),
        _ => Ok(()),
    }
}

/// A filter that fits f and h.
fn checked(document: &Fields<'_>, model: &Model, filter: FilterKind) -> Result<FilterKind, Fault> {
    let node = document.need("model", "a table")?;
    let fields = node.table("a table", &[])?;
    if filter.is_linear() {
        if let Some(kind) = fields.get("kind") {
            let keys = vec![kind.key.clone(); model.f.len()];
            check_linear(node, keys, &within(kind, &model.f), &filter)?;
        } else if let Some(f) = fields.get("f") {
            let keys = f.list("a list of formulas")?.into_iter().map(|entry| entry.key).collect();
            check_linear(node, keys, &model.f, &filter)?;
        }
        check_linear(node, keys_of_h(document, &fields, model.h.len())?, &model.h, &filter)?;
    }
    match fields.get("x0") {
        Some(x0) if model.x0 == Start::Measurement && model.h.iter().any(|h| linear::check(h).is_err()) => {
            Err(x0.invalid("\"measurement\" inverts h, which has to be linear for that: give numbers or formulas"))
        }
        _ => Ok(filter),
    }
}

/// Formulas that no key has, as if they stood at this one.
fn within(node: &Node<'_>, formulas: &[Expr]) -> Vec<Expr> {
    let mut all = formulas.to_vec();
    all.iter_mut().for_each(|formula| formula.map_spans(&|_| node.span));
    all
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
pub(super) struct Keys<'a> {
    pub(super) fields: &'a Fields<'a>,
    pub(super) names: &'a Names,
    pub(super) states: usize,
    pub(super) measurements: usize,
    /// Number of models of the filter; 0 for one that has no modes.
    pub(super) modes: usize,
}

impl Keys<'_> {
    const fn scope(&self) -> Scope<'_> {
        Scope { names: self.names, place: FormulaPlace::Constant, key: "" }
    }
}

impl Settings for Keys<'_> {
    fn states(&self) -> usize {
        self.states
    }

    fn formula(&self, key: &'static str, default: f64) -> Result<Expr, Fault> {
        let found = self.fields.optional(key, |node| node.formula(self.scope()))?;
        Ok(found.unwrap_or_else(|| Expr::number(default)))
    }

    fn formula_of_each(&self, key: &'static str) -> Result<Option<Vec<Expr>>, Fault> {
        let Some(node) = self.fields.get(key) else { return Ok(None) };
        let one = node.value.is_str() || node.value.as_float().is_some() || node.value.as_integer().is_some();
        if one && self.measurements == 1 {
            return Ok(Some(vec![node.formula(self.scope())?]));
        }
        let entries = node.list("a list with one number or formula a measurement")?;
        if entries.len() != self.measurements {
            return Err(node.wrong_count(entries.len(), format!("{}, one a measurement", self.measurements)));
        }
        entries.iter().map(|entry| entry.formula(self.scope())).collect::<Result<_, _>>().map(Some)
    }

    fn count(&self, key: &'static str, default: usize, least: u32, largest: u32) -> Result<usize, Fault> {
        Ok(self.fields.optional(key, |node| node.count(least, largest))?.unwrap_or(default))
    }

    fn modes(&self) -> usize {
        self.modes
    }

    fn rows(&self, key: &'static str) -> Result<Option<Vec<Vec<Expr>>>, Fault> {
        let scope = Scope { names: self.names, place: FormulaPlace::Constant, key: "" };
        let row = |node: &Node<'_>| match node.value.is_array() {
            true => node.list("a list of numbers or formulas")?.iter().map(|entry| entry.formula(scope)).collect(),
            false => Ok(vec![node.formula(scope)?]),
        };
        let rows = |node: &Node<'_>| {
            let lists = node.value.as_array().is_some_and(|rows| rows.iter().any(|row| row.get_ref().is_array()));
            if lists { node.list("a list of rows")?.iter().map(row).collect() } else { Ok(vec![row(node)?]) }
        };
        self.fields.optional(key, rows)
    }

    fn refuse(&self, key: &'static str, problem: String) -> Fault {
        match self.fields.get(key) {
            Some(node) => node.invalid(problem),
            None => Fault::invalid(self.fields.span, "filter", problem),
        }
    }
}

/// One of some names.
fn find(node: &Node<'_>, what: &'static str, names: &[&'static str]) -> Result<&'static str, Fault> {
    let name = node.string()?;
    names.iter().copied().find(|known| *known == name).ok_or_else(|| {
        let nearest = nearest(name, names.iter().copied());
        let known = names.iter().map(|known| (*known).to_owned()).collect();
        node.fault(Cause::NoSuch { key: node.key.clone(), what, name: shorten(name), nearest, known })
    })
}

/// Settings are in their ranges at the start values.
pub(super) fn check_settings(
    fields: &Fields<'_>,
    settings: &[Setting<'_>],
    parameters: &Parameters,
) -> Result<(), Fault> {
    let values = parameters.resolve(&parameters.baseline());
    for setting in settings {
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
