//! The `[filter]` table.

use super::{SOUND, error};
use crate::model::family::Fuzzy;
use crate::model::{Adapts, FilterKind, Problem};

#[test]
fn what_adapts_r_needs_a_diagonal_one() {
    let two = |kind: &str| {
        let text = SOUND.replace("[\"z\"]", "[\"z\", \"w\"]").replace("h = [\"p\"]", "h = [\"p\", \"p\"]");
        text.replace("{ z = \"r\" }", "[[\"r\"], [1, \"r\"]]").replace("\"kalman\"", kind)
    };
    for kind in ["sage-husa-r", "fuzzy"] {
        let first = error(&two(&format!("\"{kind}\""))).to_string();
        let expected = format!(
            "p.toml:23:8: `filter.kind`: \"{kind}\" adapts the variance of each measurement by itself and needs a \
             diagonal R: give R as a list of variances"
        );
        assert_eq!(first.lines().next(), Some(expected.as_str()));
    }
    Problem::parse(&two("\"sage-husa\""), "p.toml").unwrap_or_else(|e| panic!("any R goes with an adapted Q: {e}"));
}

#[test]
fn settings_have_the_defaults_of_the_study() {
    let filter = |kind: &str| Problem::parse(&SOUND.replace("\"kalman\"", kind), "p.toml").unwrap().filter;
    let values = |filter: &FilterKind| filter.settings().iter().map(|s| (s.key, s.value(&[]))).collect::<Vec<_>>();
    for (name, expected) in [
        ("kalman", vec![]),
        ("sage-husa", vec![("forgetting", 0.98)]),
        ("sage-husa-r", vec![("forgetting", 0.98), ("floor", 0.01)]),
        ("fuzzy", vec![("gain", 0.1), ("width", 0.5)]),
        ("extended", vec![]),
        ("iterated", vec![]),
        // Two states: kappa is 1, n + kappa 3, and beta + alpha^2 kappa / n 2.5.
        ("unscented", vec![("alpha", 1.0), ("beta", 2.0), ("kappa", 1.0), ("kappa", 3.0), ("beta", 2.5)]),
        ("cubature", vec![]),
    ] {
        let filter = filter(&format!("\"{name}\""));
        assert_eq!((filter.name(), values(&filter)), (name, expected));
        assert_eq!(
            filter.facts().adapts == Adapts::Nothing,
            values(&filter).is_empty() || name == "unscented",
            "{name}"
        );
    }
    assert!(matches!(filter("\"fuzzy\""), FilterKind::Fuzzy(Fuzzy { window: 15, .. })), "fifteen squared innovations");
    // The one of several models needs them.
    for name in FilterKind::NAMES.iter().filter(|name| **name != "imm") {
        assert_eq!(filter(&format!("\"{name}\"")).name(), *name, "every name has its kind");
    }
}
