//! A first problem file for a log: columns by name and content, a built-in model, starts and bounds from the data.

mod estimate;
mod roles;
mod survey;
mod text;

#[cfg(test)]
mod tests;

use std::io::Read;
use std::path::Path;

use crate::data::LogError;
use crate::model::DataSpec;
use estimate::{Axis, Motion};
use roles::Roles;
use survey::Survey;

/// How a drafted problem file begins, by which it is known.
const MARK: &str = "# Drafted from ";
/// How one begins whose starts are a study's winner.
const TUNED_MARK: &str = "# Tuned, after a draft from ";

impl super::Problem {
    /// Whether its starts are those that [`draft`] guessed, by the comment that a draft begins with.
    #[must_use]
    pub fn is_drafted(&self) -> bool {
        self.text.starts_with(MARK)
    }
}

/// The text of a problem file with other starts: no longer a draft's.
pub(super) fn no_longer_drafted(text: String) -> String {
    match text.strip_prefix(MARK) {
        Some(rest) => format!("{TUNED_MARK}{rest}"),
        None => text,
    }
}

/// A drafted problem file.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// The TOML text, commented, ready for [`super::Problem::parse`].
    pub text: String,
    /// Its `[data]` table.
    pub data: DataSpec,
}

/// Drafts a problem file for the log that `reader` holds.
///
/// `log_path` becomes `file` in `[data]` and stands in messages; `-` is standard input. Reads the whole log once.
///
/// # Errors
/// [`LogError`]: the log is not a CSV table, or no column of it could be a measurement.
///
/// # Examples
/// ```
/// let log = "t,level\n0,10.1\n1,9.7\n2,10.4\n3,10.0\n4,10.2\n";
/// let draft = kfgpu::model::draft("tank.csv".as_ref(), log.as_bytes())?;
/// assert_eq!(draft.data.time.as_deref(), Some("t"));
/// assert!(draft.text.contains("kind = \"local-level\""));
/// # Ok::<(), kfgpu::data::LogError>(())
/// ```
pub fn draft(log_path: &Path, mut reader: impl Read) -> Result<Draft, LogError> {
    let file = log_path.display().to_string();
    let source = if file == "-" { "<stdin>" } else { &file };
    let survey = Survey::read(&mut reader, source)?;
    let roles = Roles::guess(&survey);
    if roles.candidates.is_empty() {
        return Err(LogError::NothingToMeasure { file: source.into() });
    }
    let series: Vec<_> = roles.candidates.iter().map(|&i| survey.series(i, &roles)).collect();
    let motion = Motion::of(&series);
    let taken = roles.candidates.len().min(motion.most_axes());
    let axes: Vec<Axis> =
        roles.axis_names(&survey, taken).into_iter().zip(&series).map(|(n, s)| motion.axis(n, s)).collect();
    let states = motion.states(&axes);
    let name = |i: &usize| survey.columns[*i].name.clone();
    let data = DataSpec {
        file: Some(file),
        time: roles.time.as_ref().map(name),
        measurements: roles.candidates[..taken].iter().map(name).collect(),
        inputs: Vec::new(),
        truth: roles.truth_of(&survey, &states),
        trajectory: roles.trajectory.as_ref().map(name),
        validate: None,
    };
    let text =
        text::Page { survey: &survey, roles: &roles, data: &data, motion, axes: &axes, states: &states }.to_string();
    Ok(Draft { text, data })
}
