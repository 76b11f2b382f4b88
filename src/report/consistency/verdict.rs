//! What the numbers of a filter run say, in words.

use std::fmt;

use serde::Serialize;

use super::evidence::SETTLING;
use super::{Consistency, Whiteness};
use crate::model::{Parameters, Search};
use crate::report::{Bound, short};

/// The judgement on a filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// NIS within its band, white innovations, no parameter at a bound, no heavy tails.
    Consistent,
    /// NIS above its band: the filter trusts itself too much.
    Overconfident,
    /// NIS below its band: the filter trusts itself too little.
    Underconfident,
    /// The innovations predict each other.
    InnovationsCorrelated,
    /// A searched parameter ran to its bound.
    ParameterAtBound,
    /// Large NIS is more frequent than its distribution allows, though the mean is right.
    HeavyTails,
    /// Nothing is wrong so far, but no measurement has innovations enough to tell whether they are white.
    TooFewInnovations,
    /// Nothing was measured.
    NothingMeasured,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Consistent => "consistent",
            Self::Overconfident => "overconfident",
            Self::Underconfident => "underconfident",
            Self::InnovationsCorrelated => "innovations correlated",
            Self::ParameterAtBound => "parameter at its bound",
            Self::HeavyTails => "heavy tails",
            Self::TooFewInnovations => "too few innovations",
            Self::NothingMeasured => "nothing measured",
        })
    }
}

/// One thing that is wrong, or that nothing is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Of which kind.
    pub verdict: Verdict,
    /// What it rests on and what to do.
    pub advice: String,
}

/// Everything that holds, the headline first. NIS comes before correlation, because wrong noise alone makes
/// innovations correlated; only where NIS is right does correlation accuse the model.
pub(super) fn findings(c: &Consistency, parameters: &Parameters, candidate: &[f64]) -> Vec<Finding> {
    if c.nis_mean.is_nan() {
        let advice = "no innovation to judge by (the log has no measurement that updates the filter)".into();
        return vec![Finding { verdict: Verdict::NothingMeasured, advice }];
    }
    let mut found: Vec<Finding> = nis(c).into_iter().chain(correlated(c)).collect();
    let searched = parameters.searched().zip(candidate);
    found.extend(searched.filter_map(|((parameter, search), value)| at_bound(&parameter.name, search, *value)));
    found.extend(heavy_tails(c));
    if found.is_empty() {
        found.push(nothing_wrong(c));
    }
    found
}

/// A filter is not called consistent on a log too short to test whiteness on.
fn nothing_wrong(c: &Consistency) -> Finding {
    let (verdict, advice) = if c.whiteness.iter().any(Whiteness::is_tested) {
        (
            Verdict::Consistent,
            "NIS is within its band, the innovations are white and no parameter is at a bound".to_owned(),
        )
    } else {
        let advice = format!(
            "NIS is within its band and no parameter is at a bound, but {} innovations are too few to tell whether they are \
             white (judge on a longer log)",
            c.components
        );
        (Verdict::TooFewInnovations, advice)
    };
    Finding { verdict, advice }
}

/// The lag that shows the correlation best to a reader: the first, or the strongest where the first is in its band.
fn telling(w: &Whiteness) -> (usize, f64) {
    let lags = (1..).zip(w.autocorrelation.iter().copied());
    let strongest = lags.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or((1, w.lag_1()));
    if w.lag_1().abs() > w.band { (1, w.lag_1()) } else { strongest }
}

fn correlated(c: &Consistency) -> Option<Finding> {
    let names: Vec<_> = c
        .whiteness
        .iter()
        .filter(|w| w.correlated)
        .map(|w| {
            let (lag, r) = telling(w);
            format!("{} (lag {lag}: {r:+.2})", w.measurement)
        })
        .collect();
    let cause = if nis(c).is_some() {
        "either the noise alone is wrong or the model too (tune first; if they stay correlated, change the model)"
    } else {
        "the model, not only the noise, is wrong (try a model of higher order, a bias state or coloured noise; if \
         nothing was tuned yet, tune first)"
    };
    (!names.is_empty()).then(|| Finding {
        verdict: Verdict::InnovationsCorrelated,
        advice: format!("innovations of {} predict each other: {cause}", names.join(", ")),
    })
}

fn nis(c: &Consistency) -> Option<Finding> {
    let (mean, low, high) = (c.nis_mean, c.nis_low, c.nis_high);
    let (verdict, side, size) = if mean > high {
        (Verdict::Overconfident, "above", "small")
    } else if mean < low {
        (Verdict::Underconfident, "below", "large")
    } else {
        return None;
    };
    // The band of the whole log is the narrower one, so a later mean inside it is inside its own.
    let cause = if low <= c.nis_settled && c.nis_settled <= high {
        format!(
            "it comes from the first {SETTLING} measured rows (mean {:.3} after them), so P0 is too {size} for this x0, \
             and Q and R fit",
            c.nis_settled
        )
    } else {
        format!("P0, Q or R is too {size} for the errors that occur")
    };
    Some(Finding {
        verdict,
        advice: format!("mean NIS {} is {side} its 95 % band {low:.3}..{high:.3}: {cause}", short(mean, 4)),
    })
}

/// Only where the mean is right: a wrong mean moves the tails too.
fn heavy_tails(c: &Consistency) -> Option<Finding> {
    let tails = c.nis_distribution.as_ref().filter(|d| d.has_heavy_tails() && nis(c).is_none())?;
    let (share, high) = (100.0 * tails.above_99, 100.0 * tails.above_99_high);
    let advice = format!(
        "{share:.1} % of rows are above the 99 % quantile of their NIS, at most {high:.1} % should be, though its mean is \
         right: the noise has outliers or changes with time (look at the rows of largest NIS)"
    );
    Some(Finding { verdict: Verdict::HeavyTails, advice })
}

fn at_bound(name: &str, search: &Search, value: f64) -> Option<Finding> {
    let side = Bound::of(search, value)?;
    let bound = side.value(search);
    let advice = format!(
        "{name} = {value:.4e} is at its {side} bound {bound}: the optimum lies beyond it, or the model does not need it \
         (widen the bound; if it runs on, change the model)"
    );
    Some(Finding { verdict: Verdict::ParameterAtBound, advice })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Scale;

    fn bound(min: f64, max: f64, scale: Scale, value: f64) -> Option<String> {
        let search = Search { min, max, scale, init: [1.0, 2.0], start: None };
        at_bound("r", &search, value).map(|f| f.advice)
    }

    #[test]
    fn a_correlation_is_shown_at_a_lag_that_shows_it() {
        let lag = |autocorrelation: &[f64]| {
            let autocorrelation = autocorrelation.to_vec();
            let (measurement, band) = ("z".to_owned(), 0.14);
            let w = Whiteness {
                measurement,
                count: 200,
                autocorrelation,
                band,
                ljung_box: 50.0,
                p_value: 1e-3,
                correlated: true,
            };
            telling(&w)
        };
        assert_eq!(lag(&[0.25, -0.5, 0.1]), (1, 0.25), "the first, where it is out of its band");
        assert_eq!(lag(&[0.09, -0.05, -0.3]), (3, -0.3), "the strongest, where it is not");
    }

    #[test]
    fn bounds_are_near_on_the_scale_of_the_parameter() {
        let near = |scale, value, side: &str| {
            let advice = bound(1e-3, 1e3, scale, value).unwrap_or_default();
            assert!(advice.contains(side), "{value}: {advice:?} should name the {side} bound");
        };
        near(Scale::Log, 1.01e-3, "lower");
        near(Scale::Log, 0.99e3, "upper");
        near(Scale::Linear, 0.5, "lower");
        assert_eq!(bound(1e-3, 1e3, Scale::Log, 0.5), None, "the middle of a log range");
        assert_eq!(bound(1e-3, 1e3, Scale::Linear, 500.0), None, "the middle of a linear range");
        assert_eq!(bound(f64::NEG_INFINITY, f64::INFINITY, Scale::Linear, 0.0), None, "no bounds");
    }
}
