//! What the name of a column tells.

use crate::data::TimeUnit;

const TIMES: &[&str] = &[
    "t",
    "time",
    "timestamp",
    "stamp",
    "date",
    "datetime",
    "utc",
    "year",
    "sec",
    "secs",
    "second",
    "seconds",
    "epoch_time",
    "clock",
    "zeit",
    "uhrzeit",
    "zeitstempel",
    "datum",
    "temps",
    "heure",
    "tiempo",
    "fecha",
    "tijd",
];
/// Words beside those that make them no other thing.
const BESIDE: &[&str] =
    &["header", "field", "log", "local", "gps", "gnss", "ros", "unix", "epoch", "sensor", "utc", "date"];
const TRAJECTORIES: [&str; 10] =
    ["id", "track", "track_id", "trackid", "trajectory", "run", "run_id", "target", "target_id", "realisation"];
/// Row counters: never measured, but good enough as time where nothing better increases.
const COUNTERS: [&str; 7] = ["index", "frame", "step", "row", "seq", "sample", "epoch"];
/// What is commanded or drives the motion, by the beginning of a word.
const INPUTS: &[&str] = &[
    "throttle", "steer", "pwm", "duty", "cmd", "command", "control", "setpoint", "thrust", "torque", "brake", "wheel",
    "current", "ampere", "amps", "motor",
];
/// What drives one system and is measured of another.
const PERHAPS_INPUTS: &[&str] = &["voltage", "volt", "rpm"];

/// How sure it is that a column of this name is an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Input {
    No,
    Perhaps,
    Likely,
}

/// Whether a column of this name tells trajectories apart.
pub(super) fn names_a_trajectory(name: &str) -> bool {
    TRAJECTORIES.contains(&name.to_lowercase().as_str())
}

/// `t`, `stamp_us`, `time [ms]`, `header.stamp`, `logTimestamp`, but not `time_of_flight` or `t_room`.
pub(super) fn names_a_time(name: &str) -> bool {
    let words: Vec<String> =
        words(name).into_iter().filter(|word| unit_of_time(word).is_none() || is_time(word)).collect();
    if words.iter().any(|word| is_stamp(word)) {
        return true;
    }
    let rest = words.iter().filter(|word| !is_time(word));
    words.iter().any(|word| is_time(word)) && rest.clone().all(|word| BESIDE.contains(&word.as_str()))
}

fn is_time(word: &str) -> bool {
    TIMES.contains(&word) || is_stamp(word)
}

/// A word that no other makes another thing.
fn is_stamp(word: &str) -> bool {
    word.ends_with("timestamp") || word.ends_with("datetime")
}

pub(super) fn names_a_counter(name: &str) -> bool {
    COUNTERS.contains(&name.to_lowercase().as_str())
}

/// Names that say outright that they are measured: `z`, `z0`, `zx`, `meas_x`, `obs_1`.
pub(super) fn names_a_measurement(name: &str) -> bool {
    let name = name.to_lowercase();
    (name.starts_with('z') && name.len() <= 3) || name.contains("meas") || name.starts_with("obs")
}

pub(super) fn names_an_input(name: &str) -> Input {
    let words = words(name);
    let any = |known: &[&str]| words.iter().any(|word| known.iter().any(|start| word.starts_with(start)));
    match () {
        () if any(INPUTS) => Input::Likely,
        () if any(PERHAPS_INPUTS) => Input::Perhaps,
        () => Input::No,
    }
}

/// Whether it is a latitude (true), a longitude (false), or neither.
pub(super) fn names_an_angle_on_earth(name: &str) -> Option<bool> {
    words(name).iter().find_map(|word| match word.as_str() {
        "lat" | "latitude" => Some(true),
        "lon" | "lng" | "long" | "longitude" => Some(false),
        _ => None,
    })
}

/// The unit that a name ends with in brackets: `alt (m)`, `Zeit [s]`.
pub(super) fn unit_in(name: &str) -> Option<&str> {
    let inner = name.trim_end().strip_suffix([')', ']'])?;
    let start = inner.rfind(['(', '['])?;
    let unit = inner[start + 1..].trim();
    (start > 0 && (1..=12).contains(&unit.chars().count())).then_some(unit)
}

/// The unit of a time column by its name: `[ms]`, `t_us`, `timestamp_ns`, `year`.
pub(super) fn unit_of_time_column(name: &str) -> Option<TimeUnit> {
    let bracketed = unit_in(name).and_then(|unit| unit_of_time(&unit.to_lowercase()));
    bracketed.or_else(|| {
        let words = words(name);
        let (last, before) = words.split_last()?;
        let spelled = matches!(
            last.as_str(),
            "year" | "years" | "month" | "months" | "day" | "days" | "hour" | "hours" | "minute" | "minutes"
        );
        unit_of_time(last).filter(|_| spelled || !before.is_empty())
    })
}

/// A unit of time as people write it. Not `m`, which is metres.
pub(super) fn unit_of_time(word: &str) -> Option<TimeUnit> {
    Some(match word {
        "s" | "sec" | "secs" | "second" | "seconds" => TimeUnit::Second,
        "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => TimeUnit::Millisecond,
        "us" | "µs" | "μs" | "usec" | "usecs" | "micros" | "microsecond" | "microseconds" => TimeUnit::Microsecond,
        "ns" | "nsec" | "nsecs" | "nanos" | "nanosecond" | "nanoseconds" => TimeUnit::Nanosecond,
        "min" | "mins" | "minute" | "minutes" => TimeUnit::Minute,
        "h" | "hr" | "hrs" | "hour" | "hours" => TimeUnit::Hour,
        "d" | "day" | "days" => TimeUnit::Day,
        "month" | "months" => TimeUnit::Month,
        "year" | "years" | "yr" => TimeUnit::Year,
        _ => return None,
    })
}

/// Lower-case words: parted by what is no letter, and where a capital follows a small letter.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for c in name.chars() {
        if !c.is_alphabetic() || (c.is_uppercase() && was_small) {
            words.push(String::new());
        }
        if c.is_alphabetic() {
            words.last_mut().unwrap_or(&mut String::new()).extend(c.to_lowercase());
        }
        was_small = c.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times() {
        for name in [
            "t",
            "t_s",
            "T",
            "time",
            "Time (s)",
            "stamp_us",
            "timestamp_ms",
            "t_us",
            "Zeit [s]",
            "header.stamp",
            "%time",
            "rosbagTimestamp",
            "date",
            "Date",
            "UTC time",
            "time_sec",
            "year",
            "gps_time",
            "Seconds",
        ] {
            assert!(names_a_time(name), "{name}");
        }
        for name in
            ["time_of_flight", "t_room", "temp", "timer", "travel time", "us", "ms", "min", "h", "x", "T1 (K)", "epoch"]
        {
            assert!(!names_a_time(name), "{name}");
        }
    }

    #[test]
    fn units() {
        use TimeUnit::{Hour, Microsecond, Millisecond, Minute, Nanosecond, Second, Year};
        for (name, unit) in [
            ("timestamp_ms", Some(Millisecond)),
            ("stamp_ns", Some(Nanosecond)),
            ("t_us", Some(Microsecond)),
            ("time [ms]", Some(Millisecond)),
            ("t (µs)", Some(Microsecond)),
            ("Zeit [s]", Some(Second)),
            ("t_min", Some(Minute)),
            ("time_h", Some(Hour)),
            ("year", Some(Year)),
            ("time", None),
            ("t", None),
        ] {
            assert_eq!(unit_of_time_column(name), unit, "{name}");
        }
        assert_eq!((unit_in("alt (m)"), unit_in("(m)"), unit_in("alt")), (Some("m"), None, None));
    }

    #[test]
    fn inputs_and_angles() {
        assert_eq!(names_an_input("wheel_left"), Input::Likely);
        assert_eq!(names_an_input("steeringAngle"), Input::Likely);
        assert_eq!(names_an_input("Voltage [V]"), Input::Perhaps);
        for name in ["x", "u", "temp", "alt", "pos_x", "concurrent"] {
            assert_eq!(names_an_input(name), Input::No, "{name}");
        }
        assert_eq!(names_an_angle_on_earth("GPS Latitude"), Some(true));
        assert_eq!(names_an_angle_on_earth("lon"), Some(false));
        assert_eq!(names_an_angle_on_earth("plateau"), None);
    }
}
