//! The files of `tune --out DIR`.

use std::path::Path;

use serde::Serialize;

use super::folder::OutFolder;
use super::load::Origin;
use super::run_files::{OTHERS, RESULT, TUNED};
use super::{paths, pictures};
use crate::model::Problem;
use crate::report::{Nothing, Tuning, markdown, markdown_without_winner, write_front};
use crate::study::Generation;

/// Every file of a study with a winner. Pictures come last, and the report again with them: where the disk is full, or
/// a second signal ends the process, the numbers are there.
pub(super) fn write(
    folder: &OutFolder,
    problem: &Problem,
    origin: &Origin,
    tuning: &Tuning,
    study: &pictures::Study<'_>,
) -> anyhow::Result<()> {
    clear(folder, &problem.source)?;
    write_history(folder, &study.outcome.history)?;
    if let Some(points) = &tuning.front {
        folder.write("front.csv", |out| Ok(write_front(points, out)?))?;
    }
    write_problem(folder, problem, &study.winner.candidate, origin)?;
    write_text(folder, "report.md", &markdown(tuning, &[]))?;
    write_result(folder, tuning)?;
    pictures::write_tuning(folder, problem, study, &tuning.consistency.whiteness)?;
    write_text(folder, "report.md", &markdown(tuning, &pictures::drawn(folder, tuning)))
}

/// Every file of a study without one.
pub(super) fn write_nothing(
    folder: &OutFolder,
    nothing: &Nothing,
    history: &[Generation],
    why: &str,
) -> anyhow::Result<()> {
    clear(folder, &nothing.effort.problem)?;
    write_history(folder, history)?;
    write_text(folder, "report.md", &markdown_without_winner(nothing, why))?;
    write_result(folder, nothing)
}

/// Removes what an earlier run left, so that no file of it stands beside those of this one. The result goes first: a
/// folder that has one has the numbers that belong to it. The problem file itself stays, where a tuned.toml is tuned again.
fn clear(folder: &OutFolder, problem: &str) -> anyhow::Result<()> {
    folder.remove(RESULT)?;
    let tuned_again = |name: &str| paths::are_one(&folder.path().join(name), Path::new(problem));
    OTHERS.iter().filter(|name| !tuned_again(name)).try_for_each(|name| folder.remove(name))?;
    pictures::clear(folder)
}

fn write_history(folder: &OutFolder, history: &[Generation]) -> anyhow::Result<()> {
    folder.write("history.csv", |out| {
        let mut table = csv::Writer::from_writer(out);
        history.iter().try_for_each(|row| table.serialize(row))?;
        Ok(table.flush()?)
    })
}

fn write_result(folder: &OutFolder, result: &impl Serialize) -> anyhow::Result<()> {
    folder.write(RESULT, |out| {
        serde_json::to_writer(&mut *out, result)?;
        Ok(out.write_all(b"\n")?)
    })
}

fn write_text(folder: &OutFolder, name: &str, text: &str) -> anyhow::Result<()> {
    folder.write(name, |out| Ok(out.write_all(text.as_bytes())?))
}

/// tuned.toml, which finds its log from the folder.
fn write_problem(folder: &OutFolder, problem: &Problem, winner: &[f64], origin: &Origin) -> anyhow::Result<()> {
    let file = match origin {
        Origin::Stdin | Origin::Simulated => None,
        Origin::File(path) => Some(paths::seen_from(folder.path(), path)),
        Origin::BuiltIn(name, content) => {
            write_text(folder, name, content)?;
            Some(Path::new(name).to_path_buf())
        }
    };
    let text = match file {
        Some(file) => problem.tuned_with_file(winner, &file.display().to_string()),
        None => problem.tuned(winner),
    };
    // Files of tables are relative to the problem's own folder.
    let base = Path::new(&problem.source).parent().unwrap_or_else(|| Path::new(""));
    let table = |name: &str| paths::seen_from(folder.path(), &base.join(name)).display().to_string();
    write_text(folder, TUNED, &Problem::tables_renamed(&text, &table))
}
