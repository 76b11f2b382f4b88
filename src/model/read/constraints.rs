//! `[tune] constraints`: `"nis_mean <= 1.2"`, or `{ name = "rmse", states = ["d"], max = 5 }`.

use super::node::Node;
use super::objectives;
use crate::model::DataSpec;
use crate::model::error::{Cause, Fault};
use crate::objective::{Constraint, Kind, Objective, Relation};
use crate::words::shorten;

const EXPECTED: &str =
    "a name, <= or >=, and a number, such as \"nis_mean <= 1.2\", or a table with `name` and `max` or `min`";
const WHAT: &str = "the constraint on";

/// Reads the list; a table with both `min` and `max` is two constraints.
pub(super) fn read(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Constraint>, Fault> {
    let mut constraints = Vec::new();
    for entry in node.list("a list of constraints, such as [\"nis_mean <= 1.2\"]")? {
        if entry.value.is_str() {
            constraints.push(comparison(&entry, data, states)?);
        } else {
            constraints.extend(table(&entry, data, states)?);
        }
    }
    Ok(constraints)
}

fn kinds() -> Vec<(&'static str, Kind)> {
    Kind::ALL.into_iter().chain(Kind::MEANS).collect()
}

/// `"nis_mean <= 1.2"`.
fn comparison(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Constraint, Fault> {
    let content = node.string()?;
    let is_relation = |c: char| matches!(c, '<' | '>' | '=' | '!');
    let Some(at) = content.find(is_relation) else {
        return Err(node.bad_value(format!("\"{}\"", shorten(content)), EXPECTED));
    };
    let length = content[at..].find(|c| !is_relation(c)).unwrap_or(content.len() - at);
    let (name, relation, limit) = (&content[..at], &content[at..at + length], &content[at + length..]);
    let place = |part: &str, start: usize| {
        let text = part.trim();
        let lead = part.len() - part.trim_start().len();
        // Where nothing stands, the whole of it is to blame.
        if text.is_empty() { node.span } else { node.within(content, start + lead, text.len()) }
    };
    let known = Relation::ALL.iter().find(|(written, _)| *written == relation);
    let Some((_, relation)) = known else {
        let (key, value) = (node.key.clone(), format!("`{}`", shorten(relation)));
        let cause = Cause::BadValue { key, value, expected: "<= or >= between the name and the limit".to_owned() };
        return Err(Fault::new(place(relation, at), cause));
    };
    let kind = objectives::kind(node, name.trim(), "the measure", &kinds())
        .map_err(|cause| Fault::new(place(name, 0), cause))?;
    let number = limit.trim().parse().ok().filter(|limit: &f64| limit.is_finite());
    let Some(limit) = number else {
        let (key, value) = (node.key.clone(), format!("limited by `{}`", shorten(limit.trim())));
        let cause = Cause::BadValue { key, value, expected: "a finite number after <= or >=".to_owned() };
        return Err(Fault::new(place(limit, at + length), cause));
    };
    let measure = objectives::with_truth(node, Objective::new(kind), data, (states, WHAT))?;
    Ok(Constraint { measure, relation: *relation, limit })
}

/// `{ name = "rmse", max = 5, skip = 10 }`, with the options of an objective.
fn table(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Constraint>, Fault> {
    let fields = node.table(EXPECTED, &["name", "max", "min", "states", "skip", "window", "ct"])?;
    let named = fields.need("name", "the name of an objective, `nis_mean` or `nees_mean`")?;
    let kind = objectives::kind(named, named.string()?, "the measure", &kinds()).map_err(|cause| named.fault(cause))?;
    let measure = objectives::with_options(&fields, kind, data, states)?;
    let measure = objectives::with_truth(node, measure, data, (states, WHAT))?;
    let mut constraints = Vec::with_capacity(2);
    for (key, relation) in [("max", Relation::AtMost), ("min", Relation::AtLeast)] {
        if let Some(limit) = fields.optional(key, Node::number)? {
            constraints.push(Constraint { measure: measure.clone(), relation, limit });
        }
    }
    if constraints.is_empty() {
        fields.need("max", "the largest value allowed (or `min`, the smallest)")?;
    }
    Ok(constraints)
}
