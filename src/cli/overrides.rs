//! Flags that take the place of keys of the problem file.
//!
//! They are written into the file's text and the text is read again: flags and keys obey the same rules, and the
//! tuned.toml of a run holds what the run did.

use anyhow::anyhow;
use toml_edit::{Array, DocumentMut, InlineTable, Item, TableLike, Value, value};

use crate::data::SplitBy;
use crate::model::{Problem, ProblemError};

/// A key with its new value, and the flag that asked for it.
#[derive(Debug, Clone)]
pub(super) struct Override {
    /// Table, perhaps a table in it, key.
    path: &'static [&'static str],
    value: Value,
    flag: String,
}

impl Override {
    /// `flag` as the user typed it, without its value.
    pub(super) fn new(flag: &str, path: &'static [&'static str], value: impl Into<Value>) -> Self {
        let value = value.into();
        let text = value.to_string();
        Self { path, flag: format!("{flag} {}", text.trim().trim_matches('"')), value }
    }

    /// A flag without a value.
    pub(super) fn switch(flag: &str, path: &'static [&'static str], value: bool) -> Self {
        Self { path, value: value.into(), flag: flag.to_owned() }
    }

    /// `--validate`, which leaves alone what is held out by.
    pub(super) fn validate(share: f64, by: Option<SplitBy>) -> Self {
        let value = match by {
            None => share.into(),
            Some(by) => {
                let by = if by == SplitBy::Time { "time" } else { "trajectory" };
                Value::InlineTable([("share", Value::from(share)), ("by", by.into())].into_iter().collect())
            }
        };
        Self { path: &["data", "validate"], value, flag: format!("--validate {share}") }
    }

    /// `--objectives`: an objective that the file names keeps the options it has there.
    pub(super) fn objectives(problem: &Problem, names: &[String]) -> Self {
        let existing = existing_objectives(&problem.text);
        let options_of = |name: &String| {
            let same = |v: &&Value| v.as_inline_table().and_then(|t| t.get("name")?.as_str()) == Some(name.as_str());
            existing.iter().find(same).cloned().unwrap_or_else(|| Value::from(name.as_str()))
        };
        let value: Array = names.iter().map(options_of).collect();
        Self { path: &["tune", "objectives"], value: value.into(), flag: format!("--objectives {}", names.join(",")) }
    }
}

impl Override {
    /// `--constraint`, given once or several times.
    pub(super) fn constraints(bounds: &[String]) -> Self {
        let value: Array = bounds.iter().map(|bound| Value::from(bound.trim())).collect();
        let flag = bounds.iter().map(|bound| format!("--constraint '{bound}'")).collect::<Vec<_>>().join(" ");
        Self { path: &["tune", "constraints"], value: value.into(), flag }
    }

    /// `--pick`: a word, or `objective=weight` pairs.
    pub(super) fn pick(text: &str) -> Self {
        let flag = format!("--pick {text}");
        let path = &["tune", "pick"];
        if !text.contains('=') {
            return Self { path, value: text.into(), flag };
        }
        let mut weights = InlineTable::new();
        for pair in text.split(',') {
            let (name, weight) = pair.split_once('=').unwrap_or((pair, ""));
            // What is no number is refused where the problem is read, by the sentence it has there.
            let weight = weight.trim().parse::<f64>().map_or_else(|_| Value::from(weight.trim()), Value::from);
            weights.insert(name.trim(), weight);
        }
        let value = InlineTable::from_iter([("weights", Value::from(weights))]);
        Self { path, value: value.into(), flag }
    }
}

/// The problem with these keys replaced.
pub(super) fn apply(problem: Problem, overrides: &[Override]) -> anyhow::Result<Problem> {
    if overrides.is_empty() {
        return Ok(problem);
    }
    replaced(&problem, overrides).map_err(|error| blame(&problem, overrides, error))
}

/// Names the flag to blame: the first after which the problem is refused.
fn blame(problem: &Problem, overrides: &[Override], error: ProblemError) -> anyhow::Error {
    let refused = |count: &usize| replaced(problem, &overrides[..*count]).is_err();
    match (1..=overrides.len()).find(refused) {
        Some(count) => anyhow!("{}: {}", overrides[count - 1].flag, error.cause),
        None => error.into(),
    }
}

fn replaced(problem: &Problem, overrides: &[Override]) -> Result<Problem, ProblemError> {
    Problem::parse(&edited(&problem.text, overrides), &problem.source)
}

/// The text with a key replaced; as it was where it is no TOML, which no problem's text is.
fn edited(text: &str, overrides: &[Override]) -> String {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return text.to_owned() };
    for Override { path, value, .. } in overrides {
        document.entry(path[0]).or_insert(toml_edit::table());
        set(document.as_table_mut(), path, value.clone());
    }
    document.to_string()
}

/// Sets `path` in `table`; a table on the way that does not exist yet is written inline.
fn set(table: &mut dyn TableLike, path: &[&str], new: Value) {
    match path {
        [] => {}
        [key] => match table.get_mut(key).and_then(Item::as_value_mut) {
            Some(old) => {
                // The comment behind the old value stays.
                let decor = old.decor().clone();
                *old = new;
                *old.decor_mut() = decor;
            }
            None => {
                table.insert(key, value(new));
            }
        },
        [first, rest @ ..] => {
            let inner = table.entry(first).or_insert(value(InlineTable::new()));
            if let Some(inner) = inner.as_table_like_mut() {
                set(inner, rest, new);
            }
        }
    }
}

fn existing_objectives(text: &str) -> Vec<Value> {
    let document = text.parse::<DocumentMut>().unwrap_or_default();
    match document.get("tune").and_then(|tune| tune.get("objectives")) {
        Some(Item::Value(Value::Array(list))) => list.iter().cloned().collect(),
        Some(Item::ArrayOfTables(list)) => list.iter().map(|t| t.clone().into_inline_table().into()).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_order_stay() {
        let text = "[tune]\nseed = 7 # mine\nstop = { stall = 3 }\n";
        let seed = Override::new("--seed", &["tune", "seed"], 9);
        let target = Override::new("--target", &["tune", "stop", "target"], 1.5);
        assert_eq!(edited(text, &[seed, target]), "[tune]\nseed = 9 # mine\nstop = { stall = 3 , target = 1.5 }\n");
    }

    #[test]
    fn a_share_replaces_any_form_of_the_key() {
        for text in
            ["", "[data]\nvalidate = 0.1\n", "[data]\nvalidate = { share = 0.1 }\n", "[data.validate]\nshare = 0.1\n"]
        {
            let read =
                |change: Override| edited(text, &[change]).parse::<toml::Table>().unwrap()["data"]["validate"].clone();
            assert_eq!(read(Override::validate(0.4, None)).as_float(), Some(0.4), "{text:?}");
            assert_eq!(read(Override::validate(0.4, Some(SplitBy::Time)))["by"].as_str(), Some("time"), "{text:?}");
            let none = Override::switch("--no-validate", &["data", "validate"], false);
            assert_eq!(read(none).as_bool(), Some(false), "{text:?}");
        }
    }

    #[test]
    fn absent_tables_are_made() {
        let target = Override::new("--target", &["tune", "stop", "target"], 1.5);
        for text in ["", "[data]\nfile = \"a.csv\"\n", "[tune]\n", "tune = { seed = 1 }\n", "[tune.stop]\nstall = 1\n"]
        {
            let read: toml::Table = edited(text, std::slice::from_ref(&target)).parse().unwrap();
            assert_eq!(read["tune"]["stop"]["target"].as_float(), Some(1.5), "{text:?} became {read:?}");
        }
    }
}
