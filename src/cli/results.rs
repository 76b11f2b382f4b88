//! The files of `tune --out DIR`.

use std::path::Path;

use serde::Serialize;

use super::files::OutFolder;
use super::load::Origin;
use super::paths;
use crate::model::Problem;
use crate::study::Generation;

/// result.json and history.csv.
pub(super) fn write(folder: &OutFolder, result: &impl Serialize, history: &[Generation]) -> anyhow::Result<()> {
    folder.write("history.csv", |out| {
        let mut table = csv::Writer::from_writer(out);
        history.iter().try_for_each(|row| table.serialize(row))?;
        Ok(table.flush()?)
    })?;
    folder.write("result.json", |out| {
        serde_json::to_writer(&mut *out, result)?;
        Ok(out.write_all(b"\n")?)
    })
}

/// tuned.toml, which finds its log from the folder.
pub(super) fn write_problem(
    folder: &OutFolder,
    problem: &Problem,
    winner: &[f64],
    origin: &Origin,
) -> anyhow::Result<()> {
    let file = match origin {
        Origin::Stdin | Origin::Simulated => None,
        Origin::File(path) => Some(paths::seen_from(folder.path(), path)),
        Origin::BuiltIn(name, content) => {
            folder.write(name, |out| Ok(out.write_all(content.as_bytes())?))?;
            Some(Path::new(name).to_path_buf())
        }
    };
    let text = match file {
        Some(file) => problem.tuned_with_file(winner, &file.display().to_string()),
        None => problem.tuned(winner),
    };
    folder.write("tuned.toml", |out| Ok(out.write_all(text.as_bytes())?))
}
