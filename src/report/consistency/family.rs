//! The tests that a verdict rests on, as one family: how often all of them together accuse a right filter.

use serde::Serialize;

use crate::report::short;

/// The share of right filters that all tests together may accuse. By Bonferroni's inequality it is at most the sum of
/// the levels below, whatever the tests have in common (`right_filters_are_seldom_accused`).
pub const JOINT_LEVEL: f64 = 0.04;

/// One test of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TestKind {
    /// The first measured rows of each trajectory have the NIS of a right start.
    FirstRows,
    /// The mean NIS is 1.
    MeanNis,
    /// It is the same at all times.
    NisOverTime,
    /// No single row carries it.
    DominatingRows,
    /// Large NIS is as frequent as it should be.
    Tails,
    /// NIS of single rows has its chi-square distribution.
    NisDistribution,
    /// Innovations do not predict each other; one test a measurement.
    Whiteness,
}

impl TestKind {
    /// Every test with its share of [`JOINT_LEVEL`].
    pub const ALL: [(Self, f64); 7] = [
        (Self::FirstRows, 0.004),
        (Self::MeanNis, 0.01),
        (Self::NisOverTime, 0.005),
        (Self::DominatingRows, 0.003),
        (Self::Tails, 0.004),
        (Self::NisDistribution, 0.004),
        (Self::Whiteness, 0.01),
    ];

    /// The share of right filters that this test may accuse.
    #[must_use]
    pub fn level(self) -> f64 {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or(0.0, |(_, level)| *level)
    }
}

/// What one test found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Test {
    /// Which one.
    pub kind: TestKind,
    /// What is measured, for a table.
    pub name: String,
    /// The measured number.
    pub measured: f64,
    /// What it has to be.
    pub required: String,
    /// Probability of something as odd or odder if the filter is right.
    pub p_value: f64,
    /// The test rejects below this.
    pub level: f64,
    /// Whether it is met: the p-value is not below the level, or what is measured is too small to matter.
    pub pass: bool,
}

impl Test {
    /// A test at its whole level; something significant counts where it `matters` too, by the `limit` that says from
    /// where on.
    pub(super) fn of(
        kind: TestKind,
        (name, measured): (&str, f64),
        p_value: f64,
        (matters, limit): (bool, &str),
    ) -> Self {
        Self::among(1.0, kind, (name, measured), p_value, (matters, limit))
    }

    /// One of so many tests that share the level of their kind.
    pub(super) fn among(
        tests: f64,
        kind: TestKind,
        (name, measured): (&str, f64),
        p_value: f64,
        (matters, limit): (bool, &str),
    ) -> Self {
        let level = kind.level() / tests;
        let required = format!("{limit}, or p of at least {} (is {p_value:.1e})", short(level, 3));
        Self { kind, name: name.to_owned(), measured, required, p_value, level, pass: !(matters && p_value < level) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_add_up_to_the_joint_one() {
        let sum: f64 = TestKind::ALL.iter().map(|(_, level)| level).sum();
        assert!((sum - JOINT_LEVEL).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn what_is_significant_has_to_matter_too() {
        let pass = |p, matters| Test::of(TestKind::Tails, ("share", 0.1), p, (matters, "below 0.2")).pass;
        assert!(!pass(1e-9, true) && pass(1e-9, false) && pass(0.1, true) && pass(f64::NAN, true));
    }
}
