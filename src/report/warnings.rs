//! What a user should look at in the result of a study.

use std::fmt;

use super::constraint::misses;
use super::matrices::differ_in_unit;
use super::{StartOf, Tuning, Validation, count, short, significant};
use crate::evaluate::Precision;
use crate::model::Problem;
use crate::objective::{Kind, Objective};
use crate::optimize;

/// Difference between search and reference that is worth a warning, in units of what is promised of single precision.
const LARGE_GAP: f64 = 10.0;

/// A reason to look twice, with what to do about it.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// The winner's first objective is not below the baseline's.
    NoGain,
    /// On held-out rows the winner is worse than the baseline.
    WorseOnHeldOut {
        /// Whose values the baseline's are.
        than: StartOf,
    },
    /// The winner fails on held-out rows.
    FailsOnHeldOut,
    /// On held-out rows the winner misses constraints that it meets on the training rows.
    ConstraintsOnHeldOut {
        /// What is missed, by how much.
        misses: String,
    },
    /// A method for several objectives was given one.
    OneObjective {
        /// Its name.
        algorithm: String,
    },
    /// An objective adds errors of states whose units differ.
    MixedUnits {
        /// `rmse` or `distance`.
        objective: &'static str,
        /// The states.
        states: Vec<String>,
    },
    /// The front has a single member.
    OneMember,
    /// Candidates failed.
    Failures {
        /// How many.
        failed: u64,
        /// Of how many.
        evaluations: u64,
    },
    /// The winner is not known to be an optimum, or is known not to be one.
    NotConverged {
        /// Why.
        note: String,
    },
    /// Reference and search rank the best candidates differently.
    OrderChanged {
        /// Of the search.
        precision: Precision,
    },
    /// A search in single precision of a filter that loses the track.
    Amplified {
        /// Of the winner.
        amplification: f64,
    },
    /// Reference and search differ by more than single precision should cost.
    LargeGap {
        /// Relative difference.
        gap: f64,
        /// Of the search.
        precision: Precision,
    },
}

impl Warning {
    /// All that a result gives reason for.
    #[must_use]
    pub fn of(tuning: &Tuning) -> Vec<Self> {
        let Tuning { effort, certificate, .. } = tuning;
        let precision = effort.device.precision;
        let (evaluations, failed) = (effort.evaluations, effort.failed);
        let gap = certificate.largest_relative_gap;
        [
            (!gains(tuning)).then_some(Self::NoGain),
            tuning.validation.as_ref().and_then(on_held_out),
            missed_on_held_out(tuning).map(|misses| Self::ConstraintsOnHeldOut { misses }),
            one_objective(tuning),
            tuning.front.as_ref().filter(|front| front.len() == 1).map(|_| Self::OneMember),
            (failed > 0).then_some(Self::Failures { failed, evaluations }),
            not_converged(tuning),
            (!certificate.order_held).then_some(Self::OrderChanged { precision }),
            amplified(tuning),
            (certificate.largest_gap > LARGE_GAP).then_some(Self::LargeGap { gap, precision }),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Objectives that add errors of states of which one is the rate of another.
pub(super) fn mixed_units(problem: &Problem) -> Vec<Warning> {
    let adds = |o: &&Objective| matches!(o.kind, Kind::Rmse | Kind::Distance) && differ_in_unit(problem, &o.states);
    let names = |o: &Objective| o.states.iter().map(|i| problem.model.states[*i].clone()).collect();
    let mixed = problem.tune.objectives.iter().filter(adds);
    mixed.map(|o| Warning::MixedUnits { objective: o.name(), states: names(o) }).collect()
}

fn amplified(tuning: &Tuning) -> Option<Warning> {
    let single = tuning.effort.device.precision == Precision::F32;
    let amplification = tuning.certificate.amplification.filter(|_| single && !tuning.certificate.promise_holds)?;
    Some(Warning::Amplified { amplification })
}

fn not_converged(tuning: &Tuning) -> Option<Warning> {
    let polish = tuning.polish.as_ref().filter(|_| tuning.converged == Some(false))?;
    Some(Warning::NotConverged { note: polish.note.clone().unwrap_or_default() })
}

fn on_held_out(validation: &Validation) -> Option<Warning> {
    match (&validation.winner, validation.worse) {
        (None, _) => Some(Warning::FailsOnHeldOut),
        (Some(_), worse) => worse.then_some(Warning::WorseOnHeldOut { than: validation.start_of }),
    }
}

/// The constraints that the winner meets on the training rows and misses on the held-out ones.
pub(super) fn missed_on_held_out(tuning: &Tuning) -> Option<String> {
    tuning.validation.as_ref().filter(|_| tuning.feasible).and_then(|validation| misses(&validation.constraints))
}

/// Whether a method that is for fronts had one objective; random search is for anything.
fn one_objective(Tuning { effort, objectives, .. }: &Tuning) -> Option<Warning> {
    let row = optimize::algorithm(&effort.algorithm).ok()?;
    let for_fronts = row.maximum_objectives > 1 && row.maximum_objectives < usize::MAX;
    (for_fronts && objectives.iter().len() == 1).then(|| Warning::OneObjective { algorithm: row.name.to_owned() })
}

/// Whether the first objective is below the baseline's, where that has one that meets the constraints.
fn gains(Tuning { effort, objectives, constraints, .. }: &Tuning) -> bool {
    let Some((name, tuned)) = objectives.iter().next() else { return true };
    // Of several objectives the recommended member is a compromise; the report of the front says how it compares.
    if objectives.iter().len() > 1 || constraints.iter().any(|c| !c.met_by_baseline()) {
        return true;
    }
    let baseline = effort.baseline.objectives.as_ref().and_then(|o| o.get(name));
    baseline.is_none_or(|baseline| tuned < baseline)
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let remedy = |precision: &Precision| match precision {
            Precision::F32 => "search with --precision f64",
            Precision::F64 => "check the model",
        };
        match self {
            Self::NoGain => f.write_str(
                "the tuned parameters are no better than the baseline (search longer, or with the start values in it)",
            ),
            Self::WorseOnHeldOut { than } => write!(
                f,
                "tuned parameters are worse than {than} on held-out data (keep {than}, or search fewer parameters, or on more \
                 rows)"
            ),
            Self::FailsOnHeldOut => f.write_str(
                "the filter with the tuned parameters fails on held-out data (keep yours, or narrow the bounds)",
            ),
            Self::ConstraintsOnHeldOut { misses } => write!(
                f,
                "on held-out data the tuned filter has {misses} (set the limit with room to spare, or tune on more rows)"
            ),
            Self::OneObjective { algorithm } => write!(
                f,
                "{algorithm} searches for a front, and of one objective there is none (give a second one, or an algorithm \
                 such as pso, which finds one optimum sooner)"
            ),
            Self::MixedUnits { objective, states } => write!(
                f,
                "{objective} adds the errors of {} as numbers, though their units differ (name states of one unit: {{ name = \
                 \"{objective}\", states = [\"{}\"] }})",
                states.join(", "),
                states.first().map_or("", String::as_str)
            ),
            Self::OneMember => f.write_str(
                "the front has one member, which is the best in every objective at once (the objectives do not conflict, \
                 or the search was too short)",
            ),
            Self::Failures { failed, evaluations } => write!(
                f,
                "{} of {} evaluations failed, because a covariance was not positive or a cost not finite (narrow the \
                 bounds if there are many)",
                count(*failed),
                count(*evaluations)
            ),
            Self::NotConverged { note } => {
                write!(f, "the tuned parameters are no optimum yet: {note} (tune from tuned.toml, or search longer)")
            }
            Self::OrderChanged { precision } => write!(
                f,
                "the f64 reference ranks the best candidates differently from the {precision} search ({})",
                remedy(precision)
            ),
            Self::Amplified { amplification } => write!(
                f,
                "the filter of the winner loses the track somewhere: its amplification is {}, where single precision needs one \
                 below 1 (use --precision f64)",
                short(*amplification, 2)
            ),
            Self::LargeGap { gap, precision } => write!(
                f,
                "costs of the {precision} search are off by up to {} (relative) from the f64 reference ({})",
                significant(*gap, 2),
                remedy(precision)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_different_units_are_not_added_in_silence() {
        let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
        let warnings = |name: &str, objectives: &str| {
            let text = std::fs::read_to_string(examples.join(name)).unwrap();
            let start = text.find("objectives = ").unwrap();
            let end = start + text[start..].find('\n').unwrap();
            let text = format!("{}objectives = {objectives}{}", &text[..start], &text[end..]);
            mixed_units(&Problem::parse(&text, name).unwrap()).iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        let said = warnings("rocket.toml", "[\"nll\", \"rmse\"]");
        let expected = "rmse adds the errors of d, v, a as numbers, though their units differ (name states of one unit: \
                        { name = \"rmse\", states = [\"d\"] })";
        assert_eq!(said, [expected]);
        let none = Vec::<String>::new();
        assert_eq!(warnings("rocket.toml", "[{ name = \"rmse\", states = [\"d\"] }]"), none);
        assert_eq!(warnings("tum_fr2_desk.toml", "[\"rmse\"]"), none, "positions alone have truth");
    }
}
