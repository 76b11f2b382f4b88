//! What the numbers of a filter run say, in words.

use super::rows::SETTLING;
use super::{
    Consistency, DominatingRow, Finding, JOINT_LEVEL, NisDistribution, NisOverTime, Test, TestKind, Verdict, Whiteness,
};
use crate::model::{Parameters, Search};
use crate::report::{Bound, short, significant};

/// Rows that are listed by place.
const LISTED: usize = 3;
/// Probability below which a correlation of any strength is no accident, and strength that matters by itself.
const CERTAIN: f64 = 1e-6;
const STRONG: f64 = 0.3;

/// Everything that holds, the headline first. A few rows that carry the sum come before what they spoil. NIS comes before
/// correlation, because wrong noise alone makes innovations correlated; only where NIS is right does correlation accuse
/// the model, and only then are tails and distribution looked at, which a wrong mean moves too.
pub(super) fn of(c: &Consistency, source: &str, parameters: &Parameters, candidate: &[f64]) -> Vec<Finding> {
    if c.nis_mean.is_nan() {
        let advice = "no innovation to judge by (the log has no measurement that updates the filter)".into();
        return vec![Finding { verdict: Verdict::NothingMeasured, advice }];
    }
    let outliers = outliers(c, source);
    let (few, many) = if are_few(c) { (outliers, None) } else { (None, outliers) };
    let searched = parameters.searched().zip(candidate);
    let at_bounds = searched.filter_map(|((parameter, search), value)| at_bound(&parameter.name, search, *value));
    let course = start(c).into_iter().chain(over_time(c)).filter(|found| !is_due_to_outliers(c, found.verdict));
    let found = few.into_iter().chain(mean(c)).chain(correlated(c)).chain(course).chain(at_bounds);
    let found: Vec<Finding> = found.chain(many).chain(distributed(c)).collect();
    if found.is_empty() { vec![nothing_wrong(c)] } else { found }
}

fn failed(c: &Consistency, kind: TestKind) -> Option<&Test> {
    c.tests.iter().find(|test| test.kind == kind && !test.pass)
}

/// A filter is not called consistent on a log too short to test whiteness on.
fn nothing_wrong(c: &Consistency) -> Finding {
    if c.whiteness.iter().any(Whiteness::is_tested) {
        let advice = format!(
            "no test rejects it (NIS, its course and distribution, whiteness; {:.0} % together), and no parameter is at a bound",
            100.0 * JOINT_LEVEL
        );
        return Finding { verdict: Verdict::Consistent, advice };
    }
    let advice = format!(
        "nothing is wrong with NIS and no parameter is at a bound, but {} innovations are too few to tell whether they are \
         white (judge on a longer log)",
        c.components
    );
    Finding { verdict: Verdict::TooFewInnovations, advice }
}

/// Whether those that dominate are what is wrong, and not the noise or the model: one or one row in a hundred, and most of
/// the sum where the mean is wrong or the innovations are clearly correlated.
fn are_few(c: &Consistency) -> bool {
    let rows = c.nis_distribution.as_ref().map_or(0, |d| d.rows);
    let share: f64 = c.dominating_rows.iter().map(|row| row.share).sum();
    let is_correlated = c.whiteness.iter().any(|w| w.correlated && is_certain(w));
    let something_else = is_correlated || failed(c, TestKind::MeanNis).is_some();
    c.dominating_rows.len() <= (rows / 100).max(1) && (share > 0.5 || !something_else)
}

/// Whether outliers all over the log, that the finding on its tails tells of, are why its parts differ.
fn is_due_to_outliers(c: &Consistency, verdict: Verdict) -> bool {
    let heavy = c.nis_distribution.as_ref().is_some_and(NisDistribution::has_heavy_tails);
    let alike = c.nis_over_time.as_ref().is_some_and(NisOverTime::is_alike);
    verdict == Verdict::ChangesWithTime && heavy && alike && failed(c, TestKind::MeanNis).is_none()
}

/// Whether a correlation is no accident, or so strong that it matters by itself.
fn is_certain(w: &Whiteness) -> bool {
    w.p_value < CERTAIN || w.lag_1().abs() >= STRONG
}

fn outliers(c: &Consistency, source: &str) -> Option<Finding> {
    let rows = c.dominating_rows.as_slice();
    let share = short(100.0 * rows.iter().map(|row| row.share).sum::<f64>(), 3);
    let of = if source.is_empty() { String::new() } else { format!(" of {source}") };
    let listed = rows.iter().take(LISTED).map(|row: &DominatingRow| row.place.to_string()).collect::<Vec<_>>();
    let listed = listed.join(", ");
    let who = match rows.len() {
        0 => return None,
        1 => format!("{listed}{of} alone is {share} % of the sum of NIS: an outlier?"),
        count if count <= LISTED => format!("{count} rows{of} are {share} % of the sum of NIS, {listed}: outliers?"),
        count => format!("{count} rows{of} are {share} % of the sum of NIS, above all {listed}: outliers?"),
    };
    let advice = format!("{who} (leave out what is wrong there and tune again: the noise was tuned around it)");
    Some(Finding { verdict: Verdict::Outliers, advice })
}

/// The mean NIS of the rows that are judged.
fn mean(c: &Consistency) -> Option<Finding> {
    let test = failed(c, TestKind::MeanNis)?;
    let (verdict, side, size) = if test.measured > 1.0 {
        (Verdict::Overconfident, "above", "small")
    } else {
        (Verdict::Underconfident, "below", "large")
    };
    let (what, which) = match c.judged_after {
        0 => (String::new(), "P0, Q or R"),
        first => (format!(" after the first {first} measured rows"), "Q or R"),
    };
    let advice = format!(
        "mean NIS{what} {} is {side} what {} % of right filters have, {}: {which} is too {size} for the errors that occur",
        short(test.measured, 4),
        short(100.0 * (1.0 - test.level), 4),
        test.required
    );
    Some(Finding { verdict, advice })
}

/// The first rows, which are to blame themselves or are of a piece with what follows them.
fn start(c: &Consistency) -> Option<Finding> {
    let test = failed(c, TestKind::FirstRows)?;
    if c.judged_after == 0 {
        let advice = format!(
            "NIS is {} in the first {SETTLING} measured rows, and {} after them, but not at once: the noise changes with time",
            short(test.measured, 3),
            short(c.nis_settled, 3)
        );
        let told = failed(c, TestKind::NisOverTime).is_some() || failed(c, TestKind::MeanNis).is_some();
        return (!told).then_some(Finding { verdict: Verdict::ChangesWithTime, advice });
    }
    let size = if test.measured > 1.0 { "small" } else { "large" };
    let rest = if failed(c, TestKind::MeanNis).is_none() { ", and Q and R fit" } else { "" };
    let advice = format!(
        "mean NIS is {} in the first {SETTLING} measured rows and {} after them: P0 is too {size} for this x0{rest} (change \
         P0 or x0; all else is judged on the rows after them)",
        short(test.measured, 4),
        short(c.nis_settled, 4)
    );
    Some(Finding { verdict: Verdict::WrongStart, advice })
}

/// The lag that shows the correlation best to a reader: the first, or the strongest where the first is in its band.
fn telling(w: &Whiteness) -> (usize, f64) {
    let lags = (1..).zip(w.autocorrelation.iter().copied());
    let strongest = lags.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or((1, w.lag_1()));
    if w.lag_1().abs() > w.band { (1, w.lag_1()) } else { strongest }
}

fn correlated(c: &Consistency) -> Option<Finding> {
    let those: Vec<&Whiteness> = c.whiteness.iter().filter(|w| w.correlated).collect();
    let least = those.iter().map(|w| w.p_value).reduce(f64::min)?;
    let name = |w: &&Whiteness| {
        let (lag, r) = telling(w);
        format!("{} (lag {lag}: {r:+.2})", w.measurement)
    };
    let names = those.iter().map(name).collect::<Vec<_>>().join(", ");
    let cause = if failed(c, TestKind::MeanNis).is_some() {
        "either the noise alone is wrong or the model too (tune first; if they stay correlated, change the model)"
            .to_owned()
    } else if those.iter().any(|w| is_certain(w)) {
        "the model, not only the noise, is wrong (try a model of higher order, a bias state or coloured noise; if nothing \
         was tuned yet, tune first)"
            .to_owned()
    } else {
        format!(
            "a weak sign, as one right filter in {} shows, that the model lacks something (look whether another log shows it \
             too before changing the model; if nothing was tuned yet, tune first)",
            significant((1.0 / least).floor(), 2)
        )
    };
    let advice = format!("innovations of {names} predict each other: {cause}");
    Some(Finding { verdict: Verdict::InnovationsCorrelated, advice })
}

fn over_time(c: &Consistency) -> Option<Finding> {
    failed(c, TestKind::NisOverTime)?;
    let advice = format!(
        "{}: the noise changes with time, and one Q and R cannot fit both (look at what changed there, tune the parts apart, or \
         let an adaptive filter follow)",
        c.nis_over_time.as_ref()?.sentence()
    );
    Some(Finding { verdict: Verdict::ChangesWithTime, advice })
}

/// Tails and distribution, only where the mean is right: a wrong mean moves them too.
fn distributed(c: &Consistency) -> Option<Finding> {
    let found = c.nis_distribution.as_ref().filter(|_| failed(c, TestKind::MeanNis).is_none())?;
    let percent = |share: f64| short(100.0 * share, 2);
    let (verdict, advice) = if found.has_heavy_tails() {
        let advice = format!(
            "{} % of rows are above the 99 % quantile of their NIS, at most {} % should be, though its mean is right: the \
             noise has outliers or changes with time (look at the rows of largest NIS)",
            percent(found.above_99),
            percent(found.above_99_high)
        );
        (Verdict::HeavyTails, advice)
    } else if found.has_light_tails() {
        let advice = format!(
            "{} % of rows are above the 95 % quantile of their NIS, at least {} % should be, though its mean is right: the \
             noise is rounded or bounded, or was tuned around a few rows of large NIS (look at those)",
            percent(found.above_95),
            percent(found.above_95_low)
        );
        (Verdict::LightTails, advice)
    } else if failed(c, TestKind::NisDistribution).is_some() {
        let advice = format!(
            "NIS does not have its chi-square distribution (p = {:.1e}), though its mean is right: the noise is not normal, \
             changes with time, or is held or rounded (look at the histogram of the innovations)",
            found.p_value
        );
        (Verdict::WrongDistribution, advice)
    } else {
        return None;
    };
    Some(Finding { verdict, advice })
}

fn at_bound(name: &str, search: &Search, value: f64) -> Option<Finding> {
    let side = Bound::of(search, value)?;
    let (value, bound) = (short(value, 5), short(side.value(search), 6));
    let advice = format!(
        "{name} = {value} is at its {side} bound {bound}: the optimum lies beyond it, or the model does not need it \
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
