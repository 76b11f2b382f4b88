//! What filters that differ in their view of f and h say together.

use std::fmt;

use serde::Serialize;

use super::Difference;
use super::score::Scored;
use crate::model::{Adapts, Problem, View};
use crate::number::significant;
use crate::report::Standing;
use crate::words::enumerated;

/// What may stay open where linearising is called no problem, in nats a row and in all.
const OPEN: (f64, f64) = (0.05, 1.0);

/// Whether linearising costs on a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Linearising {
    /// f and h are affine, so that every filter is the Kalman filter.
    Exact,
    /// No filter is told to be more likely than the extended one, and none can be by much.
    NoProblem,
    /// One is, or it runs where the extended one fails.
    Costs,
    /// The rows cannot tell.
    NotToldApart,
}

/// What is said of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LinearityVerdict {
    /// In a word.
    pub linearising: Linearising,
    /// In a sentence, without its full stop and its first capital.
    pub sentence: String,
}

impl LinearityVerdict {
    /// `scored` begins with the problem's own filter.
    pub(super) fn of(own: &Problem, scored: &[Scored]) -> Self {
        if own.model.is_affine() {
            return exact(own, scored);
        }
        // Without a filter of tangents the others are held against the problem's own.
        let tangent = scored.iter().find(|one| one.score.view == View::Tangent);
        let Some(base) = tangent.or_else(|| scored.first()) else { return untold("there is no filter".to_owned()) };
        let others: Vec<&Scored> =
            scored.iter().filter(|one| one.runs() && one.score.filter != base.score.filter).collect();
        if others.is_empty() {
            let ran = if base.runs() { "no other filter runs on this log" } else { "no filter runs on this log" };
            return untold(format!("nothing can be told of linearising: {ran}"));
        }
        if !base.runs() {
            let names: Vec<&str> = others.iter().map(|one| one.score.filter.as_str()).collect();
            let run = if names.len() == 1 { "runs" } else { "run" };
            let sentence = format!(
                "the {} filter fails on this log, where {} {run}{}",
                base.score.filter,
                enumerated(&names),
                costs(base, others[0])
            );
            return Self { linearising: Linearising::Costs, sentence };
        }
        let gains: Vec<(&Scored, Difference)> = others.into_iter().map(|other| (other, base.gain_of(other))).collect();
        compared(base, &gains)
    }
}

/// Every filter that adapts nothing is the same one.
fn exact(own: &Problem, scored: &[Scored]) -> LinearityVerdict {
    let adapts = own.filter.facts().adapts != Adapts::Nothing;
    let alike = scored.iter().skip(usize::from(adapts)).filter(|one| one.runs()).map(|one| one.score.nll);
    let alike: Vec<f64> = alike.collect();
    let end = |of: fn(f64, f64) -> f64| alike.iter().copied().reduce(of).unwrap_or(f64::NAN);
    let apart = if alike.len() > 1 {
        let range = significant(end(f64::max) - end(f64::min), 2);
        format!(", and their nll differ by {range} nats, which is rounding")
    } else {
        String::new()
    };
    let who = if adapts { "every filter that adapts nothing" } else { "every filter" };
    let sentence =
        format!("{who} is the Kalman filter here, since f and h are affine: there is nothing to linearise{apart}");
    LinearityVerdict { linearising: Linearising::Exact, sentence }
}

const fn untold(sentence: String) -> LinearityVerdict {
    LinearityVerdict { linearising: Linearising::NotToldApart, sentence }
}

/// Of filters that run: how much more likely each is than `base`.
fn compared(base: &Scored, gains: &[(&Scored, Difference)]) -> LinearityVerdict {
    let name = base.score.filter.as_str();
    let better = gains.iter().filter(|(_, gain)| gain.verdict == Standing::Better);
    if let Some((best, gain)) = better.max_by(|a, b| a.1.difference.total_cmp(&b.1.difference)) {
        let (by, than) = (gain.amount("nll"), &best.score.filter);
        let sentence = format!("the {than} filter is more likely than the {name} by {by}{}", costs(base, best));
        return LinearityVerdict { linearising: Linearising::Costs, sentence };
    }
    let each: Vec<String> = gains.iter().map(|(other, gain)| described(other, gain)).collect();
    let each = each.join(", ");
    if gains.iter().any(|(_, gain)| gain.standard_error.is_nan()) {
        return untold(format!("these rows are too few to tell the filters apart ({each})"));
    }
    let most = (OPEN.0 * base.measured() as f64).max(OPEN.1);
    if gains.iter().any(|(_, gain)| gain.difference + 1.96 * gain.standard_error > most) {
        return untold(format!("these rows cannot tell whether another filter is better than the {name} ({each})"));
    }
    let no_problem = if base.score.view == View::Tangent { "linearising is no problem on this log: " } else { "" };
    let sentence = format!("{no_problem}no other filter can be told to be a nat more likely than the {name} ({each})");
    LinearityVerdict { linearising: Linearising::NoProblem, sentence }
}

/// "unscented 0.31 +- 0.42 nats less likely".
fn described(other: &Scored, gain: &Difference) -> String {
    let side = if gain.difference > 0.0 { "more" } else { "less" };
    format!("{} {} {side} likely", other.score.filter, gain.amount("nll"))
}

/// What it means that another filter is better.
fn costs(base: &Scored, best: &Scored) -> &'static str {
    match (base.score.view, best.score.view) {
        (View::Tangent, View::TangentAgain) => {
            ": linearising h at the prediction costs here, and tuning Q and R would hide it"
        }
        (View::Tangent, _) => ": linearising costs here, and tuning Q and R would hide it",
        _ => ": tuning Q and R would hide that",
    }
}

/// The sentence as one.
impl fmt::Display for LinearityVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut characters = self.sentence.chars();
        let first = characters.next().map(|c| c.to_ascii_uppercase());
        write!(f, "{}{}.", first.map_or_else(String::new, String::from), characters.as_str())
    }
}
