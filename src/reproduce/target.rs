//! What a reproduction must reach.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::number::short;

/// A limit as it was set.
fn limit(value: f64) -> String {
    let text = short(value, 5);
    if text.contains('e') { format!("{value:e}") } else { text }
}

/// The values that pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Required {
    /// From the first to the second, both included.
    Within(f64, f64),
    /// This or more.
    AtLeast(f64),
    /// More than this.
    Above(f64),
    /// This or less.
    AtMost(f64),
    /// This number exactly; for counts.
    Exactly(u64),
}

impl Required {
    /// Whether a measured value passes; NaN never does.
    #[must_use]
    pub fn admits(self, measured: f64) -> bool {
        match self {
            Self::Within(low, high) => low <= measured && measured <= high,
            Self::AtLeast(limit) => measured >= limit,
            Self::Above(limit) => measured > limit,
            Self::AtMost(limit) => measured <= limit,
            Self::Exactly(count) => measured.total_cmp(&(count as f64)).is_eq(),
        }
    }

    /// The same with room for the larger sampling error of a smaller sample. A count stays as it is.
    #[must_use]
    pub fn widened(self, by: f64) -> Self {
        match self {
            Self::Within(low, high) => Self::Within(low - by, high + by),
            Self::AtLeast(limit) => Self::AtLeast(limit - by),
            Self::Above(limit) => Self::Above(limit - by),
            Self::AtMost(limit) => Self::AtMost(limit + by),
            Self::Exactly(count) => Self::Exactly(count),
        }
    }
}

impl fmt::Display for Required {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within(low, high) => write!(f, "{} to {}", limit(*low), limit(*high)),
            Self::AtLeast(least) => write!(f, ">= {}", limit(*least)),
            Self::Above(least) => write!(f, "> {}", limit(*least)),
            Self::AtMost(most) => write!(f, "<= {}", limit(*most)),
            Self::Exactly(count) => write!(f, "= {count}"),
        }
    }
}

impl Serialize for Required {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One target of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Target {
    /// What is measured.
    pub name: String,
    /// What passes; text such as `>= 29` in JSON.
    pub required: Required,
    /// What was measured.
    pub measured: f64,
    /// Whether it passes.
    pub pass: bool,
}

impl Target {
    /// Judges a measurement.
    #[must_use]
    pub fn new(name: impl Into<String>, required: Required, measured: f64) -> Self {
        Self { name: name.into(), required, measured, pass: required.admits(measured) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_included_and_nan_fails() {
        let cases = [
            (Required::Within(1.0, 2.0), [1.0, 2.0], [0.999, 2.001]),
            (Required::AtLeast(1.0), [1.0, 9.0], [0.999, -1.0]),
            (Required::Above(1.0), [1.001, 9.0], [1.0, 0.0]),
            (Required::AtMost(1.0), [1.0, -9.0], [1.001, 9.0]),
            (Required::Exactly(500), [500.0, 500.0], [499.0, 500.5]),
        ];
        for (required, passing, failing) in cases {
            assert!(passing.iter().all(|x| Target::new("t", required, *x).pass), "{required}");
            assert!(failing.iter().all(|x| !Target::new("t", required, *x).pass), "{required}");
            assert!(!Target::new("t", required, f64::NAN).pass, "{required} and NaN");
        }
    }

    #[test]
    fn in_json_the_requirement_is_text() {
        let target = Target::new("median PIO/PSO", Required::Within(1.08, 1.35).widened(0.05), 1.5);
        let json = serde_json::to_string(&target).expect("numbers and text");
        let expected = r#"{"name":"median PIO/PSO","required":"1.03 to 1.4","measured":1.5,"pass":false}"#;
        assert_eq!(json, expected);
    }
}
