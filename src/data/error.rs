//! What can be wrong with a log, each as one sentence that starts with where.

use std::{fmt, io};

use super::instant::no_instant;
use super::rows::shorten;

/// A place in a text file, printed `file:line:column`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it, or `<stdin>`.
    pub file: Box<str>,
    /// 1-based line; comment and blank lines count.
    pub line: u64,
    /// 1-based character in the line, where one is to blame.
    pub column: Option<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)?;
        self.column.map_or(Ok(()), |column| write!(f, ":{column}"))
    }
}

/// Why a log cannot be read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each variant is documented and its fields are the parts of its message")]
#[non_exhaustive]
pub enum LogError {
    /// The problem names no log.
    #[error("[data] names no file (add `file = \"LOG.csv\"`, or `file = \"-\"` for standard input)")]
    Unnamed,
    /// No such file.
    #[error("{file}: no such file (check the name; a path in a problem file is relative to the folder of that file)")]
    NotFound { file: Box<str> },
    /// A folder instead of a file.
    #[error("{file}: is a folder, expected a CSV file (name the file in it)")]
    Directory { file: Box<str> },
    /// The operating system refused.
    #[error("{file}: cannot be read: {error}")]
    Io {
        file: Box<str>,
        #[source]
        error: io::Error,
    },
    /// Nothing but comments and blank lines.
    #[error("{file}: is empty, expected a header line and rows of numbers")]
    Empty { file: Box<str> },
    /// No row follows the header.
    #[error("{file}: has a header but no row")]
    HeaderOnly { file: Box<str> },
    /// The first line holds numbers where names should stand.
    #[error("{place}: expected a header, found only numbers (add a first line that names the columns)")]
    NoHeader { place: Place },
    /// The first line looks like the next (only [`crate::model::draft`]).
    #[error(
        "{place}: expected a header, found {found:?} as in the line after it: add a first line that names the columns{reason}"
    )]
    DataAsHeader { place: Place, found: Box<str>, reason: Box<str> },
    /// `header_line` is beyond the end.
    #[error("{file}: has no header at line {line}, which `header_line` says (or that line is blank)")]
    NoHeaderLine { file: Box<str>, line: u64 },
    /// A line of `skip_lines` is a row like any other.
    #[error("{place}: `skip_lines` leaves out a row of numbers (take it off the list, or empty the cells)")]
    SkippedNumbers { place: Place },
    /// Not text at all.
    #[error("{place}: {found} is not text (expected a CSV file in UTF-8)")]
    Binary { place: Place, found: &'static str },
    /// Text in another encoding.
    #[error("{place}: is not UTF-8 (convert the file, for example with `iconv -f latin1 -t utf-8`)")]
    NotUtf8 { place: Place },
    /// A row has more or fewer cells than the header.
    #[error("{place}: expected as many cells as the header has, {expected}, found {found}{hint}")]
    Ragged { place: Place, found: usize, expected: usize, hint: &'static str },
    /// Text where a number belongs.
    #[error("{place}: column {column:?}: expected a number, found {found:?} ({remedy})")]
    NotNumber { place: Place, column: Box<str>, found: Box<str>, remedy: &'static str },
    /// `inf`, or a number beyond the range of a double.
    #[error("{place}: column {column:?}: expected a finite number, found {found:?} ({remedy})")]
    Infinite { place: Place, column: Box<str>, found: Box<str>, remedy: &'static str },
    /// Neither seconds nor ISO-8601.
    #[error("{place}: column {column:?}: expected a time in seconds or ISO-8601, found {found:?}{reason}")]
    NotTime { place: Place, column: Box<str>, found: Box<str>, reason: Box<str> },
    /// A unit of numbers where there are instants.
    #[error(
        "{place}: column {column:?} holds dates or clock times, which `time_unit = \"{unit}\"` is not for (leave it out)"
    )]
    UnitOfInstants { place: Place, column: Box<str>, unit: &'static str },
    /// Seconds and dates in one column.
    #[error(
        "{place}: column {column:?}: expected {expected} as in the first row, found {found:?} (use one kind of time)"
    )]
    MixedTimes { place: Place, column: Box<str>, found: Box<str>, expected: &'static str },
    /// Time stands still or goes back.
    #[error(
        "{place}: time {time} does not come after {previous} of line {previous_line} \
         (times must increase strictly within a trajectory)"
    )]
    NotIncreasing { place: Place, time: Box<str>, previous: Box<str>, previous_line: u64 },
    /// A second row of a sensor at one time.
    #[error(
        "{place}: sensor {sensor:?} has time {time} a second time, after line {previous_line} \
         (times must increase strictly within a trajectory and sensor)"
    )]
    SecondAtOneTime { place: Place, sensor: Box<str>, time: Box<str>, previous_line: u64 },
    /// A row of a sensor that comes too late.
    #[error(
        "{place}: sensor {sensor:?}: time {time} comes before {previous} of line {previous_line} \
         (rows of all sensors stand in the order of time within a trajectory: sort the log)"
    )]
    Late { place: Place, sensor: Box<str>, time: Box<str>, previous: Box<str>, previous_line: u64 },
    /// A row of a sensor that the problem does not have.
    #[error(
        "{place}: column {column:?}: no [[sensor]] has when = {found:?}{nearest} \
         (add one, or list it in `ignore_sensors` of [data] to leave its rows out)"
    )]
    UnknownSensor { place: Place, column: Box<str>, found: Box<str>, nearest: Box<str> },
    /// A sensor that measures nothing.
    #[error("{file}: sensor {sensor:?} has no measurement: {reason} (correct it, or leave the sensor out)")]
    SilentSensor { file: Box<str>, sensor: Box<str>, reason: Box<str> },
    /// An input is missing where a sensor needs it.
    #[error("{place}: column {column:?}: the input is missing where {measurement:?} is measured, whose h uses it")]
    MissingSensorInput { place: Place, column: Box<str>, measurement: Box<str> },
    /// A row without a time.
    #[error("{place}: column {column:?}: the time is missing (every row needs one)")]
    MissingTime { place: Place, column: Box<str> },
    /// A row without a trajectory.
    #[error("{place}: column {column:?}: the trajectory is missing (every row needs one)")]
    MissingTrajectory { place: Place, column: Box<str> },
    /// An input is missing although a row follows.
    #[error("{place}: column {column:?}: the input is missing (only a trajectory's last row may leave it empty)")]
    MissingInput { place: Place, column: Box<str> },
    /// Two columns of one name.
    #[error("{place}: column {column:?} is named twice in the header, as columns {first} and {second} (rename one)")]
    DuplicateColumn { place: Place, column: Box<str>, first: usize, second: usize },
    /// `[data]` asks for a column that is not there.
    #[error("{place}: no column {column:?}, which [data] names as {role}{nearest}; the header has {present}")]
    NoColumn { place: Place, column: Box<str>, role: Box<str>, nearest: Box<str>, present: Box<str> },
    /// `[data]` uses one column for two things.
    #[error("[data] uses column {column:?} twice, as {first} and as {second} (each column has one role)")]
    UsedTwice { column: Box<str>, first: Box<str>, second: Box<str> },
    /// A measurement column without a single value.
    #[error("{file}: column {column:?}: all values are missing (leave it out of `measurements`)")]
    AllMissing { file: Box<str>, column: Box<str> },
    /// Nothing in the log could be a measurement (only [`crate::model::draft`]).
    #[error("{file}: no column of changing numbers that could be a measurement{reason}")]
    NothingToMeasure { file: Box<str>, reason: Box<str> },
    /// Decimal commas and decimal points (only [`crate::model::draft`]).
    #[error(
        "{point}: found {with_point:?} with a decimal point, but {with_comma:?} in line {line} with a decimal comma (write one kind in all columns)"
    )]
    MixedDecimals { point: Place, with_point: Box<str>, with_comma: Box<str>, line: u64 },
}

impl LogError {
    /// [`Self::NotTime`] with the reason why `text` is none.
    pub(crate) fn not_a_time(place: Place, column: &str, text: &str) -> Self {
        let reason = no_instant(text).unwrap_or_default();
        Self::NotTime { place, column: column.into(), found: shorten(text), reason: reason.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_stays_small_enough_to_return_by_value() {
        assert!(size_of::<LogError>() <= 128, "{} bytes", size_of::<LogError>());
    }
}
