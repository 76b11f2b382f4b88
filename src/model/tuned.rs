//! A problem file with the winner as its start, and starts taken from another file.

use toml_edit::{DocumentMut, InlineTable, Item, TableLike, Value as TomlValue};

use super::error::Cause;
use super::{Parameter, Problem, ProblemError, Scale, Search};

impl Problem {
    /// The problem file's own text, comments kept, with the `start` of every searched parameter set to the winner's value:
    /// a problem file ready to run. Elements of a factor become entries of their own.
    ///
    /// `data.file` is left as it is, relative to this problem file; see [`Self::tuned_with_file`].
    #[must_use]
    pub fn tuned(&self, winner: &[f64]) -> String {
        let Ok(mut document) = self.text.parse::<DocumentMut>() else { return self.text.clone() };
        let table = document.get_mut("parameters").and_then(Item::as_table_like_mut);
        if let Some(table) = table {
            for ((parameter, search), value) in self.parameters.searched().zip(winner) {
                set_start(table, parameter, search, *value);
            }
        }
        super::draft::no_longer_drafted(document.to_string())
    }

    /// [`Self::tuned`] for a folder from which the log is found at `file`.
    #[must_use]
    pub fn tuned_with_file(&self, winner: &[f64], file: &str) -> String {
        let text = self.tuned(winner);
        let Ok(mut document) = text.parse::<DocumentMut>() else { return text };
        if let Some(value) = document.get_mut("data").and_then(|d| d.get_mut("file")).and_then(Item::as_value_mut) {
            replace(value, file.into());
        }
        document.to_string()
    }

    /// The text of a problem file with the files of tables in its formulas called otherwise: `rename` gets each name as it
    /// stands there.
    #[must_use]
    pub fn tables_renamed(text: &str, rename: &dyn Fn(&str) -> String) -> String {
        let Ok(mut document) = text.parse::<DocumentMut>() else { return text.to_owned() };
        for table in ["model", "filter", "simulate"] {
            if let Some(item) = document.get_mut(table) {
                rename_in(item, rename);
            }
        }
        document.to_string()
    }

    /// The candidate that `other`'s baseline is for this problem, matched by parameter names: what
    /// `filter PROBLEM --parameters tuned.toml` runs.
    ///
    /// # Errors
    /// If `other` has no parameter of a searched parameter's name, or its value is outside the bounds here.
    pub fn candidate_from(&self, other: &Self) -> Result<Vec<f64>, ProblemError> {
        let values = other.parameters.resolve(&other.parameters.baseline());
        let refuse = |problem: String| ProblemError::whole(&other.source, Cause::Log { problem });
        self.parameters
            .searched()
            .map(|(parameter, search)| {
                let name = &parameter.name;
                let index = other.parameters.all.iter().position(|p| p.name == *name);
                let value = index.map(|i| values[i]).ok_or_else(|| {
                    refuse(format!("the parameter `{name}`, which {} searches, is not in this file", self.source))
                })?;
                if (search.min..=search.max).contains(&value) {
                    return Ok(value);
                }
                let (min, max) = (search.min, search.max);
                Err(refuse(format!("`{name}` is {value}: {} expects a number from {min} to {max}", self.source)))
            })
            .collect()
    }
}

/// Sets `start` in the parameter's own entry, or gives a factor's element one.
fn set_start(table: &mut dyn TableLike, parameter: &Parameter, search: &Search, value: f64) {
    match table.get_mut(&parameter.name).and_then(Item::as_table_like_mut) {
        Some(entry) => match entry.get_mut("start").and_then(Item::as_value_mut) {
            Some(start) => replace(start, number(value)),
            None => {
                entry.insert("start", Item::Value(number(value)));
            }
        },
        None => {
            table.insert(&parameter.name, Item::Value(TomlValue::InlineTable(element(parameter, search, value))));
        }
    }
}

fn rename_in(item: &mut Item, rename: &dyn Fn(&str) -> String) {
    if let Some(table) = item.as_table_like_mut() {
        table.iter_mut().for_each(|(_, item)| rename_in(item, rename));
    } else if let Some(value) = item.as_value_mut() {
        rename_in_value(value, rename);
    }
}

fn rename_in_value(value: &mut TomlValue, rename: &dyn Fn(&str) -> String) {
    match value {
        TomlValue::Array(list) => list.iter_mut().for_each(|value| rename_in_value(value, rename)),
        TomlValue::InlineTable(table) => table.iter_mut().for_each(|(_, value)| rename_in_value(value, rename)),
        TomlValue::String(text) => {
            let formula = renamed(text.value(), rename);
            if formula != *text.value() {
                replace(value, formula.into());
            }
        }
        _ => {}
    }
}

/// A formula with what stands in quotes replaced: only files of tables do.
fn renamed(formula: &str, rename: &dyn Fn(&str) -> String) -> String {
    let (mut text, mut rest) = (String::new(), formula);
    while let Some(start) = rest.find(['"', '\'']) {
        let (before, quoted) = rest.split_at(start);
        let Some((file, after)) = quoted[1..].split_once(&quoted[..1]) else { break };
        let name = rename(file);
        let quote = if name.contains('"') { '\'' } else { '"' };
        text += &format!("{before}{quote}{name}{quote}");
        rest = after;
    }
    text + rest
}

/// Replaces a value and keeps the space and comments around it.
fn replace(old: &mut TomlValue, new: TomlValue) {
    let decor = old.decor().clone();
    *old = new;
    *old.decor_mut() = decor;
}

/// The shortest text that reads back as the same number.
fn number(value: f64) -> TomlValue {
    format!("{value:?}").parse().unwrap_or_else(|_| value.into())
}

/// The entry of a factor's element.
fn element(parameter: &Parameter, search: &Search, value: f64) -> InlineTable {
    let mut entry = InlineTable::new();
    if search.min.is_finite() {
        entry.insert("min", number(search.min));
        entry.insert("max", number(search.max));
    }
    if search.scale == Scale::Log {
        entry.insert("scale", "log".into());
    }
    let [low, high] = search.init;
    if !search.min.is_finite() || low > search.min || high < search.max {
        entry.insert("init", TomlValue::Array([low, high].map(number).into_iter().collect()));
    }
    entry.insert("start", number(value));
    if let Some(unit) = &parameter.unit {
        entry.insert("unit", unit.as_str().into());
    }
    entry
}
