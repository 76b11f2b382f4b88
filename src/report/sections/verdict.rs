//! The verdict of a study in words, before any table.

use crate::number::significant;
use crate::report::document::{Part, Section};
use crate::report::warnings::missed_on_held_out;
use crate::report::{ConstraintCheck, Named, Rows, Standing, Tuning, Validation, Verdict, Warning};
use crate::words::counted;

/// What to do, what was done, and what came of it.
pub(super) fn of(tuning: &Tuning) -> Section {
    let section = Section::new("Verdict")
        .on_page(Part::Strong(recommendation(tuning)))
        .on_page(what_was_done(tuning))
        .on_page(gain(tuning));
    let section = match &tuning.validation {
        Some(_) => section,
        None => section.on_page(
            "Nothing was held out: every number here is of the rows that were tuned on, and a filter always looks best on \
             those.",
        ),
    };
    section.on_page(consistency(tuning))
}

/// One sentence on what to do, the gravest reason first.
fn recommendation(tuning: &Tuning) -> String {
    let keep = tuning.start_of.keep();
    let validated = tuning.validation.as_ref();
    if let Some(failing) = validated.filter(|v| v.winner.is_none()) {
        format!("Do not use the tuned parameters: {}.", failing.judgement())
    } else if !tuning.feasible {
        "Do not use the tuned parameters as they are: no candidate meets every constraint.".to_owned()
    } else if let Some(worse) = validated.filter(|v| v.worse) {
        format!("{keep}: {}.", worse.judgement())
    } else if missed_on_held_out(tuning).is_some() {
        "Check before use: on held-out data the tuned filter misses a constraint that it meets on the rows tuned on."
            .to_owned()
    } else if let Some(standing) = standing(tuning) {
        with_gain(tuning, &standing)
    } else {
        format!("{keep}: the search found none that are better.")
    }
}

/// Of a winner that gains on the baseline, and how: what the certificate, the consistency and the held-out rows add.
fn with_gain(tuning: &Tuning, standing: &str) -> String {
    if !tuning.certificate.order_held {
        let precision = tuning.effort.device.precision;
        format!("Check before use: {}.", Warning::OrderChanged { precision })
    } else if tuning.converged == Some(false) {
        let note =
            tuning.polish.as_ref().and_then(|polish| polish.note.as_deref()).unwrap_or("the search stopped short");
        format!("The tuned parameters {standing}, but they are no optimum yet: {note}.")
    } else if !tuning.consistency.is_consistent() {
        let headline = tuning.consistency.verdict;
        format!("The tuned parameters {standing}, but the filter is not yet right: {headline}.")
    } else if let Some(validation) = &tuning.validation {
        on_held_out(validation, standing)
    } else {
        format!(
            "The tuned parameters {standing} and the filter is consistent; both were judged on the rows that were tuned on \
             (hold some out with `--validate` to be sure)."
        )
    }
}

/// Of a winner that gains, is consistent on held-out rows and not worse there.
fn on_held_out(validation: &Validation, standing: &str) -> String {
    let judgement = validation.judgement();
    if validation.difference.is_trade() {
        format!(
            "The tuned parameters {standing}, and the filter is consistent on held-out data: use them if a trade is what you \
             want, since {judgement}."
        )
    } else if validation.difference.verdict == Standing::Better {
        format!(
            "Use the tuned parameters, with which the filter is consistent on data that it was not tuned on: {judgement}."
        )
    } else {
        format!(
            "The tuned parameters {standing} on the rows tuned on, and may be used: the filter is consistent on data that it \
             was not tuned on, though there is {judgement}."
        )
    }
}

/// In what the winner gains on the baseline, as a predicate of "the tuned parameters"; `None` where it is in nothing.
fn standing(tuning: &Tuning) -> Option<String> {
    let Some(baseline) = &tuning.effort.baseline.objectives else {
        return Some(format!("run, where {} {}", tuning.start_of, tuning.start_of.verb("fail", "fails")));
    };
    if !tuning.constraints.iter().all(ConstraintCheck::met_by_baseline) {
        let (start, does) = (tuning.start_of, tuning.start_of.verb("do", "does"));
        return Some(format!("meet every constraint, which {start} {does} not"));
    }
    let where_less = |a: &Named<f64>, b: &Named<f64>| {
        let less = a.iter().filter(|(name, value)| b.get(name).is_none_or(|other| *value < other));
        less.map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(" and ")
    };
    let (better, worse) = (where_less(&tuning.objectives, baseline), where_less(baseline, &tuning.objectives));
    match (better.as_str(), worse.as_str()) {
        ("", _) => None,
        (_, "") => Some(format!("are better than {}", tuning.start_of)),
        _ => Some(format!("are better than {} under {better} and worse under {worse}", tuning.start_of)),
    }
}

fn what_was_done(tuning: &Tuning) -> String {
    let effort = &tuning.effort;
    let names: Vec<String> = tuning.objectives.iter().map(|(name, _)| format!("`{name}`")).collect();
    let count = tuning.parameters.iter().len();
    let (parameters, were) =
        if count == 1 { ("one parameter".to_owned(), "was") } else { (format!("{count} parameters"), "were") };
    let rows = match &tuning.validation {
        None => "every row of it".to_owned(),
        Some(v) if v.fresh => format!("{} of it", counted(v.train.trajectories, "realisation")),
        Some(v) => format!("{} of its rows", v.train.rows),
    };
    format!(
        "A Kalman filter estimates states from noisy measurements, and is only as good as the noise it assumes. Here {parameters} \
         of the filter in `{}` {were} searched on the log `{}`, {rows}, so that {} {} as small as possible. \"Baseline\" stands \
         for the values that the problem file gives, \"tuned\" for the best found.",
        effort.problem,
        effort.log.source,
        names.join(" and "),
        if names.len() == 1 { "is" } else { "are" },
    )
}

fn gain(tuning: &Tuning) -> String {
    let part = |(name, tuned): (&str, &f64)| {
        let start = tuning.effort.baseline.objectives.as_ref().and_then(|o| o.get(name));
        let tuned = significant(*tuned, 6);
        match start {
            Some(start) => format!("`{name}` goes from {} to {tuned}", significant(*start, 6)),
            None => format!("`{name}` is {tuned}, and that of the baseline fails"),
        }
    };
    let parts: Vec<String> = tuning.objectives.iter().map(part).collect();
    let on = if tuning.validation.is_some() { "On the rows tuned on, " } else { "On this log, " };
    format!("{on}{} (lower is better).", parts.join("; "))
}

fn consistency(tuning: &Tuning) -> String {
    let c = &tuning.consistency;
    let meaning = match c.verdict {
        Verdict::Consistent => "the errors are as large as the filter says they are, and carry no pattern",
        Verdict::Overconfident => "the errors are larger than the filter says they are",
        Verdict::Underconfident => "the errors are smaller than the filter says they are",
        Verdict::InnovationsCorrelated => {
            "each error tells something of the next, which a filter with the right model would have used"
        }
        Verdict::Outliers => "a few rows are far out and decide what was tuned",
        Verdict::WrongStart => {
            "the errors of the first rows are not what the filter says they are, those of later ones are"
        }
        Verdict::ChangesWithTime => "the errors are larger at some times than at others, and the filter does not know",
        Verdict::HeavyTails => "large errors are more frequent than the filter says",
        Verdict::LightTails => "large errors are rarer than the filter says, though the mean is right",
        Verdict::WrongDistribution => "the errors are not normal",
        Verdict::ParameterAtBound => "a parameter stopped where its bound is, not where it is best",
        Verdict::TooFewInnovations => "the log is too short to tell",
        _ => "see the section on consistency",
    };
    let on = if tuning.consistency_on == Rows::HeldOut { "held-out rows" } else { "the rows tuned on" };
    format!("Judged on {on}, the tuned filter is: {} ({meaning}).", c.verdict)
}
