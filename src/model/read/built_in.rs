//! What `[model]` says of a built-in model: its axes and the keys of its own.

use super::node::{Fields, Node};
use crate::data::DataSpec;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::formula::{FormulaPlace, Names, Scope, parse};
use crate::model::library::{self, BuiltIn, Keys, Noise};
use crate::model::{Expr, Symbol};
use crate::words::shorten;

/// The model under `kind`.
pub(super) fn find(node: &Node<'_>) -> Result<&'static BuiltIn, Fault> {
    let name = node.string()?;
    library::ALL.iter().find(|b| b.name == name).ok_or_else(|| {
        let nearest = nearest(name, library::ALL.iter().map(|b| b.name));
        let known = library::ALL.iter().map(|b| b.name.to_owned()).collect();
        let (key, name) = (node.key.clone(), shorten(name));
        node.fault(Cause::NoSuch { key, what: "the built-in model", name, nearest, known })
    })
}

/// The axes, one per measurement and in their order; any where there is an h, or sensors that have one.
pub(super) fn axes(fields: &Fields<'_>, data: &DataSpec, model: &BuiltIn) -> Result<Vec<String>, Fault> {
    let m = data.measurements.len();
    let [least, most] = model.axes;
    let allowed = if least == most { least.to_string() } else { format!("{least} to {most}") };
    let own = fields.get("h").is_some();
    if own || !data.sensors.is_empty() {
        let teller = if own { "`h` does" } else { "[[sensor]] tables do" };
        fields.need("axes", &format!("the names of its axes, such as [\"x\", \"y\"], which {teller} not tell"))?;
    }
    let Some(node) = fields.get("axes") else {
        if (least..=most).contains(&m) {
            return Ok(data.measurements.clone());
        }
        return Err(fields.need("kind", "a built-in model")?.invalid(format!(
            "this built-in model has {allowed} axes, one per measurement, and there are {m}: give `axes`, and an `h` of what \
             is measured"
        )));
    };
    let axes = node.names("a list of axis names")?;
    if !(least..=most).contains(&axes.len()) {
        return Err(node.wrong_count(axes.len(), allowed));
    }
    if axes.len() == m || own || !data.sensors.is_empty() {
        return Ok(axes);
    }
    let measured = data.measurements.join(", ");
    Err(node.wrong_count(axes.len(), format!("{m}, one per measurement ({measured}), or an `h` of what is measured")))
}

/// The keys of a built-in model in `[model]`.
pub(super) struct Given<'a> {
    pub(super) fields: &'a Fields<'a>,
    pub(super) axes: &'a [String],
    pub(super) names: &'a Names,
}

impl<'a> Given<'a> {
    const fn scope(&self, place: FormulaPlace) -> Scope<'a> {
        Scope { names: self.names, place, key: "" }
    }

    fn need(&self, key: &'static str) -> Result<&Node<'a>, Fault> {
        self.fields.need(key, "a number or a formula: a setting of this built-in model")
    }
}

impl Keys for Given<'_> {
    fn axes(&self) -> usize {
        self.axes.len()
    }

    fn has(&self, key: &str) -> bool {
        self.fields.get(key).is_some()
    }

    fn noise(&self) -> Result<Noise, Fault> {
        match self.fields.optional("noise", |n| Ok((n.clone(), n.string()?)))? {
            None | Some((_, "continuous")) => Ok(Noise::Continuous),
            Some((_, "piecewise")) => Ok(Noise::Piecewise),
            Some((n, other)) => Err(n.bad_value(format!("\"{}\"", shorten(other)), "\"continuous\" or \"piecewise\"")),
        }
    }

    /// One for all axes, a list with one per axis, or a table by axis.
    fn strengths(&self, key: &'static str) -> Result<Vec<Expr>, Fault> {
        let node = self.fields.need(key, "the strength of its process noise: a number or a formula")?;
        let (axes, scope) = (self.axes, self.scope(FormulaPlace::Constant));
        if node.value.is_table() {
            let known: Vec<&str> = axes.iter().map(String::as_str).collect();
            let fields = node.table("a table by axis", &known)?;
            return axes.iter().map(|axis| fields.need(axis, "its strength")?.formula(scope)).collect();
        }
        if node.value.is_array() {
            let entries = node.list("a list")?;
            if entries.len() != axes.len() {
                let expected = format!("{}, one per axis ({})", axes.len(), axes.join(", "));
                return Err(node.wrong_count(entries.len(), expected));
            }
            return entries.iter().map(|e| e.formula(scope)).collect();
        }
        let strength = node.formula(scope)?;
        Ok(vec![strength; axes.len()])
    }

    fn strength(&self, key: &'static str) -> Result<Expr, Fault> {
        self.need(key)?.formula(self.scope(FormulaPlace::Constant))
    }

    fn known(&self, key: &'static str, what: &'static str) -> Result<Expr, Fault> {
        let scope = self.scope(FormulaPlace::Transition);
        let Some(node) = self.fields.get(key) else {
            let named = self.names.inputs.iter().chain(&self.names.parameters).any(|name| name == key)
                || self.names.lets.iter().any(|known| known.name == key);
            if named {
                return parse(key, scope);
            }
            let expected = format!("{what}, a formula of inputs and parameters, or call an input `{key}`");
            return Err(self.fields.need(key, &expected).err().unwrap_or_else(|| self.refuse(key, expected)));
        };
        let formula = node.formula(scope)?;
        if formula.mentions(|symbol| matches!(symbol, Symbol::State(_))) {
            return Err(node.invalid(format!("{what} is known, a formula of inputs, parameters and dt without states")));
        }
        Ok(formula)
    }

    fn refuse(&self, key: &'static str, problem: String) -> Fault {
        match self.fields.get(key) {
            Some(node) => node.invalid(problem),
            None => Fault::invalid(self.fields.span, key, problem),
        }
    }
}
