//! Which column is what, by its name first and its content second.

use super::survey::{Content, Survey};
use crate::model::Function;

const TIMES: &[&str] = &[
    "t",
    "t_s",
    "time",
    "time_s",
    "time_sec",
    "timestamp",
    "stamp",
    "date",
    "datetime",
    "utc",
    "year",
    "sec",
    "secs",
    "second",
    "seconds",
];
const TRAJECTORIES: [&str; 10] =
    ["id", "track", "track_id", "trackid", "trajectory", "run", "run_id", "target", "target_id", "realisation"];
/// Row counters: never measured, but good enough as time where nothing better increases.
const COUNTERS: [&str; 7] = ["index", "frame", "step", "row", "seq", "sample", "epoch"];
const TRUTH_SUFFIXES: [&str; 3] = ["_true", "_truth", "_gt"];
const TRUTH_PREFIXES: [&str; 3] = ["true_", "truth_", "gt_"];

/// More measurements than a built-in model takes, so a narrower choice by name is tried.
const MANY: usize = 3;

/// Guessed roles, as positions in [`Survey::columns`].
pub(super) struct Roles {
    pub(super) time: Option<usize>,
    pub(super) trajectory: Option<usize>,
    /// (state it would be the truth of, column).
    pub(super) truth: Vec<(String, usize)>,
    /// Columns that could be measured, the likeliest first.
    pub(super) candidates: Vec<usize>,
    /// A column named like a time that does not increase, and the line where it fails.
    pub(super) false_time: Option<(usize, u64)>,
}

/// Whether a column of this name tells trajectories apart.
pub(super) fn names_a_trajectory(name: &str) -> bool {
    TRAJECTORIES.contains(&name.to_lowercase().as_str())
}

fn names_a_time(name: &str) -> bool {
    TIMES.contains(&name.to_lowercase().as_str())
}

fn names_a_counter(name: &str) -> bool {
    COUNTERS.contains(&name.to_lowercase().as_str())
}

/// `x` for `x_true`, `true_x`, `truth_x`, `x_gt`, ...
fn truth_of_what(name: &str) -> Option<&str> {
    let suffix = TRUTH_SUFFIXES.iter().find_map(|s| name.strip_suffix(s));
    suffix.or_else(|| TRUTH_PREFIXES.iter().find_map(|p| name.strip_prefix(p))).filter(|state| !state.is_empty())
}

/// Names that say outright that they are measured: `z`, `z0`, `zx`, `meas_x`, `obs_1`.
fn names_a_measurement(name: &str) -> bool {
    let name = name.to_lowercase();
    (name.starts_with('z') && name.len() <= 3) || name.contains("meas") || name.starts_with("obs")
}

impl Roles {
    pub(super) fn guess(survey: &Survey) -> Self {
        let columns = &survey.columns;
        let repeats = |content: &Content| matches!(content, Content::Labels(ids) if ids.len() < survey.lines.len());
        let trajectory = columns.iter().position(|c| repeats(&c.content));
        let truth: Vec<(String, usize)> = columns
            .iter()
            .enumerate()
            .filter(|(_, c)| c.content == Content::Numbers)
            .filter_map(|(i, c)| Some((truth_of_what(&c.name)?.to_owned(), i)))
            .collect();
        let mut roles = Self { time: None, trajectory, truth, candidates: Vec::new(), false_time: None };
        roles.guess_time(survey);
        let used = |i: usize| {
            let named = [roles.time, roles.trajectory, roles.false_time.map(|(i, _)| i)];
            named.contains(&Some(i)) || roles.truth.iter().any(|(_, truth)| *truth == i)
        };
        let counts = |i: usize| names_a_time(&columns[i].name) || names_a_counter(&columns[i].name);
        let could = |i: &usize| !used(*i) && !counts(*i) && !columns[*i].name.is_empty() && columns[*i].varies();
        let mut candidates: Vec<usize> = (0..columns.len()).filter(could).collect();
        if candidates.len() > MANY && candidates.iter().any(|&i| names_a_measurement(&columns[i].name)) {
            candidates.retain(|&i| names_a_measurement(&columns[i].name));
        }
        roles.candidates = candidates;
        roles
    }

    /// The first column named like a time that increases; where none is named so, the first that increases.
    fn guess_time(&mut self, survey: &Survey) {
        let columns = &survey.columns;
        let free: Vec<usize> = (0..columns.len())
            .filter(|&i| Some(i) != self.trajectory && !self.truth.iter().any(|(_, truth)| *truth == i))
            .filter(|&i| matches!(columns[i].content, Content::Numbers | Content::Instants(_)))
            .filter(|&i| !columns[i].name.is_empty())
            .collect();
        let trajectory = self.trajectory;
        let stop = |i: usize| stops_increasing(survey, trajectory, i);
        let named: Vec<usize> = free.iter().copied().filter(|&i| names_a_time(&columns[i].name)).collect();
        if let Some(&first) = named.first() {
            self.time = named.iter().copied().find(|&i| stop(i).is_none());
            self.false_time = if self.time.is_none() { stop(first).map(|line| (first, line)) } else { None };
        } else {
            // A lone rising column is what was measured.
            let others = |time: usize| free.iter().any(|&i| i != time && columns[i].varies());
            self.time = free.iter().copied().find(|&i| stop(i).is_none()).filter(|&i| others(i));
        }
    }

    /// A name for each of the first `count` candidates that formulas can use: the state whose truth is given, if the
    /// column is named after it, else the column's own name.
    pub(super) fn axis_names(&self, survey: &Survey, count: usize) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for &i in &self.candidates[..count] {
            let column = &survey.columns[i].name;
            let state = self.truth.iter().map(|(state, _)| state).find(|state| measures(column, state));
            let mut name = identifier(state.unwrap_or(column));
            // `v` and `a` before an axis are states of built-in models.
            while names.iter().any(|other| clash(other, &name) || clash(&name, other)) {
                name.push('_');
            }
            names.push(name);
        }
        names
    }

    /// (state, column) of every truth column that is of one of `states`.
    pub(super) fn truth_of(&self, survey: &Survey, states: &[String]) -> Vec<(String, String)> {
        let known = self.truth.iter().filter(|(state, _)| states.contains(state));
        let mut pairs: Vec<(String, String)> = Vec::new();
        for (state, i) in known {
            if !pairs.iter().any(|(other, _)| other == state) {
                pairs.push((state.clone(), survey.columns[*i].name.clone()));
            }
        }
        pairs
    }
}

/// The first line where column `i` is missing or no greater than before in its trajectory.
fn stops_increasing(survey: &Survey, trajectory: Option<usize>, i: usize) -> Option<u64> {
    let mut last = vec![f64::NEG_INFINITY];
    for (row, &value) in survey.columns[i].values.iter().enumerate() {
        let trajectory = trajectory.map_or(0, |t| survey.columns[t].values[row] as usize);
        last.resize(last.len().max(trajectory + 1), f64::NEG_INFINITY);
        if value.is_nan() || value <= last[trajectory] {
            return Some(survey.lines[row]);
        }
        last[trajectory] = value;
    }
    None
}

/// Whether a column of this name measures `state`: `zx`, `z_x`, `x_meas`, `x_z`, ... or `x` itself.
fn measures(column: &str, state: &str) -> bool {
    let rest = column.strip_prefix("meas_").or_else(|| column.strip_prefix("obs_"));
    let rest = rest.or_else(|| column.strip_suffix("_meas")).or_else(|| column.strip_suffix("_obs"));
    let rest = rest.or_else(|| column.strip_prefix("z_")).or_else(|| column.strip_suffix("_z"));
    column == state || rest == Some(state) || column.strip_prefix('z') == Some(state)
}

fn clash(a: &str, b: &str) -> bool {
    a == b || ["v", "a", "q_", "r_"].iter().any(|prefix| a.strip_prefix(prefix) == Some(b))
}

/// `text` as a name that formulas can use.
fn identifier(text: &str) -> String {
    let mut name: String = text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert(0, 'x');
    }
    let is_reserved =
        matches!(name.as_str(), "dt" | "pi") || Function::ALL.iter().any(|(function, _)| *function == name);
    if is_reserved { name + "_" } else { name }
}
