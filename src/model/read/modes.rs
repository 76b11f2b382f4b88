//! The tables `[[mode]]`: the models that an interacting multiple model filter switches between, as `[model]` with some keys
//! of their own.

use std::path::Path;

use super::filter::{Keys, check_settings};
use super::model::{self, Draft, is_built_in_key, is_formula_key, is_key};
use super::names::limit;
use super::node::{Fields, Node};
use super::observation::Observation;
use crate::data::DataSpec;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::family::{Described, Imm};
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::{Expr, FilterKind, Mode, Model, Parameters, Problem, Start, Symbol, linear};
use crate::objective::Kind;
use crate::words::shorten;

/// Keys of a mode that `[model]` does not have.
const KEYS: [&str; 4] = ["name", "filter", "map", "allowed"];
/// Filters that a mode may have: a memory of what has been adapted cannot be mixed.
const FILTERS: [&str; 5] = ["kalman", "extended", "iterated", "unscented", "cubature"];
/// Every mode is a filter more in each step.
const MAX_MODES: usize = 16;

/// A mode before any formula is read.
pub(super) struct ModeDraft<'a> {
    name: String,
    fields: Fields<'a>,
    pub(super) draft: Draft<'a>,
    /// For each of its states the one of the model that it is.
    map: Vec<usize>,
}

/// The tables in file order; none where the filter has one model.
pub(super) fn tables<'a>(document: &Fields<'a>) -> Result<Vec<Fields<'a>>, Fault> {
    let filter = document.optional("filter", |node| node.table("a table", &[]))?;
    let kind = filter.as_ref().and_then(|filter| filter.get("kind"));
    let imm = kind.filter(|kind| kind.value.as_str() == Some(Imm::NAME));
    let (node, kind) = match (document.get("mode"), imm) {
        (None, None) => return Ok(vec![]),
        (Some(node), None) => {
            let problem = "modes are what a filter of kind \"imm\" switches between: set kind = \"imm\" in [filter], or \
                           remove them";
            return Err(node.invalid(problem));
        }
        (None, Some(kind)) => return Err(kind.invalid("\"imm\" needs two tables [[mode]] or more, one per model")),
        (Some(node), Some(kind)) => (node, kind),
    };
    let nodes = node.list("tables [[mode]]")?;
    limit(node.span, nodes.len(), "modes", MAX_MODES)?;
    if nodes.len() < 2 {
        return Err(kind.invalid("\"imm\" needs two tables [[mode]] or more, one per model"));
    }
    nodes.iter().map(|node| node.table("a table", &[])).collect()
}

/// `[model]`, with what it lacks taken from the first mode whose model has its states.
pub(super) fn common<'a>(document: &Fields<'a>, modes: &[Fields<'a>]) -> Result<Fields<'a>, Fault> {
    let mut model = model::table(document)?;
    let own_states = model.get("state").is_some() || model.get("kind").is_some();
    let fits = |mode: &&Fields<'a>| {
        let differs = ["state", "map", "kind"].iter().any(|key| mode.get(key).is_some());
        let typed = mode.get("f").is_some() && model.get("kind").is_some();
        !own_states || !(differs || typed)
    };
    if let Some(mode) = modes.iter().find(fits) {
        let missing = mode.entries.iter().filter(|(key, ..)| is_key(key) && model.get(key).is_none());
        let missing: Vec<_> = missing.cloned().collect();
        model.entries.extend(missing);
    }
    Ok(model)
}

/// `[model]` with the keys of a mode in the place of its own.
fn merged<'a>(model: &Fields<'a>, mode: &Fields<'a>) -> Fields<'a> {
    let kept = |key: &str| {
        // Another built-in model has no formulas, and formulas are no built-in model.
        let other = if mode.get("kind").is_some() {
            // So do formulas of other states.
            let named = key == "h" && model.get(key).is_some_and(|h| h.value.is_str());
            (is_formula_key(key) && !named) || key == "let"
        } else {
            (mode.get("f").is_some() && is_built_in_key(key)) || (mode.get("state").is_some() && key == "let")
        };
        mode.get(key).is_none() && !other
    };
    let entries = model.entries.iter().filter(|(key, ..)| kept(key));
    let own = mode.entries.iter().filter(|(key, ..)| is_key(key));
    Fields { entries: entries.chain(own).cloned().collect(), span: mode.span, name: mode.name.clone() }
}

/// What the modes are, before any formula is read.
pub(super) fn drafts<'a>(
    document: &Fields<'a>,
    model: &Draft<'a>,
    tables: Vec<Fields<'a>>,
    data: &DataSpec,
) -> Result<Vec<ModeDraft<'a>>, Fault> {
    let mut drafts: Vec<ModeDraft<'a>> = Vec::with_capacity(tables.len());
    for fields in tables {
        let node = fields.need("name", "a name for the mode")?;
        let name = node.name()?;
        if drafts.iter().any(|draft| draft.name == name) {
            return Err(node.fault(Cause::NameTaken { name: shorten(&name), taken: "another mode's" }));
        }
        let mut whole = merged(&model.fields, &fields);
        let keys = model::keys(&whole)?;
        let filter = fields.optional("filter", find)?;
        let own = keys.iter().copied().filter(|key| is_key(key));
        let settings = filter.map_or(&[][..], FilterKind::keys);
        fields.check(&KEYS.into_iter().chain(own).chain(settings.iter().copied()).collect::<Vec<_>>())?;
        // What another built-in model was driven by drives this one only where it knows it; what is left is the filter's.
        whole.entries.retain(|(key, ..)| keys.contains(key));
        let draft = model::draft(document, whole, data, Some(model.states()))?;
        let map = read_map(&fields, draft.states(), model.states())?;
        drafts.push(ModeDraft { name, fields, draft, map });
    }
    Ok(drafts)
}

/// Which states of the model those of a mode are: by their own names, or by those under `map`.
fn read_map(fields: &Fields<'_>, own: &[String], common: &[String]) -> Result<Vec<usize>, Fault> {
    let names = fields.optional("map", |node| node.names("a list of states of [model]"))?;
    let places: Vec<&Node<'_>> = ["map", "state", "kind", "name"].iter().filter_map(|key| fields.get(key)).collect();
    let Some(node) = places.first() else { return Ok((0..own.len()).collect()) };
    let names = names.as_deref().unwrap_or(own);
    if names.len() != own.len() {
        let expected = format!("{}, one per state of the mode ({})", own.len(), own.join(", "));
        return Err(node.wrong_count(names.len(), expected));
    }
    let find = |name: &String| {
        common.iter().position(|state| state == name).ok_or_else(|| {
            let nearest = nearest(name, common.iter().map(String::as_str));
            let (key, name, known) = (node.key.clone(), shorten(name), common.to_vec());
            node.fault(Cause::NoSuch { key, what: "the state of [model]", name, nearest, known })
        })
    };
    names.iter().map(find).collect()
}

fn find(node: &Node<'_>) -> Result<&'static str, Fault> {
    let name = node.string()?;
    FILTERS.iter().copied().find(|known| *known == name).ok_or_else(|| {
        if FilterKind::NAMES.contains(&name) {
            return node.bad_value(format!("\"{name}\""), format!("one of {}", FILTERS.join(", ")));
        }
        let nearest = nearest(name, FILTERS);
        let known = FILTERS.map(str::to_owned).to_vec();
        node.fault(Cause::NoSuch { key: node.key.clone(), what: "the filter", name: shorten(name), nearest, known })
    })
}

/// Reads every formula of the modes.
pub(super) fn read(
    drafts: &[ModeDraft<'_>],
    document: &Fields<'_>,
    (common, data): (&Model, &DataSpec),
    (parameters, folder): (&Parameters, &Path),
) -> Result<Vec<Mode>, Fault> {
    let read = |draft: &ModeDraft<'_>| {
        let names = draft.draft.names(document, data, parameters, folder)?;
        draft.finish(document, (common, data), &names, parameters)
    };
    drafts.iter().map(read).collect()
}

/// What has no meaning with several models.
pub(super) fn check_objectives(document: &Fields<'_>, problem: &Problem) -> Result<(), Fault> {
    let far = problem.tune.scorers().iter().any(|objective| objective.kind == Kind::Prediction);
    match document.get("tune") {
        Some(tune) if far && !problem.modes.is_empty() => Err(Fault::invalid(
            tune.span,
            "tune",
            "`prediction` goes through one f, and the imm filter has several: take another objective, such as `mse_innovation`",
        )),
        _ => Ok(()),
    }
}

impl ModeDraft<'_> {
    fn finish(
        &self,
        document: &Fields<'_>,
        (common, data): (&Model, &DataSpec),
        names: &Names,
        parameters: &Parameters,
    ) -> Result<Mode, Fault> {
        let model = self.model(document, (common, data), names)?;
        if model.x0 == Start::Measurement && !model.h.iter().zip(&common.h).all(|(own, h)| own.same(h)) {
            let span = self.fields.get("h").map_or(self.fields.span, |h| h.span);
            let problem = "x0 = \"measurement\" inverts one h, that of [model]: give x0 as numbers, or the modes no h";
            return Err(Fault::invalid(span, &self.name, problem));
        }
        let filter = self.filter(&model, names, parameters)?;
        let scope = Scope { names, place: FormulaPlace::Condition, key: "" };
        let allowed = self.fields.optional("allowed", |node| node.formula(scope))?;
        Ok(Mode { name: self.name.clone(), model, filter, allowed })
    }

    /// The model over all states of the common one: those that the mode lacks stay where they are, without noise.
    fn model(&self, document: &Fields<'_>, (common, data): (&Model, &DataSpec), names: &Names) -> Result<Model, Fault> {
        let motion = self.draft.motion(names)?;
        let n = common.states.len();
        let moved = |mut formula: Expr| {
            formula.map_symbols(&|symbol| match symbol {
                Symbol::State(i) => Symbol::State(self.map[i]),
                other => other,
            });
            formula
        };
        let mut f: Vec<Expr> = (0..n).map(|i| Expr::symbol(Symbol::State(i))).collect();
        let mut q = vec![Expr::number(0.0); n * n];
        for (i, formula) in motion.f.into_iter().enumerate() {
            f[self.map[i]] = moved(formula);
        }
        let own = self.map.len();
        for (k, entry) in motion.q.into_iter().enumerate() {
            q[self.map[k / own] * n + self.map[k % own]] = entry;
        }
        if !data.sensors.is_empty() {
            return Ok(Model { kind: self.draft.kind(), f, q, ..common.clone() });
        }
        let Observation { h, r, .. } = self.draft.observation(document, (motion.h, &[]), names, data)?;
        let h = h.into_iter().map(moved).collect();
        Ok(Model { kind: self.draft.kind(), f, h, q, r, ..common.clone() })
    }

    /// The filter that the mode asks for; else the linear one where f and h are, and the extended one where they are not.
    fn filter(&self, model: &Model, names: &Names, parameters: &Parameters) -> Result<FilterKind, Fault> {
        let curved = model.f.iter().chain(&model.h).find_map(|formula| linear::check(formula).err());
        let kind = match (self.fields.optional("filter", find)?, curved) {
            (Some("kalman"), Some(offender)) => {
                let problem = "the kalman filter needs f and h to be linear in the states: leave `filter` out, or set it to \
                               extended, iterated, unscented or cubature";
                return Err(Fault::invalid(offender.span, &self.name, problem));
            }
            (Some(kind), _) => kind,
            (None, None) => "kalman",
            (None, Some(_)) => "extended",
        };
        let (states, measurements) = (model.states.len(), model.measurements.len());
        let keys = Keys { fields: &self.fields, names, states, measurements, modes: 0 };
        let filter = FilterKind::read(kind, &keys)?;
        check_settings(&self.fields, &filter.settings(), parameters)?;
        Ok(filter)
    }
}
