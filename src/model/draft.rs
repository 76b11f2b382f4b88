//! A first problem file for a log: columns by name and content, a built-in model, starts and bounds from the data.

mod cautions;
mod clockwork;
mod degrees;
mod estimate;
mod layout;
mod long;
mod names;
mod roles;
mod series;
mod survey;
mod text;

#[cfg(test)]
mod tests;

use crate::data::{DataSpec, Log, LogError, Oddity};
use degrees::Degrees;
use estimate::{Axis, Motion};
use layout::Layout;
use roles::Roles;
use std::io::Read;
use std::path::Path;
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
    /// What the user should know before tuning it, in sentences.
    pub warnings: Vec<String>,
}

/// Drafts a problem file for the log that `reader` holds.
///
/// `log_path` becomes `file` in `[data]` and stands in messages; `-` is standard input. Holds the whole text in memory.
///
/// # Errors
/// [`LogError`]: the log is not a CSV table, its times cannot be read, or no column of it could be a measurement.
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
    let mut text = Vec::new();
    reader.read_to_end(&mut text).map_err(|error| LogError::Io { file: source.into(), error })?;
    let Layout { mut format, units, mut said } = Layout::of(&text, source)?;
    let mut survey = Survey::read(&text, source, &format)?;
    if let Some((lines, summary)) = survey.without_summaries() {
        format.skip_lines.extend(lines);
        said.push(summary);
    }
    let roles = Roles::guess(&survey);
    clockwork::refuse_unreadable(&survey, &roles)?;
    let flaws = cautions::flaws(&survey);
    if roles.candidates.is_empty() {
        let reason = flaws.first().map_or_else(String::new, |flaw| format!(": {flaw}"));
        return Err(LogError::NothingToMeasure { file: source.into(), reason: reason.into() });
    }
    let name = |i: &usize| survey.columns[*i].name.clone();
    let mut data = DataSpec {
        file: Some(file.clone()),
        time: roles.time.as_ref().map(name),
        measurements: roles.candidates.iter().map(name).collect(),
        trajectory: roles.trajectory.as_ref().map(name),
        format,
        ..DataSpec::default()
    };
    let unit = clockwork::guess_unit(&survey, &roles, &units, &data, &text);
    data.time_unit = unit.as_ref().map(|(unit, _)| *unit);
    // As `tune` will read it, with every candidate measured.
    let log = Log::read(&data, text.as_slice(), source)?;
    let series: Vec<_> = (0..roles.candidates.len()).map(|i| series::series(&log, i)).collect();
    let motion = Motion::of(&series);
    let taken = roles.candidates.len().min(motion.most_axes());
    let axes: Vec<Axis> =
        roles.axis_names(&survey, taken).into_iter().zip(&series).map(|(n, s)| motion.axis(n, s)).collect();
    let states = motion.states(&axes);
    data.measurements.truncate(taken);
    data.truth = roles.truth_of(&survey, &states);
    let degrees = Degrees::of(&survey, &roles.candidates[..taken]);
    said.extend(clockwork::say(&survey, &roles, unit.as_ref()));
    said.extend(long::said(&survey, &roles));
    said.extend(cautions::inputs(&survey, &roles));
    said.extend(flaws);
    said.extend(degrees.as_ref().map(|degrees| degrees.said(&survey)));
    said.extend(Oddity::of(&log).iter().filter(|odd| data.measurements.contains(&odd.column)).map(ToString::to_string));
    let start = text::Start::of(&log, &axes);
    let units = roles.units_of(&survey, &units, taken, degrees.as_ref());
    let page = text::Page {
        survey: &survey,
        roles: &roles,
        data: &data,
        motion,
        axes: &axes,
        states: &states,
        said: &said,
        start: &start,
        units: &units,
    };
    Ok(Draft { text: page.to_string(), data, warnings: said })
}
