//! The `[model]` table: formulas, or a built-in model.

use std::path::Path;

use super::built_in::{self, Given};
use super::covariance::{self, Axes};
use super::data;
use super::lets;
use super::named_sensor::Places;
use super::names::{check_name, limit};
use super::node::{Fields, Node};
use super::observation::{self, Observation};
use super::parameters::Factor;
use crate::data::DataSpec;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::library::{self, BuiltIn, Motion};
use crate::model::{Angles, Expr, First, Model, Parameters, Start, Value};

/// A step over n dense states and measurements is 4 n^3 flops, 7 n^3 by factors: tracing 32 takes a second.
const MAX_STATES: usize = 32;
const COMMON: [&str; 10] = ["h", "at", "velocity", "R", "x0", "P0", "first", "first_dt", "angle", "let"];
const FORMULAS: [&str; 3] = ["state", "f", "Q"];
const BUILT_IN: [&str; 3] = ["kind", "axes", "noise"];

/// Whether a mode may have the key in the place of the model's.
pub(super) fn is_key(key: &str) -> bool {
    ["R", "at", "velocity"].contains(&key) || is_formula_key(key) || is_built_in_key(key)
}

/// Whether it is a key of models that are typed.
pub(super) fn is_formula_key(key: &str) -> bool {
    key == "h" || FORMULAS.contains(&key)
}

/// Whether it is a key of built-in models.
pub(super) fn is_built_in_key(key: &str) -> bool {
    BUILT_IN.contains(&key) || library::ALL.iter().any(|model| model.strengths.contains(&key))
}

/// The `[model]` table with its states known, before any formula is read.
pub(super) struct Draft<'a> {
    pub(super) fields: Fields<'a>,
    built_in: Option<(&'static BuiltIn, Vec<String>)>,
    states: Vec<String>,
    /// Factors of Q, R and P0.
    pub(super) factors: Vec<Factor>,
}

/// The table itself, before its keys are checked.
pub(super) fn table<'a>(document: &Fields<'a>) -> Result<Fields<'a>, Fault> {
    document.need("model", "a table with formulas or `kind`")?.table("a table", &[])
}

/// The keys that a model may have: those of the built-in model that it is, or of formulas.
pub(super) fn keys(fields: &Fields<'_>) -> Result<Vec<&'static str>, Fault> {
    let built_in = fields.optional("kind", built_in::find)?;
    let strengths = built_in.map_or(&[][..], |b| b.strengths);
    let own = if built_in.is_some() { &BUILT_IN[..] } else { &FORMULAS[..] };
    let mut known: Vec<&str> = own.iter().chain(strengths).chain(&COMMON).copied().collect();
    if built_in.is_none() {
        known.push("kind");
    }
    Ok(known)
}

/// Reads state names and factors; `common` are the states of a model that has none of its own.
pub(super) fn draft<'a>(
    document: &Fields<'a>,
    fields: Fields<'a>,
    data: &DataSpec,
    common: Option<&[String]>,
) -> Result<Draft<'a>, Fault> {
    observation::refuse_in_model(document, &fields)?;
    fields.check(&keys(&fields)?)?;
    let built_in = fields.optional("kind", built_in::find)?;
    let (states, built_in) = match (built_in, common) {
        (Some(model), _) => {
            let axes = built_in::axes(&fields, data, model)?;
            (model.states(&axes, |key| fields.get(key).is_some()), Some((model, axes)))
        }
        (None, Some(common)) if fields.get("state").is_none() => (common.to_vec(), None),
        (None, _) => (
            fields.need("state", "a list of state names, or `kind` of a built-in model")?.names("a list of names")?,
            None,
        ),
    };
    let at = fields
        .get("state")
        .or_else(|| fields.get("axes"))
        .or_else(|| fields.get("kind"))
        .map_or(fields.span, |n| n.span);
    limit(at, states.len(), "states", MAX_STATES)?;
    for (i, state) in states.iter().enumerate() {
        check_name(state, entry_span(&fields, i).unwrap_or(at))?;
        if states[..i].contains(state) {
            return Err(Fault::new(at, Cause::NameTaken { name: state.clone(), taken: "a state" }));
        }
    }
    let mut factors: Vec<Factor> = Vec::new();
    let mut found = Vec::new();
    for (key, size) in [("Q", states.len()), ("R", data.measurements.len()), ("P0", states.len())] {
        found.extend(fields.optional(key, |n| covariance::factor(n, key, size))?.flatten());
    }
    for factor in found.into_iter().chain(observation::factors(document, data)?) {
        add_factor(&mut factors, factor)?;
    }
    Ok(Draft { fields, built_in, states, factors })
}

/// A matrix has a factor of its own; one that several models have in common is one matrix.
pub(super) fn add_factor(factors: &mut Vec<Factor>, factor: Factor) -> Result<(), Fault> {
    if factors.contains(&factor) {
        return Ok(());
    }
    if factors.iter().any(|f| f.name == factor.name) {
        return Err(Fault::invalid(factor.span, &factor.name, "two matrices cannot share one factor"));
    }
    factors.push(factor);
    Ok(())
}

/// Where state `i` is typed, for formula models.
fn entry_span(fields: &Fields<'_>, i: usize) -> Option<crate::model::Span> {
    Some(fields.get("state")?.list("a list").ok()?.get(i)?.span)
}

impl Draft<'_> {
    /// State names.
    pub(super) fn states(&self) -> &[String] {
        &self.states
    }

    /// Every name that formulas may use, each with one meaning.
    pub(super) fn names(
        &self,
        document: &Fields<'_>,
        data: &DataSpec,
        parameters: &Parameters,
        folder: &Path,
    ) -> Result<Names, Fault> {
        let parameters: Vec<String> = parameters.all.iter().map(|p| p.name.clone()).collect();
        let declared = document.optional("parameters", |n| n.table("a table", &[]))?;
        let span = |name: &str| {
            let entries = declared.as_ref().map_or(&[][..], |d| &d.entries);
            entries.iter().find(|(key, ..)| *key == name).map_or(self.fields.span, |(_, span, _)| *span)
        };
        for name in &parameters {
            let taken = if self.states.contains(name) {
                "a state"
            } else if data.inputs.contains(name) {
                "an input"
            } else {
                continue;
            };
            return Err(Fault::new(span(name), Cause::NameTaken { name: name.clone(), taken }));
        }
        if let Some(i) = data.inputs.iter().position(|i| self.states.contains(i)) {
            let cause = Cause::NameTaken { name: data.inputs[i].clone(), taken: "a state" };
            return Err(Fault::new(data::input_span(document, i), cause));
        }
        let mut names = Names {
            states: self.states.clone(),
            parameters,
            inputs: data.inputs.clone(),
            folder: folder.to_owned(),
            ..Names::default()
        };
        self.fields.optional("let", |node| lets::read(node, &mut names))?;
        Ok(names)
    }

    /// Reads every formula.
    pub(super) fn finish(
        &self,
        document: &Fields<'_>,
        names: &Names,
        data: &DataSpec,
        parameters: &Parameters,
    ) -> Result<Model, Fault> {
        let fields = &self.fields;
        let Motion { f, h, q } = self.motion(names)?;
        let angles = self.read_angles(data)?;
        let states = Axes { labels: &self.states, what: "state", may_be_zero: false };
        let observation = self.observation(document, (h, &angles), names, data)?;
        let p0 = fields.need("P0", "the initial covariance")?;
        let x0 = self.read_x0(names)?;
        let model = Model {
            kind: self.kind(),
            states: self.states.clone(),
            measurements: data.measurements.clone(),
            inputs: data.inputs.clone(),
            r: observation.r,
            p0: covariance::read(p0, states, names, FormulaPlace::Constant)?,
            first: self.read_first(&x0, data)?,
            angles: Angles {
                states: (0..self.states.len()).filter(|i| angles.contains(&self.states[*i])).collect(),
                measurements: observation.angles,
            },
            f,
            h: observation.h,
            q,
            x0,
        };
        self.check_start(&model, parameters)?;
        Ok(model)
    }

    /// The built-in model that it is.
    pub(super) fn kind(&self) -> Option<&'static str> {
        self.built_in.as_ref().map(|(model, _)| model.name)
    }

    /// f, Q, and h where it is that of a built-in model.
    pub(super) fn motion(&self, names: &Names) -> Result<Motion, Fault> {
        match &self.built_in {
            Some((model, axes)) => (model.read)(&Given { fields: &self.fields, axes, names }),
            None => self.formulas(names),
        }
    }

    /// h, R and angles; `h` is that of a built-in model.
    pub(super) fn observation(
        &self,
        document: &Fields<'_>,
        (h, angles): (Vec<Expr>, &[String]),
        names: &Names,
        data: &DataSpec,
    ) -> Result<Observation, Fault> {
        let places = self.places(names);
        if data.sensors.is_empty() {
            let built_in = self.built_in.as_ref().map(|_| h);
            observation::of_model(&self.fields, (built_in, angles), (names, &places), data)
        } else {
            observation::of_sensors(document, (names, &places), data)
        }
    }

    /// What sensors see: the axes of a built-in model, or what is named as places are.
    fn places(&self, names: &Names) -> Places {
        match &self.built_in {
            Some((model, axes)) => {
                let moves = model.components.get(1) == Some(&"v");
                let velocities = axes.iter().filter(|_| moves).map(|axis| format!("v{axis}"));
                Places { positions: axes.clone(), velocities: velocities.collect() }
            }
            None => Places::named(names),
        }
    }

    fn formulas(&self, names: &Names) -> Result<Motion, Fault> {
        let f = self.fields.need("f", "a list of formulas, one per state")?;
        let q = self.fields.need("Q", "the process noise covariance of one step")?;
        let states = Axes { labels: &self.states, what: "state", may_be_zero: true };
        let scope = Scope { names, place: FormulaPlace::Transition, key: "" };
        Ok(Motion {
            f: f.formulas(&self.states, "state", scope)?,
            h: Vec::new(),
            q: covariance::read(q, states, names, FormulaPlace::ProcessNoise)?,
        })
    }

    fn read_x0(&self, names: &Names) -> Result<Start, Fault> {
        let node = self.fields.need("x0", "a list of numbers or formulas, or \"measurement\"")?;
        if node.value.as_str() == Some("measurement") {
            return Ok(Start::Measurement);
        }
        let expected = "a list of numbers or formulas, or \"measurement\"";
        let entries = node.list(expected)?;
        let n = self.states.len();
        if entries.len() != n {
            return Err(node.wrong_count(entries.len(), format!("{n}, one per state ({})", self.states.join(", "))));
        }
        let scope = Scope { names, place: FormulaPlace::Constant, key: "" };
        Ok(Start::Values(entries.iter().map(|e| e.formula(scope)).collect::<Result<_, _>>()?))
    }

    /// The names under `angle`, of states and measurements; one that both have means both.
    fn read_angles(&self, data: &DataSpec) -> Result<Vec<String>, Fault> {
        let leading = self.built_in.as_ref().and_then(|(model, _)| model.leading).filter(|leading| leading.angle);
        let own = leading.map(|leading| leading.name.to_owned());
        let Some(node) = self.fields.get("angle") else { return Ok(own.into_iter().collect()) };
        let mut names = node.names("a list of names of measurements and states")?;
        let measurements = if data.sensors.is_empty() { &data.measurements[..] } else { &[] };
        for (name, entry) in names.iter().zip(node.list("a list")?) {
            if self.states.contains(name) || measurements.contains(name) {
                continue;
            }
            if data.columns().contains(&name.as_str()) {
                return Err(entry.invalid(format!(
                    "`{}` is measured by a sensor: give it under `angle` of its [[sensor]]",
                    crate::words::shorten(name)
                )));
            }
            let known: Vec<String> = measurements.iter().chain(&self.states).cloned().collect();
            let nearest = nearest(name, known.iter().map(String::as_str));
            let (key, name) = (node.key.clone(), crate::words::shorten(name));
            return Err(entry.fault(Cause::NoSuch { key, what: "the angle", name, nearest, known }));
        }
        names.extend(own);
        Ok(names)
    }

    fn read_first(&self, x0: &Start, data: &DataSpec) -> Result<First, Fault> {
        let given = self.fields.get("first_dt");
        let first = self.fields.optional("first", |n| Ok((n.clone(), n.string()?)))?;
        match (&first, given) {
            (None | Some((_, "update")), None) => Ok(First::Update),
            (None | Some((_, "update")), Some(dt)) => {
                Err(dt.invalid("it belongs to first = \"predict\", the step before the first row: remove it"))
            }
            (Some((n, "predict")), _) if !data.inputs.is_empty() => Err(n.invalid(
                "\"predict\" needs the inputs of a step before the first row, which no log has: use \"update\"",
            )),
            (Some((n, "predict")), _) if *x0 == Start::Measurement => {
                Err(n.invalid("\"predict\" cannot go with x0 = \"measurement\", which holds at a row: use \"update\""))
            }
            (Some((_, "predict")), dt) => Ok(First::Predict { dt: dt.map(Node::positive).transpose()? }),
            (Some((n, other)), _) => Err(n.bad_value(format!("\"{other}\""), "\"update\" or \"predict\"")),
        }
    }

    /// x0 = "measurement" inverts h once for all candidates.
    fn check_start(&self, model: &Model, parameters: &Parameters) -> Result<(), Fault> {
        if model.x0 != Start::Measurement {
            return Ok(());
        }
        let searched = |symbol| match symbol {
            crate::model::Symbol::Parameter(i) => match parameters.all[i].value {
                Value::Searched(_) => true,
                Value::Tied(to) => matches!(parameters.all[to].value, Value::Searched(_)),
                Value::Fixed(_) => false,
            },
            _ => false,
        };
        match (model.h.iter().find(|h| h.mentions(searched)), self.fields.get("x0")) {
            (Some(_), Some(x0)) => {
                Err(x0.invalid("\"measurement\" needs an h without searched parameters: give numbers"))
            }
            _ => Ok(()),
        }
    }
}
