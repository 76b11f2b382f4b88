//! Ticks of an axis of instants: whole seconds, minutes, hours, days, months and years, in UTC.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime};
use jiff::tz::Offset;

use super::axis::Scale;

const MINUTE: i64 = 60;
const HOUR: i64 = 60 * MINUTE;
const DAY: i64 = 24 * HOUR;

/// Steps of a fixed length \[s\].
const SECONDS: [i64; 20] = [
    1,
    2,
    5,
    10,
    15,
    30,
    MINUTE,
    2 * MINUTE,
    5 * MINUTE,
    10 * MINUTE,
    15 * MINUTE,
    30 * MINUTE,
    HOUR,
    2 * HOUR,
    3 * HOUR,
    6 * HOUR,
    12 * HOUR,
    DAY,
    2 * DAY,
    5 * DAY,
];
/// Steps of months.
const MONTHS: [i64; 11] = [1, 2, 3, 6, 12, 24, 60, 120, 240, 600, 1200];

/// Places with labels, and the name of the axis; `None` where the range is not one of dates, or less than three seconds.
pub(super) fn ticks(
    name: &str,
    [zero, unit]: [f64; 2],
    scale: Scale,
    most: usize,
) -> Option<(Vec<(f64, String)>, String)> {
    let [low, high] = [zero + unit * scale.low, zero + unit * scale.high];
    let [first, last] = [date(low)?, date(high)?];
    if high - low < 3.0 {
        return None;
    }
    let share = |at: i64| scale.share((at as f64 - zero) / unit);
    let fits = |count: f64| count <= most.max(1) as f64;
    if let Some(step) = SECONDS.into_iter().find(|step| fits((high - low) / *step as f64)) {
        let from = (low / step as f64).ceil() as i64;
        let instants = (from..=(high / step as f64).floor() as i64).map(|k| k * step);
        let places = instants.filter_map(|at| Some((share(at)?, clock(date(at as f64)?, step)))).collect();
        let named = if step < DAY { format!("{name} from {} [UTC]", first.date()) } else { format!("{name} [UTC]") };
        return Some((places, named));
    }
    let month = |at: DateTime| 12 * i64::from(at.year()) + i64::from(at.month()) - 1;
    let between = (month(last) - month(first)) as f64;
    let step = MONTHS.into_iter().find(|step| fits(between / *step as f64)).unwrap_or(1200);
    let from = month(first).div_euclid(step);
    let months = (from..=month(last).div_euclid(step)).map(|k| k * step);
    let place = |month: i64| {
        let year = i16::try_from(month.div_euclid(12)).ok()?;
        let day = Date::new(year, i8::try_from(month.rem_euclid(12) + 1).ok()?, 1).ok()?;
        let at = Offset::UTC.to_timestamp(day.to_datetime(jiff::civil::Time::midnight())).ok()?.as_second();
        let label = if step < 12 { format!("{year:04}-{:02}", day.month()) } else { format!("{year:04}") };
        let inside = (low..=high).contains(&(at as f64));
        Some((share(at).filter(|_| inside)?, label))
    };
    Some((months.filter_map(place).collect(), format!("{name} [UTC]")))
}

fn date(unix: f64) -> Option<DateTime> {
    // Beyond what a calendar holds, `from_second` refuses.
    Timestamp::from_second(unix.floor() as i64).ok().map(|at| Offset::UTC.to_datetime(at))
}

/// A time of day, at midnight the date, with no more than the step needs.
fn clock(at: DateTime, step: i64) -> String {
    match (at.hour(), at.minute(), at.second()) {
        (0, 0, 0) => at.date().to_string(),
        (hour, minute, second) if step < MINUTE => format!("{hour:02}:{minute:02}:{second:02}"),
        (hour, minute, _) => format!("{hour:02}:{minute:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::Axis;

    fn labels(from: &str, seconds: f64, most: usize) -> (String, String) {
        let zero = from.parse::<Timestamp>().unwrap().as_second() as f64;
        let scale = Axis::new("t").range(0.0, seconds).scale(std::iter::empty(), 0.0).unwrap();
        let (places, name) = ticks("time", [zero, 1.0], scale, most).expect("dates");
        assert!(places.iter().all(|(place, _)| (0.0..=1.0).contains(place)), "{places:?}");
        (places.into_iter().map(|(_, label)| label).collect::<Vec<_>>().join(" "), name)
    }

    #[test]
    fn instants_have_round_ticks() {
        let cases = [
            (
                "2024-03-05T10:14:50Z",
                40.0,
                5,
                "10:14:50 10:15:00 10:15:10 10:15:20 10:15:30",
                "time from 2024-03-05 [UTC]",
            ),
            ("2024-02-28T20:00:00Z", 43_200.0, 5, "21:00 2024-02-29 03:00 06:00", "time from 2024-02-28 [UTC]"),
            ("2024-02-27T12:00:00Z", 3.0 * 86_400.0, 4, "2024-02-28 2024-02-29 2024-03-01", "time [UTC]"),
            ("2023-11-15T00:00:00Z", 200.0 * 86_400.0, 5, "2024-01 2024-03 2024-05", "time [UTC]"),
            ("1871-06-01T00:00:00Z", 99.0 * 365.25 * 86_400.0, 6, "1880 1900 1920 1940 1960", "time [UTC]"),
        ];
        for (from, seconds, most, expected, named) in cases {
            assert_eq!(labels(from, seconds, most), (expected.to_owned(), named.to_owned()), "{from}");
        }
    }

    #[test]
    fn what_is_no_date_is_left_to_numbers() {
        let scale = Axis::new("t").range(0.0, 1e20).scale(std::iter::empty(), 0.0).unwrap();
        assert_eq!(ticks("time", [1.7e9, 1.0], scale, 5), None);
        let scale = Axis::new("t").range(0.0, 0.5).scale(std::iter::empty(), 0.0).unwrap();
        assert_eq!(ticks("time", [1.7e9, 1.0], scale, 5), None, "half a second");
    }
}
