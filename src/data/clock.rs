//! What a time cell means: plain numbers are seconds, ISO-8601 becomes seconds since the log's first row.

use jiff::Timestamp;
use jiff::civil::Time;
use jiff::fmt::temporal::Pieces;
use jiff::tz::Offset;

use super::rows::shorten;
use super::{LogError, Rows};

/// Reads the time column; its first cell decides which kind of time it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Clock {
    /// No cell read yet.
    Unset,
    /// Plain seconds.
    Seconds,
    /// ISO-8601; seconds count from here.
    Since(Timestamp),
}

impl Clock {
    /// Time [s] in cell `i` of the current row.
    pub(crate) fn read(&mut self, rows: &Rows<'_>, i: usize) -> Result<f64, LogError> {
        let text = rows.cell(i)?;
        if Rows::is_missing(text) {
            return Err(LogError::MissingTime { place: rows.place(i), column: rows.name(i) });
        }
        match (text.parse::<f64>(), *self) {
            (Ok(_), Self::Since(_)) => Err(mixed(rows, i, "an ISO-8601 time")),
            (Ok(_), _) => {
                *self = Self::Seconds;
                rows.number(i, "every row needs a time")
            }
            (Err(_), Self::Seconds) if instant(text).is_ok() => Err(mixed(rows, i, "seconds")),
            (Err(_), Self::Seconds) => Err(not_time(rows, i, String::new())),
            (Err(_), Self::Unset) => {
                *self = Self::Since(instant(text).map_err(|reason| not_time(rows, i, reason))?);
                Ok(0.0)
            }
            (Err(_), Self::Since(origin)) => {
                let now = instant(text).map_err(|reason| not_time(rows, i, reason))?;
                // Whole nanoseconds are subtracted before anything is rounded to a double.
                Ok((now.as_nanosecond() - origin.as_nanosecond()) as f64 / 1e9)
            }
        }
    }

    /// A time of this clock as the log writes it, for messages.
    pub(crate) fn show(self, seconds: f64) -> Box<str> {
        let Self::Since(origin) = self else { return seconds.to_string().into() };
        let nanoseconds = origin.as_nanosecond() + (seconds * 1e9).round() as i128;
        Timestamp::from_nanosecond(nanoseconds).map_or_else(|_| seconds.to_string(), |t| t.to_string()).into()
    }
}

/// The instant an ISO-8601 text names: without a zone it is UTC, without a time of day it is midnight.
fn instant(text: &str) -> Result<Timestamp, String> {
    if !text.starts_with(|c: char| c.is_ascii_digit() || c == '+' || c == '-') {
        return Err(String::new());
    }
    let pieces = Pieces::parse(text).map_err(|e| format!(" ({})", innermost(&e)))?;
    let offset = match pieces.to_numeric_offset() {
        Some(offset) => offset,
        None if pieces.time_zone_annotation().is_some() => {
            return Err(" (a named zone needs its offset beside it, such as +01:00[Europe/Paris])".to_owned());
        }
        None => Offset::UTC,
    };
    let local = pieces.date().to_datetime(pieces.time().unwrap_or(Time::midnight()));
    offset.to_timestamp(local).map_err(|e| format!(" ({})", innermost(&e)))
}

/// The last link of an error's chain: the part that says what is wrong rather than what was being done.
fn innermost(error: &dyn std::error::Error) -> String {
    error.source().map_or_else(|| error.to_string(), innermost)
}

fn not_time(rows: &Rows<'_>, i: usize, reason: String) -> LogError {
    let found = shorten(rows.cell(i).unwrap_or_default());
    LogError::NotTime { place: rows.place(i), column: rows.name(i), found, reason: reason.into() }
}

fn mixed(rows: &Rows<'_>, i: usize, expected: &'static str) -> LogError {
    let found = shorten(rows.cell(i).unwrap_or_default());
    LogError::MixedTimes { place: rows.place(i), column: rows.name(i), found, expected }
}
