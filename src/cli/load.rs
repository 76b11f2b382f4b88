//! Problem and log, as every verb opens them.

use std::path::{Path, PathBuf};

use anyhow::anyhow;

use super::console::Console;
use super::overrides::{self, Override};
use super::{memory, run_files};
use crate::data::{Log, LogError, Oddity, Summary};
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

impl Origin {
    /// The file, where it is one.
    pub(super) fn file(&self) -> Option<&Path> {
        if let Self::File(path) = self { Some(path) } else { None }
    }
}

/// The problem (`None` = the built-in example), not yet its log.
pub(super) fn problem(path: Option<&Path>) -> anyhow::Result<Problem> {
    Ok(match path {
        Some(path) => Problem::open(path).map_err(|error| log_for_problem(path).unwrap_or_else(|| error.into()))?,
        None => Problem::parse(NILE, NILE_SOURCE)?,
    })
}

/// The error for a log where a problem file belongs.
fn log_for_problem(path: &Path) -> Option<anyhow::Error> {
    let extension = path.extension()?.to_ascii_lowercase();
    let is_log = path.is_file() && ["csv", "tsv", "txt", "dat"].iter().any(|known| extension == *known);
    let path = path.display();
    is_log.then(|| {
        anyhow!("{path} is a log, expected a problem file: draft one with `kfgpu init {path} --out problem.toml`")
    })
}

/// A problem with its log, `data` in place of the problem's own file; tells the user about the log.
pub(super) fn load(path: Option<&Path>, data: Option<&str>, console: Console) -> anyhow::Result<Loaded> {
    log_of(problem(path)?, path, data, console)
}

/// As [`load`], for a problem already open.
pub(super) fn log_of(
    mut problem: Problem,
    path: Option<&Path>,
    data: Option<&str>,
    console: Console,
) -> anyhow::Result<Loaded> {
    let mut folder = path.and_then(Path::parent).unwrap_or_else(|| Path::new(""));
    if let Some(file) = data {
        folder = Path::new("");
        problem = overrides::apply(problem, &[Override::new("--data", &["data", "file"], file)])?;
    }
    let origin = match (&problem.data.file, data, path) {
        (_, None, None) => Origin::BuiltIn("nile.csv", NILE_DATA),
        (None, ..) if problem.simulate.is_some() => Origin::Simulated,
        (None, ..) => return Err(LogError::Unnamed.into()),
        (Some(file), ..) if file == "-" => Origin::Stdin,
        (Some(file), ..) => Origin::File(folder.join(file)),
    };
    let log = match &origin {
        Origin::BuiltIn(name, content) => Log::read(&problem.data, content.as_bytes(), name)?,
        Origin::Simulated => {
            memory::ensure_log_fits(&problem)?;
            crate::simulate::simulate(&problem, None)?
        }
        Origin::Stdin | Origin::File(_) => Log::open(&problem.data, folder)?,
    };
    console.note(Summary::of(&log));
    let mut warnings = problem.check_log(&log)?;
    if origin != Origin::Simulated {
        warnings.extend(Oddity::of(&log).iter().map(|odd| format!("{odd} ({})", log.source)));
    }
    warnings.iter().for_each(|warning| console.warn(warning));
    Ok(Loaded { problem, log, origin, warnings })
}

/// The candidate that a verb runs: the start values of `parameters`, another problem file or the folder of a run, or the
/// problem's own.
pub(super) fn candidate(problem: &Problem, parameters: Option<&Path>) -> anyhow::Result<Vec<f64>> {
    Ok(match parameters {
        Some(path) => problem.candidate_from(&Problem::open(&run_files::file_in(path, run_files::TUNED)?)?)?,
        None => problem.parameters.baseline(),
    })
}
