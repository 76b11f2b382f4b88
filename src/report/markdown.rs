//! report.md: a study for somebody who has not seen the tool.

mod section;
mod verdict;

#[cfg(test)]
mod tests;

use super::{Nothing, Tuning};

/// A picture that the report shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Path of its file, relative to the report.
    pub path: String,
    /// What it shows, in a sentence.
    pub caption: String,
}

/// The report of a study as Markdown, with these pictures.
#[must_use]
pub fn markdown(tuning: &Tuning, pictures: &[Picture]) -> String {
    let sections = [
        section::title(&tuning.effort),
        verdict::of(tuning),
        section::parameters(tuning),
        section::objectives(tuning),
        section::constraints(tuning),
        section::front(tuning),
        section::consistency(tuning),
        section::pictures(pictures),
        section::filter(tuning),
        section::search(tuning),
        section::warnings(&tuning.effort.warnings),
        section::words(tuning),
    ];
    join(sections.into_iter().flatten())
}

/// The report of a study without a usable candidate; `why` is a clause without a full stop.
#[must_use]
pub fn markdown_without_winner(nothing: &Nothing, why: &str) -> String {
    let verdict = format!("## Verdict\n\n**No usable candidate was found**: {why}.");
    let effort = section::effort(&nothing.effort);
    join(
        [section::title(&nothing.effort), Some(verdict), Some(effort), section::warnings(&nothing.effort.warnings)]
            .into_iter()
            .flatten(),
    )
}

fn join(sections: impl Iterator<Item = String>) -> String {
    sections.collect::<Vec<_>>().join("\n\n") + "\n"
}

/// Text of the user's as Markdown shows it: nothing in it is markup.
fn plain(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '~' | '$' | '&' => escaped.extend(['\\', c]),
            c if c.is_control() => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A table; cells are Markdown already. Columns that are empty under their header are left out.
fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let shown: Vec<usize> =
        (0..header.len()).filter(|c| rows.iter().any(|row| row.get(*c).is_some_and(|cell| !cell.is_empty()))).collect();
    let line = |cells: Vec<&str>| format!("| {} |", cells.join(" | "));
    let numeric = |c: &usize| {
        let mut cells = rows.iter().filter_map(|row| row.get(*c)).filter(|cell| !cell.is_empty()).peekable();
        cells.peek().is_some()
            && cells.all(|cell| cell.starts_with(|first: char| first.is_ascii_digit() || first == '-'))
    };
    let mut lines = vec![line(shown.iter().map(|c| header[*c]).collect())];
    lines.push(line(shown.iter().map(|c| if numeric(c) { "---:" } else { "---" }).collect()));
    lines.extend(rows.iter().map(|row| line(shown.iter().map(|c| row.get(*c).map_or("", String::as_str)).collect())));
    lines.join("\n")
}
