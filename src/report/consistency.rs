//! Whether a filter can be trusted: NIS and its distribution, whiteness of the innovations, parameters at their bounds,
//! and how well the log determines them.
//!
//! Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4.
//! A mean NIS of 1 alone proves little: a search can reach it with a wrong model by inflating one noise against
//! another, which is when the innovations are correlated and a parameter runs to its bound; or by too much in one part of
//! the log that makes up for too little in another. So a verdict rests on a family of tests ([`TestKind`]).

mod band;
mod curvature;
mod distribution;
mod dominating;
mod evidence;
mod family;
mod findings;
mod mean;
mod modes;
mod over_time;
mod place;
mod portmanteau;
mod rejected;
mod rows;
mod sensors;
mod uncertainty;
mod verdict;
mod whiteness;

use std::fmt;

use serde::Serialize;

use crate::number::short;
use crate::report::document::{Part, Section};

pub(super) use band::Band;
pub use distribution::NisDistribution;
pub use dominating::DominatingRow;
pub use evidence::Evidence;
pub use family::{JOINT_LEVEL, Test, TestKind};
pub use modes::ModeUse;
pub use over_time::{NisOverTime, NisSpan};
pub use place::Place;
pub use rejected::Rejected;
pub use sensors::SensorNis;
pub use uncertainty::{FlatDirection, Uncertainty};
pub use verdict::{Finding, Verdict};
pub use whiteness::Whiteness;
pub(super) use whiteness::normalised;

/// The consistency of one filter run. Means are per degree of freedom: 1 is ideal, NaN (JSON `null`) is no data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Consistency {
    /// Sum of NIS / number of present components.
    pub nis_mean: f64,
    /// Lower end of its two-sided 95 % chi-square band.
    pub nis_low: f64,
    /// Upper end.
    pub nis_high: f64,
    /// Mean NIS of the first 20 measured rows of each trajectory.
    pub nis_first: f64,
    /// Mean NIS without them, which tells a wrong P0 from wrong Q and R.
    pub nis_settled: f64,
    /// Number of present components.
    pub components: usize,
    /// One entry per sensor, where a problem has several; else none, and left out of JSON.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorNis>,
    /// Measured rows of each trajectory that are left out of what follows: 20 where they are to blame, else 0.
    pub judged_after: usize,
    /// Headline of [`Self::findings`].
    pub verdict: Verdict,
    /// Everything that holds, the headline first; never empty.
    pub findings: Vec<Finding>,
    /// The tests that it rests on, beside the bounds of parameters.
    pub tests: Vec<Test>,
    /// NIS of single rows; `None` without measurements.
    pub nis_distribution: Option<NisDistribution>,
    /// NIS of one part of the log after the other; `None` where there is too little to part.
    pub nis_over_time: Option<NisOverTime>,
    /// Rows that carry the sum of NIS, the largest first, at most 20; mostly none.
    pub dominating_rows: Vec<DominatingRow>,
    /// One entry per measurement.
    pub whiteness: Vec<Whiteness>,
    /// NEES, where truth of all states is there.
    pub nees: Option<Nees>,
    /// How much the filter made of each of its models; empty for a filter of one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<ModeUse>,
    /// What robust updates left out. All that stands above but NEES is of the other rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejected: Option<Rejected>,
    /// Standard errors and flat directions, for the winner of a study; else null.
    #[serde(flatten)]
    pub uncertainty: Uncertainty,
}

/// Normalised estimation error squared over a run. It informs and does not decide: state errors of neighbouring rows
/// are correlated, so over one run its mean scatters more than the band says.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Nees {
    /// Sum of NEES / (n x rows with truth of all states).
    pub nees_mean: f64,
    /// Lower end of the 95 % chi-square band for independent rows.
    pub nees_low: f64,
    /// Upper end.
    pub nees_high: f64,
    /// Rows with truth of all states.
    pub rows: usize,
}

impl Consistency {
    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        self.verdict == Verdict::Consistent
    }
}

impl Consistency {
    /// All that is said of it: the verdict, what was measured, what is wrong, and how well parameters are determined.
    pub(super) fn under(&self, section: Section) -> Section {
        let mut items = self.measured();
        items.extend(self.findings.iter().map(|found| (format!("{}:", found.verdict), found.advice.clone())));
        items.extend(self.uncertainty.items());
        section.with(self.verdict.to_string()).with(Part::List(items))
    }

    fn measured(&self) -> Vec<(String, String)> {
        let Self { nis_mean, nis_low, nis_high, components, .. } = self;
        let nis = format!("{}  (95 % band {nis_low:.3}..{nis_high:.3}, {components} components)", short(*nis_mean, 4));
        let nees = self.nees.map(|Nees { nees_mean, nees_low, nees_high, rows }| {
            let mean = short(nees_mean, 4);
            format!("{mean}  (95 % band of independent rows {nees_low:.3}..{nees_high:.3}, {rows} rows)")
        });
        let tails = self.nis_distribution.as_ref().map(|d| {
            let [share, low, high] = [d.above_95, d.above_95_low, d.above_95_high].map(|share| 100.0 * share);
            format!("{share:.1} % of rows above their 95 % quantile of NIS (band {low:.1}..{high:.1} %)")
        });
        let rejected = self.rejected.map(|rejected| rejected.to_string());
        let white = self.whiteness.iter().map(|w| ("white", Some(w.to_string())));
        let sensors = self.sensors.iter().map(|sensor| ("sensor", Some(sensor.to_string())));
        let modes = modes::sentences(&self.modes).map(|(label, sentence)| (label, Some(sentence)));
        let facts = [("NIS", Some(nis))].into_iter().chain(sensors);
        let facts = facts.chain([("NEES", nees), ("tails", tails), ("rejected", rejected)]).chain(white).chain(modes);
        facts.filter_map(|(label, fact)| Some((label.to_owned(), fact?))).collect()
    }
}

impl fmt::Display for Consistency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.under(Section::untitled("")).text())
    }
}
