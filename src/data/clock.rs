//! What a time cell means: a number in the log's unit, or an instant, which counts from the log's first row.

use jiff::Timestamp;

use super::decimal::Decimal;
use super::instant::Instant;
use super::rows::shorten;
use super::{LogError, Origin, Rows, TimeUnit};

/// Significant digits that every double keeps.
const KEPT: usize = 15;

/// Reads the time column; its first cell decides which kind of time it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clock {
    unit: TimeUnit,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// No cell read yet.
    Unset,
    /// Numbers, which stay as they are.
    Numbers { first: Option<Decimal>, long: bool },
    /// Numbers of more digits than a double holds: they count from the first.
    Since(Decimal),
    /// Instants count from here.
    Instants(Instant),
}

impl Clock {
    pub(crate) const fn new(unit: TimeUnit) -> Self {
        Self { unit, kind: Kind::Unset }
    }

    /// Time in cell `i` of the current row, in the unit that dt counts.
    ///
    /// When a number turns out to be too long for a double, times of earlier rows are those of another clock: see
    /// [`Self::counts_from_first`].
    pub(crate) fn read(&mut self, rows: &Rows<'_>, i: usize) -> Result<f64, LogError> {
        let text = rows.cell(i)?;
        if Rows::is_missing(text) {
            return Err(LogError::MissingTime { place: rows.place(i), column: rows.name(i) });
        }
        let number = rows.plain(text).filter(|plain| plain.parse::<f64>().is_ok());
        match (number, self.kind) {
            (Some(_), Kind::Instants(_)) => Err(mixed(rows, i, "an ISO-8601 time")),
            (Some(plain), _) => {
                rows.number(i, "every row needs a time")?;
                Ok(self.number(&plain))
            }
            (None, Kind::Unset) => {
                let first = Instant::parse(text).map_err(|reason| not_time(rows, i, reason))?;
                if self.unit.decimals() > 0 {
                    let (place, column) = (rows.place(i), rows.name(i));
                    return Err(LogError::UnitOfInstants { place, column, unit: self.unit.name() });
                }
                self.kind = Kind::Instants(first);
                Ok(0.0)
            }
            (None, Kind::Instants(origin)) => {
                let now = Instant::parse(text).map_err(|reason| not_time(rows, i, reason))?;
                if now.of_day != origin.of_day {
                    let expected = if origin.of_day { "a time of day" } else { "a date" };
                    return Err(mixed(rows, i, expected));
                }
                self.since(origin, now).ok_or_else(|| not_time(rows, i, self.off_calendar(origin)))
            }
            (None, _) if Instant::parse(text).is_ok() => Err(mixed(rows, i, "seconds")),
            (None, _) => Err(not_time(rows, i, String::new())),
        }
    }

    /// The number `text` in the unit that dt counts.
    fn number(&mut self, text: &str) -> f64 {
        let exact = Decimal::parse(text).map(|decimal| decimal.shifted(-self.unit.decimals()));
        let value = match exact {
            Some(exact) if self.unit.decimals() > 0 => exact.to_f64(),
            _ => text.parse::<f64>().unwrap_or(f64::NAN) / 10f64.powi(self.unit.decimals()),
        };
        let is_long = text.bytes().filter(u8::is_ascii_digit).count() > KEPT;
        // A whole number is a count, however long.
        let may_be_noise = is_long && text.contains('.');
        match (&mut self.kind, exact) {
            (Kind::Since(first), exact) => {
                return exact.or_else(|| Decimal::shortest(value)).map_or(value, |exact| difference(exact, *first));
            }
            (Kind::Numbers { first: Some(first), .. }, Some(exact)) if is_long && !exact.is_print_of(value) => {
                if exact.minus(*first).is_some() {
                    let first = *first;
                    self.kind = Kind::Since(first);
                    return difference(exact, first);
                }
            }
            (Kind::Numbers { long, .. }, _) => *long |= may_be_noise,
            (kind @ Kind::Unset, Some(exact)) if is_long && !exact.is_print_of(value) => {
                *kind = Kind::Since(exact);
                return 0.0;
            }
            (kind, first) => *kind = Kind::Numbers { first, long: may_be_noise },
        }
        value
    }

    /// Whether numbers count from the first, which those read before the first long one do not yet.
    pub(crate) const fn counts_from_first(&self) -> bool {
        matches!(self.kind, Kind::Since(_))
    }

    /// Makes a number that was read as it is count from the first.
    pub(super) fn counted_from_first(&self, time: f64) -> f64 {
        match (self.kind, Decimal::shortest(time)) {
            (Kind::Since(first), Some(exact)) => difference(exact, first),
            _ => time,
        }
    }

    /// Whether some number had so many digits that it may be a double's noise.
    pub(super) const fn is_noisy(&self) -> bool {
        matches!(self.kind, Kind::Numbers { long: true, .. })
    }

    /// Makes numbers count from the first; gives whether they can.
    pub(super) fn count_from_first(&mut self) -> bool {
        if let Kind::Numbers { first: Some(first), .. } = self.kind {
            self.kind = Kind::Since(first);
        }
        self.counts_from_first()
    }

    /// Where time 0 is.
    pub(super) fn origin(&self) -> Origin {
        match self.kind {
            Kind::Unset | Kind::Numbers { .. } => Origin::Zero,
            Kind::Since(first) => Origin::Number(first.shifted(self.unit.decimals()).to_string()),
            Kind::Instants(first) if first.of_day => Origin::TimeOfDay(first.at),
            Kind::Instants(first) => Origin::Instant(first.at),
        }
    }

    fn since(self, origin: Instant, now: Instant) -> Option<f64> {
        match self.unit.nanoseconds() {
            // Whole nanoseconds are subtracted before anything is rounded to a double.
            Some(unit) => Some((now.at.as_nanosecond() - origin.at.as_nanosecond()) as f64 / unit),
            None => {
                let months = f64::from(origin.months_to(now)?);
                Some(if self.unit == TimeUnit::Year { months / 12.0 } else { months })
            }
        }
    }

    fn off_calendar(self, origin: Instant) -> String {
        let (unit, day) = (self.unit.name(), origin.date.day());
        format!(" (time_unit = \"{unit}\" counts whole months: expected day {day} of a month, as in the first row)")
    }

    /// A time of this clock as the log writes it, for messages.
    pub(crate) fn show(self, time: f64) -> Box<str> {
        match (self.kind, self.unit.nanoseconds()) {
            (Kind::Instants(origin), Some(unit)) => {
                let nanoseconds = origin.at.as_nanosecond() + (time * unit).round() as i128;
                match Timestamp::from_nanosecond(nanoseconds) {
                    Ok(at) if origin.of_day => at.to_string().trim_start_matches("1970-01-01T").replace('Z', "").into(),
                    Ok(at) => at.to_string().into(),
                    Err(_) => time.to_string().into(),
                }
            }
            (Kind::Instants(_), None) => format!("{time} {}s", self.unit.name()).into(),
            (kind, _) => {
                let shown = Decimal::shortest(time);
                let shown = match kind {
                    Kind::Since(first) => shown.and_then(|time| time.plus(first)),
                    _ => shown,
                };
                shown.map_or_else(|| time.to_string(), |t| t.shifted(self.unit.decimals()).to_string()).into()
            }
        }
    }
}

/// Exactly, then rounded once.
fn difference(time: Decimal, first: Decimal) -> f64 {
    time.minus(first).map_or_else(|| time.to_f64() - first.to_f64(), Decimal::to_f64)
}

fn not_time(rows: &Rows<'_>, i: usize, reason: String) -> LogError {
    let text = rows.cell(i).unwrap_or_default();
    let comma = reason.is_empty() || Rows::has_decimal_comma(text);
    let reason = if comma { rows.advice(text).map_or(reason, |a| format!(" ({a})")) } else { reason };
    LogError::NotTime { place: rows.place(i), column: rows.name(i), found: shorten(text), reason: reason.into() }
}

fn mixed(rows: &Rows<'_>, i: usize, expected: &'static str) -> LogError {
    let found = shorten(rows.cell(i).unwrap_or_default());
    LogError::MixedTimes { place: rows.place(i), column: rows.name(i), found, expected }
}
