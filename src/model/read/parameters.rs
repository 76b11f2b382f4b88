//! The `[parameters]` table, and the elements of factored covariances.

use super::names::{check_name, limit};
use super::node::{Fields, Node};
use crate::model::error::{Cause, Fault, nearest};
use crate::model::{Parameter, Parameters, Scale, Search, Span, Value};
use crate::words::shorten;

/// Most parameters of a problem.
const MAX_PARAMETERS: usize = 1024;
const SEARCH: &str = "a number, or a table such as { min = 0.1, max = 45, scale = \"log\", start = 10 }";

/// `{ factor = "M", form = "square" }` of a size x size covariance M M'.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Factor {
    pub(super) matrix: &'static str,
    pub(super) name: String,
    pub(super) lower: bool,
    pub(super) size: usize,
    pub(super) span: Span,
}

impl Factor {
    /// Name of element [row, column], counted from 0: `M12`, and `M1_12` for ten rows and more.
    pub(super) fn element(&self, row: usize, column: usize) -> String {
        let separator = if self.size > 9 { "_" } else { "" };
        format!("{}{}{separator}{}", self.name, row + 1, column + 1)
    }

    /// (row, column) of every element that is not a structural zero.
    fn elements(&self) -> impl Iterator<Item = (usize, usize)> {
        let (size, lower) = (self.size, self.lower);
        (0..size).flat_map(move |row| (0..if lower { row + 1 } else { size }).map(move |column| (row, column)))
    }
}

/// Reads every parameter; a factor's template gives its elements their ranges and is itself none.
pub(super) fn read(fields: Option<&Fields<'_>>, factors: &[Factor]) -> Result<Parameters, Fault> {
    let entries = fields.map_or(&[][..], |f| &f.entries);
    let at = fields.map_or(Span::default(), |f| f.span);
    limit(at, entries.len(), "parameters", MAX_PARAMETERS + factors.len())?;
    let is_template = |name: &str| factors.iter().any(|f| f.name == name);
    let declared: Vec<_> = entries.iter().filter(|(name, ..)| !is_template(name)).collect();
    let mut names: Vec<String> = declared.iter().map(|(name, ..)| (*name).to_owned()).collect();
    for (name, span, _) in entries {
        check_name(name, *span)?;
    }
    let elements = missing_elements(entries, factors, &names)?;
    names.extend(elements.iter().map(|p| p.name.clone()));
    limit(at, names.len(), "parameters", MAX_PARAMETERS)?;
    let mut all = Vec::with_capacity(names.len());
    for (name, _, node) in declared {
        let (value, unit) = read_value(node, &names)?;
        all.push(Parameter { name: (*name).to_owned(), unit, value });
    }
    all.extend(elements);
    let tied_to_tied = |p: &Parameter| matches!(p.value, Value::Tied(to) if matches!(all[to].value, Value::Tied(_)));
    if let Some(p) = all.iter().find(|p| tied_to_tied(p)) {
        let node = fields.and_then(|f| f.get(&p.name));
        let problem = "it is tied to a parameter that is tied itself: tie both to the same one";
        return Err(Fault::invalid(node.map_or(Span::default(), |n| n.span), &p.name, problem));
    }
    Ok(Parameters { all })
}

/// The factors' elements that the file does not declare by themselves, from their templates.
fn missing_elements(
    entries: &[(&str, Span, Node<'_>)],
    factors: &[Factor],
    names: &[String],
) -> Result<Vec<Parameter>, Fault> {
    let mut elements = Vec::new();
    for factor in factors {
        let template = entries.iter().find(|(name, ..)| *name == factor.name).map(|(.., node)| node);
        let missing = factor.elements().filter(|(i, j)| !names.contains(&factor.element(*i, *j)));
        for (row, column) in missing.take(MAX_PARAMETERS + 1) {
            let Some(template) = template else {
                let problem = format!(
                    "the factor `{0}` has no template: give `{0}` in [parameters], such as {0} = {{ init = [0, 1], start = 1 }}",
                    factor.name
                );
                return Err(Fault::invalid(factor.span, &factor.name, problem));
            };
            let (value, unit) = element_value(template, names, row == column)?;
            elements.push(Parameter { name: factor.element(row, column), unit, value });
        }
    }
    Ok(elements)
}

/// The template's range; its start on the diagonal and 0 elsewhere.
fn element_value(template: &Node<'_>, names: &[String], diagonal: bool) -> Result<(Value, Option<String>), Fault> {
    let (mut value, unit) = read_value(template, names)?;
    match &mut value {
        Value::Fixed(v) if !diagonal => *v = 0.0,
        Value::Searched(search) if search.scale == Scale::Log => {
            return Err(template.invalid("a factor's template cannot be on a log scale: its elements may be 0"));
        }
        Value::Searched(search) if !diagonal && search.start.is_some() => {
            if search.min > 0.0 || search.max < 0.0 {
                return Err(template.invalid("the bounds of a factor's template with a start must include 0"));
            }
            search.start = Some(0.0);
        }
        Value::Tied(_) => return Err(template.invalid("a factor's template cannot be tied")),
        _ => {}
    }
    Ok((value, unit))
}

fn read_value(node: &Node<'_>, names: &[String]) -> Result<(Value, Option<String>), Fault> {
    if node.value.is_integer() || node.value.is_float() {
        return Ok((Value::Fixed(node.number()?), None));
    }
    let fields = node.table(SEARCH, &["min", "max", "scale", "start", "init", "unit", "tie", "value"])?;
    let unit = fields.optional("unit", |n| Ok(n.string()?.to_owned()))?;
    let value = if fields.get("tie").is_some() {
        alone(&fields, "tie")?;
        Value::Tied(read_tie(node, &fields, names)?)
    } else if fields.get("value").is_some() {
        alone(&fields, "value")?;
        Value::Fixed(fields.need("value", "a number")?.number()?)
    } else {
        Value::Searched(read_search(node, &fields)?)
    };
    Ok((value, unit))
}

/// Refuses any key beside `key` and `unit`.
fn alone(fields: &Fields<'_>, key: &str) -> Result<(), Fault> {
    match fields.entries.iter().find(|(name, ..)| *name != key && *name != "unit") {
        None => Ok(()),
        Some((.., node)) => Err(node.invalid(format!("it cannot stand beside `{key}`: remove one of them"))),
    }
}

fn read_tie(node: &Node<'_>, fields: &Fields<'_>, names: &[String]) -> Result<usize, Fault> {
    let tie = fields.need("tie", "the name of a parameter")?;
    let name = tie.name()?;
    if node.key == format!("parameters.{name}") {
        return Err(tie.invalid("a parameter cannot be tied to itself"));
    }
    names.iter().position(|n| *n == name).ok_or_else(|| {
        let nearest = nearest(&name, names.iter().map(String::as_str));
        let (key, name, known) = (tie.key.clone(), shorten(&name), names.to_vec());
        tie.fault(Cause::NoSuch { key, what: "the parameter", name, nearest, known })
    })
}

fn read_search(node: &Node<'_>, fields: &Fields<'_>) -> Result<Search, Fault> {
    let scale = match fields.optional("scale", |n| Ok((n.clone(), n.string()?)))? {
        None | Some((_, "linear")) => Scale::Linear,
        Some((_, "log")) => Scale::Log,
        Some((n, other)) => return Err(n.bad_value(format!("\"{}\"", shorten(other)), "\"linear\" or \"log\"")),
    };
    let init = fields.optional("init", read_interval)?;
    let (min, max) = read_bounds(node, fields, init.is_some())?;
    if scale == Scale::Log {
        let Some(low) = fields.get("min") else {
            return Err(node.invalid("a log scale needs `min` and `max`, both above 0"));
        };
        if min <= 0.0 {
            return Err(low.bad_value(min, "a number above 0, because the scale is log"));
        }
    }
    if let (Some([low, high]), Some(n)) = (init, fields.get("init"))
        && (low < min || high > max)
    {
        return Err(n.bad_value(format!("[{low}, {high}]"), format!("an interval inside the bounds {min} to {max}")));
    }
    let start = fields.optional("start", |n| Ok((n.clone(), n.number()?)))?;
    if let Some((n, value)) = &start
        && !(min..=max).contains(value)
    {
        return Err(n.bad_value(value, format!("a number inside the bounds {min} to {max}")));
    }
    Ok(Search { min, max, scale, init: init.unwrap_or([min, max]), start: start.map(|(_, value)| value) })
}

/// Bounds; infinite where only `init` is given.
fn read_bounds(node: &Node<'_>, fields: &Fields<'_>, unbounded: bool) -> Result<(f64, f64), Fault> {
    let bounds = (fields.optional("min", Node::number)?, fields.optional("max", Node::number)?);
    let (min, max) = match bounds {
        (Some(min), Some(max)) => (min, max),
        (None, None) if unbounded => (f64::NEG_INFINITY, f64::INFINITY),
        (None, None) => {
            return Err(node.invalid("a searched parameter needs `min` and `max`, or `init` for one without bounds"));
        }
        _ => return Err(node.invalid("`min` and `max` come together: give both, or `init` alone for no bounds")),
    };
    if let Some(high) = fields.get("max")
        && min >= max
    {
        return Err(high.bad_value(max, format!("a number above `min`, which is {min}")));
    }
    if min.is_finite() && !(max - min).is_finite() {
        return Err(node.invalid("the bounds are too far apart"));
    }
    Ok((min, max))
}

/// `[low, high]` with low < high.
fn read_interval(node: &Node<'_>) -> Result<[f64; 2], Fault> {
    let entries = node.list("a list of two numbers, [low, high]")?;
    let [low, high] = entries.as_slice() else {
        return Err(node.wrong_count(entries.len(), "two, [low, high]"));
    };
    let (low, high) = (low.number()?, high.number()?);
    if low < high {
        Ok([low, high])
    } else {
        Err(node.bad_value(format!("[{low}, {high}]"), "[low, high] with low below high"))
    }
}
