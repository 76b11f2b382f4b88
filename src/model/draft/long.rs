//! Logs in long form: a column of words that says which sensor each row is of.

use super::roles::Roles;
use super::survey::{Column, Content, Survey};

/// Words in names of such columns.
const WORDS: [&str; 10] =
    ["sensor", "source", "src", "device", "channel", "topic", "instrument", "modality", "type", "kind"];
/// Most sensors of a log.
const MOST: usize = 16;

/// Advice on sensors, where a column of few different words is named after them, or rows share their times.
pub(super) fn said(survey: &Survey, roles: &Roles) -> Option<String> {
    let (column, labels) = survey.columns.iter().find_map(|column| Some((column, labels(column)?)))?;
    let named = WORDS.iter().any(|word| column.name.to_lowercase().contains(word));
    if !named && roles.false_time.is_none() {
        return None;
    }
    let name = &column.name;
    let list: Vec<String> = labels.iter().take(6).map(|label| format!("{label:?}")).collect();
    Some(format!(
        "column {name:?} seems to say which sensor a row is of ({}): give sensor = {name:?} in [data], and for each a \
         [[sensor]] table with when = {:?} or the like and its own measurements, h and R, instead of those of [model] \
         (docs/problem-file.md)",
        list.join(", "),
        labels[0]
    ))
}

/// The different words of a column of few, each several times over in its first rows.
fn labels(column: &Column) -> Option<Vec<&str>> {
    if column.content != Content::Text || column.unreadable_time().is_some() {
        return None;
    }
    let mut labels: Vec<&str> = Vec::new();
    for odd in &column.odd {
        if !labels.contains(&&*odd.text) {
            labels.push(&odd.text);
        }
    }
    ((2..=MOST).contains(&labels.len()) && 3 * labels.len() <= column.odd.len()).then_some(labels)
}
