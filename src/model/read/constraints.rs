//! `[tune] constraints`: `"nis_mean <= 1.2"`, `"0.8 <= nis_mean <= 1.2"`, or `{ name = "rmse", states = ["d"], max = 5 }`.

use super::node::Node;
use super::objectives;
use crate::data::DataSpec;
use crate::model::Span;
use crate::model::error::{Cause, Fault};
use crate::objective::{Constraint, Kind, Objective, Relation};
use crate::words::shorten;

const EXPECTED: &str = "a name, <= or >=, and a number, such as \"nis_mean <= 1.2\" or \"0.8 <= nis_mean <= 1.2\", or a table with `name` \
     and `max` or `min`";
const BOTH_SIDES: &str = "a smaller and a larger number around the name, such as \"0.8 <= nis_mean <= 1.2\"";
const WHAT: &str = "the constraint on";

/// Reads the list; a table with both `min` and `max` is two constraints.
pub(super) fn read(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Constraint>, Fault> {
    let mut constraints = Vec::new();
    for entry in node.list("a list of constraints, such as [\"nis_mean <= 1.2\"]")? {
        if entry.value.is_str() {
            constraints.extend(comparison(&entry, data, states)?);
        } else {
            constraints.extend(table(&entry, data, states)?);
        }
    }
    Ok(constraints)
}

fn kinds() -> Vec<(&'static str, Kind)> {
    Kind::ALL.into_iter().chain(Kind::MEANS).collect()
}

/// `"nis_mean <= 1.2"`, or from both sides `"0.8 <= nis_mean <= 1.2"`, which is two constraints.
fn comparison(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Constraint>, Fault> {
    let content = node.string()?;
    let (parts, relations) = split(content);
    let relation = |part: &Part<'_>| {
        let known = Relation::ALL.iter().find(|(written, _)| *written == part.text);
        known.map(|(_, relation)| *relation).ok_or_else(|| {
            part.bad_value(node, format!("`{}`", shorten(part.text)), "<= or >= between the name and the limit")
        })
    };
    let limit = |part: &Part<'_>, sign: &str| {
        let number = part.text.parse().ok().filter(|limit: &f64| limit.is_finite());
        let expected = format!("a finite number {sign} <= or >=");
        number.ok_or_else(|| part.bad_value(node, format!("limited by `{}`", shorten(part.text)), &expected))
    };
    let (name, bounds) = match (&parts[..], &relations[..]) {
        ([below, name], [between]) if below.text.parse::<f64>().is_ok() => {
            (name, vec![(relation(between)?.mirrored(), limit(below, "before")?)])
        }
        ([name, above], [between]) => (name, vec![(relation(between)?, limit(above, "after")?)]),
        ([first, name, second], [left, right]) => {
            let (left, right) = (relation(left)?, relation(right)?);
            let (first, second) = (limit(first, "before")?, limit(second, "after")?);
            // What is on the left of the name bounds it the other way round.
            let ordered = if left == Relation::AtMost { first <= second } else { first >= second };
            if left != right || !ordered {
                return Err(node.bad_value(format!("\"{}\"", shorten(content)), BOTH_SIDES));
            }
            (name, vec![(left.mirrored(), first), (right, second)])
        }
        _ => return Err(node.bad_value(format!("\"{}\"", shorten(content)), EXPECTED)),
    };
    let kind = objectives::kind(node, name.text, "the measure", &kinds())
        .map_err(|cause| Fault::new(name.place(node), cause))?;
    let measure = objectives::with_truth(node, Objective::new(kind), data, (states, WHAT))?;
    let constraint = |(relation, limit)| Constraint { measure: measure.clone(), relation, limit };
    Ok(bounds.into_iter().map(constraint).collect())
}

/// A piece of a comparison: what stands between relations, or a relation.
struct Part<'a> {
    text: &'a str,
    /// The whole comparison, and where in it the piece begins.
    content: &'a str,
    at: usize,
}

impl Part<'_> {
    /// Where it stands in the file; where nothing stands, the whole of it is to blame.
    fn place(&self, node: &Node<'_>) -> Span {
        if self.text.is_empty() { node.span } else { node.within(self.content, self.at, self.text.len()) }
    }

    fn bad_value(&self, node: &Node<'_>, value: String, expected: &str) -> Fault {
        let cause = Cause::BadValue { key: node.key.clone(), value, expected: expected.to_owned() };
        Fault::new(self.place(node), cause)
    }
}

/// Names and numbers, and the relations between them.
fn split(content: &str) -> (Vec<Part<'_>>, Vec<Part<'_>>) {
    let is_relation = |c: char| matches!(c, '<' | '>' | '=' | '!');
    let part = |at: usize, end: usize| {
        let piece = &content[at..end];
        Part { text: piece.trim(), content, at: at + piece.len() - piece.trim_start().len() }
    };
    let (mut parts, mut relations, mut at) = (Vec::new(), Vec::new(), 0);
    while let Some(start) = content[at..].find(is_relation).map(|i| at + i) {
        let end = content[start..].find(|c| !is_relation(c)).map_or(content.len(), |i| start + i);
        parts.push(part(at, start));
        relations.push(part(start, end));
        at = end;
    }
    parts.push(part(at, content.len()));
    (parts, relations)
}

/// `{ name = "rmse", max = 5, skip = 10 }`, with the options of an objective.
fn table(node: &Node<'_>, data: &DataSpec, states: &[String]) -> Result<Vec<Constraint>, Fault> {
    let fields = node.table(EXPECTED, &[&["name", "max", "min"], &objectives::OPTIONS[..]].concat())?;
    let named = fields.need("name", "the name of an objective, `nis_mean`, `nees_mean` or `rejected`")?;
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
