//! Problem and log, as every verb opens them.

use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::console::Console;
use crate::data::{self, Log, Summary};
use crate::model::Problem;

/// The example that `kfgpu tune` runs with no file.
const NILE: &str = include_str!("../../examples/nile.toml");
const NILE_DATA: &str = include_str!("../../examples/data/nile.csv");
const NILE_SOURCE: &str = "examples/nile.toml";

/// A problem and the log it is about.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) problem: Problem,
    pub(super) log: Log,
    pub(super) origin: Origin,
    /// What the user should know about the log, in sentences.
    pub(super) warnings: Vec<String>,
}

/// Where the log came from, so that a written problem file can name it again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Origin {
    /// A file.
    File(PathBuf),
    /// Standard input.
    Stdin,
    /// Drawn from the model.
    Simulated,
    /// Ships with the program: its file name and content.
    BuiltIn(&'static str, &'static str),
}

/// Opens a problem (`None` = the built-in example) and its log, `data` in place of the problem's own file, and tells
/// the user about the log.
pub(super) fn load(problem: Option<&Path>, data: Option<&str>, console: Console) -> anyhow::Result<Loaded> {
    let mut parsed = match problem {
        Some(path) => Problem::open(path)?,
        None => Problem::parse(NILE, NILE_SOURCE)?,
    };
    let folder = problem.and_then(Path::parent).unwrap_or_else(|| Path::new(""));
    let origin = origin(&parsed, problem, data, folder);
    let log = match &origin {
        Origin::BuiltIn(name, content) => Log::read(&parsed.data, content.as_bytes(), name)?,
        Origin::Simulated => data::simulate(&parsed, None)?,
        Origin::Stdin | Origin::File(_) => {
            let base = if data.is_some() { Path::new("") } else { folder };
            parsed.data.file = data.map(str::to_owned).or(parsed.data.file);
            Log::open(&parsed.data, base)?
        }
    };
    let warnings = parsed.check_log(&log)?;
    console.note(Summary::of(&log));
    warnings.iter().for_each(|warning| console.warn(warning));
    Ok(Loaded { problem: parsed, log, origin, warnings })
}

fn origin(parsed: &Problem, problem: Option<&Path>, data: Option<&str>, folder: &Path) -> Origin {
    match (data, problem, parsed.data.file.as_deref()) {
        (Some("-"), ..) | (None, Some(_), Some("-")) => Origin::Stdin,
        (Some(file), ..) => Origin::File(PathBuf::from(file)),
        (None, None, _) => Origin::BuiltIn("nile.csv", NILE_DATA),
        (None, Some(_), Some(file)) => Origin::File(folder.join(file)),
        (None, Some(_), None) => Origin::Simulated,
    }
}
