//! Instants as people write them: ISO-8601, dates in an order that cannot be mistaken, and clock times of a day.

use jiff::Timestamp;
use jiff::civil::{Date, Time};
use jiff::fmt::temporal::Pieces;
use jiff::tz::Offset;

/// An instant, and the date that it was written with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instant {
    pub(super) at: Timestamp,
    pub(super) date: Date,
    /// A clock time without a date, taken to be of 1970-01-01.
    pub(super) of_day: bool,
}

impl Instant {
    /// Without a zone it is UTC, without a time of day it is midnight.
    ///
    /// # Errors
    /// Why it is none, as the end of a sentence: empty, or in parentheses.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        if !text.starts_with(|c: char| c.is_ascii_digit() || c == '+' || c == '-') {
            return Err(stamp_pair(text).unwrap_or_default());
        }
        if let Some(time) = time_of_day(text)? {
            let date = Date::constant(1970, 1, 1);
            let at = Offset::UTC.to_timestamp(date.to_datetime(time)).map_err(reason)?;
            return Ok(Self { at, date, of_day: true });
        }
        let text = ordered(text)?;
        let pieces = Pieces::parse(text.as_str()).map_err(reason)?;
        let offset = match pieces.to_numeric_offset() {
            Some(offset) => offset,
            None if pieces.time_zone_annotation().is_some() => {
                return Err(" (a named zone needs its offset beside it, such as +01:00[Europe/Paris])".to_owned());
            }
            None => Offset::UTC,
        };
        let date = pieces.date();
        let at = offset.to_timestamp(date.to_datetime(pieces.time().unwrap_or(Time::midnight()))).map_err(reason)?;
        Ok(Self { at, date, of_day: false })
    }

    /// Calendar months from `self` to `later`; `None` unless both are on one day of the month, or where months end.
    pub(super) fn months_to(self, later: Self) -> Option<i32> {
        let (a, b) = (self.date, later.date);
        let ends = |date: Date| date.day() == date.days_in_month();
        let same = a.day() == b.day() || (ends(b) && (ends(a) || a.day() > b.day()));
        same.then(|| 12 * i32::from(b.year() - a.year()) + i32::from(b.month() - a.month()))
    }
}

/// Why a text is no instant, as [`Instant::parse`] says it; `None` where it is one.
pub(crate) fn no_instant(text: &str) -> Option<String> {
    Instant::parse(text).err()
}

/// Whether a text has the shape of a date or a clock time, readable or not.
pub(crate) fn looks_like_an_instant(text: &str) -> bool {
    let digits = |part: &str| (1..=4).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_digit());
    let date: Vec<&str> = text.split(['T', ' ']).next().unwrap_or_default().split(['-', '/', '.']).collect();
    let mut fields = text.split(':');
    let timed = fields.next().is_some_and(|hour| hour.ends_with(|c: char| c.is_ascii_digit()))
        && fields.next().is_some_and(|minute| minute.starts_with(|c: char| c.is_ascii_digit()));
    let starts = text.starts_with(|c: char| c.is_ascii_digit());
    starts && (timed || (date.len() == 3 && date.iter().all(|part| digits(part))))
}

/// `hh:mm:ss` with a fraction perhaps; `None` where it has another shape.
fn time_of_day(text: &str) -> Result<Option<Time>, String> {
    let fields: Vec<&str> = text.split(':').collect();
    let digits = |field: &&str| !field.is_empty() && field.bytes().all(|b| b.is_ascii_digit());
    let Some((last, first)) = fields.split_last().filter(|(_, first)| first.iter().all(digits)) else {
        return Ok(None);
    };
    let fraction = last.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b','));
    match first {
        [_] if fraction => Err(" (hours and minutes, or minutes and seconds? write hh:mm:ss)".to_owned()),
        [hour, _] if fraction => {
            let zero = if hour.len() == 1 { "0" } else { "" };
            format!("{zero}{text}").parse::<Time>().map(Some).map_err(reason)
        }
        _ => Ok(None),
    }
}

/// A date as ISO-8601 writes it: `2024/05/03` and `03.05.2024` can be meant in one way only, `03/05/2024` cannot.
fn ordered(text: &str) -> Result<String, String> {
    let end = text.find(['T', 't', ' ']).unwrap_or(text.len());
    let (date, rest) = text.split_at(end);
    let Some(mark) = date.chars().find(|c| matches!(c, '/' | '.' | '-')) else { return Ok(text.to_owned()) };
    let parts: Vec<&str> = date.split(mark).collect();
    let [a, b, c] = parts[..] else { return Ok(text.to_owned()) };
    let is_day = |part: &str| matches!(part.len(), 1 | 2) && part.bytes().all(|b| b.is_ascii_digit());
    let is_year = |part: &str| part.len() == 4 && part.bytes().all(|b| b.is_ascii_digit());
    match mark {
        '/' | '.' if is_year(a) && is_day(b) && is_day(c) => Ok(format!("{a}-{b:0>2}-{c:0>2}{rest}")),
        '.' if is_day(a) && is_day(b) && is_year(c) => Ok(format!("{c}-{b:0>2}-{a:0>2}{rest}")),
        _ if is_day(a) && is_day(b) && matches!(c.len(), 2 | 4) => {
            Err(" (day and month, or month and day? write dates as 2024-12-31)".to_owned())
        }
        _ => Ok(text.to_owned()),
    }
}

/// The remedy for `[sec,nanosec]`, as robots log it.
fn stamp_pair(text: &str) -> Option<String> {
    let inner = text.strip_prefix(['[', '('])?.strip_suffix([']', ')'])?;
    let (seconds, nanoseconds) = inner.split_once([',', ';', ' '])?;
    let (seconds, nanoseconds) = (seconds.trim(), nanoseconds.trim());
    let digits = |text: &str| (1..=12).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    (digits(seconds) && digits(nanoseconds) && nanoseconds.len() <= 9)
        .then(|| format!(" (seconds and nanoseconds? write them as one number, {seconds}.{nanoseconds:0>9})"))
}

/// What is wrong rather than what was being done: the last link of an error's chain.
fn reason(error: jiff::Error) -> String {
    fn innermost(error: &dyn std::error::Error) -> String {
        error.source().map_or_else(|| error.to_string(), innermost)
    }
    format!(" ({})", innermost(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_that_mean_one_thing_are_read() {
        let of = |text: &str| Instant::parse(text).map(|i| i.at.to_string());
        for text in [
            "2024-05-03T10:15:00Z",
            "2024/05/03 10:15:00",
            "03.05.2024 10:15",
            "3.5.2024 10:15:00.0",
            "2024.05.03 10:15",
        ] {
            assert_eq!(of(text).as_deref(), Ok("2024-05-03T10:15:00Z"), "{text}");
        }
        assert_eq!(of("10:15:01.2").as_deref(), Ok("1970-01-01T10:15:01.2Z"));
        assert_eq!(of("9:05:00").as_deref(), Ok("1970-01-01T09:05:00Z"));
    }

    #[test]
    fn what_could_mean_two_things_is_refused_with_both() {
        for text in ["03/05/2024 10:15", "13/05/2024", "5/3/24 1:15 PM", "03-05-2024"] {
            let refused = Instant::parse(text).unwrap_err();
            assert_eq!(refused, " (day and month, or month and day? write dates as 2024-12-31)", "{text}");
        }
        assert!(Instant::parse("10:15").unwrap_err().contains("write hh:mm:ss"));
        assert_eq!(
            Instant::parse("[1784900000,46481370]").unwrap_err(),
            " (seconds and nanoseconds? write them as one number, 1784900000.046481370)"
        );
        assert!(Instant::parse("25:00:00").is_err() && Instant::parse("noon").is_err());
    }

    #[test]
    fn months_count_by_the_calendar() {
        let months = |a: &str, b: &str| Instant::parse(a).unwrap().months_to(Instant::parse(b).unwrap());
        assert_eq!(months("2024-01-01", "2025-03-01"), Some(14));
        assert_eq!(months("2024-01-31", "2024-02-29"), Some(1));
        assert_eq!(months("2024-02-29", "2024-03-31"), Some(1));
        assert_eq!(months("2024-01-30", "2023-02-28"), Some(-11));
        assert_eq!(months("2024-01-01", "2024-01-15"), None);
    }

    #[test]
    fn shapes() {
        for text in ["10:15:01.2", "03/05/2024 10:15", "2024-05-03", "3.5.2024", "2024-05-03T10:15:00+02:00", "10:15"] {
            assert!(looks_like_an_instant(text), "{text}");
        }
        for text in ["12.5", "-3", "1e-3", "A-1", "hot", "", "192.168.1.12345", "1,234.5"] {
            assert!(!looks_like_an_instant(text), "{text}");
        }
    }
}
