//! Why objectives of two runs are not comparable.

use super::Run;
use super::run::RunValidation;
use crate::objective::Kind;
use crate::report::{LogFacts, count};

/// Sentences, none where the runs scored the same rows in the same way.
pub(super) fn between(first: &Run, run: &Run) -> Vec<String> {
    [log(first, run), objectives(first, run), split(first, run)].into_iter().flatten().collect()
}

fn log(first: &Run, run: &Run) -> Option<String> {
    let (a, b) = (&first.log, &run.log);
    // Results of older versions have no checksum.
    let equal = |a: &String, b: &String| (!a.is_empty() && !b.is_empty()).then_some(a == b);
    let same = match equal(&a.sha256, &b.sha256) {
        None => (a.rows, a.trajectories) == (b.rows, b.trajectories),
        Some(true) => true,
        // Models of one log may use other columns of it: times, inputs, and the truth where nothing is scored by it.
        Some(false) => {
            let truth = !needs_truth(first) || equal(&a.truth_sha256, &b.truth_sha256) == Some(true);
            truth && equal(&a.measurements_sha256, &b.measurements_sha256) == Some(true)
        }
    };
    let facts = |log: &LogFacts| {
        let trajectories = if log.trajectories == 1 { "trajectory" } else { "trajectories" };
        format!("{}, {} rows in {} {trajectories}", log.source, count(log.rows as u64), log.trajectories)
    };
    let and = if facts(a) == facts(b) { ", with other numbers" } else { "" };
    (!same).then(|| format!("another log: {} on {}{and}; {} on {}.", run.path, facts(b), first.path, facts(a)))
}

fn needs_truth(run: &Run) -> bool {
    run.objectives.iter().any(|(name, _)| Kind::ALL.iter().any(|(known, kind)| *known == name && kind.needs_truth()))
}

fn objectives(first: &Run, run: &Run) -> Option<String> {
    let names = |run: &Run| {
        let mut names: Vec<String> = run.objectives.iter().map(|(name, _)| name.to_owned()).collect();
        names.sort();
        names
    };
    if names(first) != names(run) {
        let (a, b) = (first.objective_list(), run.objective_list());
        return Some(format!("other objectives: {} has {b}; {} has {a}.", run.path, first.path));
    }
    let differs = |(name, theirs): (&str, &String)| {
        let ours = first.definitions.get(name)?;
        let sentence = || format!("`{name}` over other rows: {} ({theirs}); {} ({ours}).", run.path, first.path);
        (ours != theirs).then(sentence)
    };
    run.definitions.iter().find_map(differs)
}

fn split(first: &Run, run: &Run) -> Option<String> {
    let key = |v: &RunValidation| (v.by.clone(), v.fresh, v.train, v.held_out);
    let (a, b) = (&first.validation, &run.validation);
    if a.as_ref().map(key) == b.as_ref().map(key) {
        return None;
    }
    let words = |validation: &Option<RunValidation>| match validation {
        None => "nothing".to_owned(),
        Some(v) => {
            let by = if v.fresh { "fresh realisations" } else { &v.by };
            format!("{} of {} rows (by {by})", count(v.held_out.rows as u64), {
                count((v.train.rows + v.held_out.rows) as u64)
            })
        }
    };
    Some(format!("another split: {} holds out {}; {} {}.", run.path, words(b), first.path, words(a)))
}
