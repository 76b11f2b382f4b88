//! Which column is what, by its name first and its content second.

use super::degrees::Degrees;
use super::names::{Input, names_a_counter, names_a_measurement, names_a_time, names_an_input, unit_in};
use super::survey::{Column, Content, Survey};
use crate::data::TimeUnit;
use crate::model::formula::reserved;

const TRUTH_SUFFIXES: [&str; 3] = ["_true", "_truth", "_gt"];
const TRUTH_PREFIXES: [&str; 3] = ["true_", "truth_", "gt_"];

/// More measurements than a built-in model takes, so a narrower choice by name is tried.
const MANY: usize = 3;

/// Guessed roles, as positions in [`Survey::columns`].
#[derive(Default)]
pub(super) struct Roles {
    pub(super) time: Option<usize>,
    /// Whether the time was taken for rising alone, not for its name.
    pub(super) time_by_content: bool,
    pub(super) trajectory: Option<usize>,
    /// (state it would be the truth of, column).
    pub(super) truth: Vec<(String, usize)>,
    /// Columns that could be measured, the likeliest first.
    pub(super) candidates: Vec<usize>,
    /// Columns named like inputs, which are not among the candidates.
    pub(super) inputs: Vec<usize>,
    /// Whether the candidates are named like inputs too, as nothing else is there.
    pub(super) measures_inputs: bool,
    /// A column named like a time that does not increase.
    pub(super) false_time: Option<Stop>,
}

/// `x` for `x_true`, `true_x`, `truth_x`, `x_gt`, ...
fn truth_of_what(name: &str) -> Option<&str> {
    let suffix = TRUTH_SUFFIXES.iter().find_map(|s| name.strip_suffix(s));
    suffix.or_else(|| TRUTH_PREFIXES.iter().find_map(|p| name.strip_prefix(p))).filter(|state| !state.is_empty())
}

impl Roles {
    pub(super) fn guess(survey: &Survey) -> Self {
        let columns = &survey.columns;
        let repeats = |content: &Content| matches!(content, Content::Labels(ids) if ids.len() < survey.lines.len());
        let trajectory = columns.iter().position(|c| repeats(&c.content));
        let truth: Vec<(String, usize)> = columns
            .iter()
            .enumerate()
            .filter(|(_, c)| c.content == Content::Numbers && c.odd.is_empty())
            .filter_map(|(i, c)| Some((truth_of_what(&c.name)?.to_owned(), i)))
            .collect();
        let mut roles = Self { trajectory, truth, ..Self::default() };
        roles.guess_time(survey);
        let used = |i: usize| {
            let named = [roles.time, roles.trajectory, roles.false_time.as_ref().map(|stop| stop.column)];
            named.contains(&Some(i)) || roles.truth.iter().any(|(_, truth)| *truth == i)
        };
        let counts = |i: usize| names_a_time(&columns[i].name) || names_a_counter(&columns[i].name);
        let could = |i: &usize| !used(*i) && !counts(*i) && !columns[*i].name.is_empty() && columns[*i].varies();
        let mut candidates: Vec<usize> = (0..columns.len()).filter(could).collect();
        if candidates.len() > MANY && candidates.iter().any(|&i| names_a_measurement(&columns[i].name)) {
            candidates.retain(|&i| names_a_measurement(&columns[i].name));
        }
        roles.candidates = candidates;
        roles.set_inputs_aside(survey);
        roles
    }

    /// Sets aside what is named like an input, as long as something less so remains to be measured.
    fn set_inputs_aside(&mut self, survey: &Survey) {
        let likeness = |i: usize| names_an_input(&survey.columns[i].name);
        let Some(least) = self.candidates.iter().map(|&i| likeness(i)).min() else { return };
        let (kept, aside) = std::mem::take(&mut self.candidates).into_iter().partition(|&i| likeness(i) == least);
        (self.candidates, self.inputs) = (kept, aside);
        self.measures_inputs = least > Input::No;
    }

    /// The first column named like a time that increases; where none is named so, the first that increases.
    fn guess_time(&mut self, survey: &Survey) {
        let columns = &survey.columns;
        let free: Vec<usize> = (0..columns.len())
            .filter(|&i| Some(i) != self.trajectory && !self.truth.iter().any(|(_, truth)| *truth == i))
            .filter(|&i| matches!(columns[i].content, Content::Numbers | Content::Instants(_)))
            .filter(|&i| !columns[i].name.is_empty() && columns[i].odd.is_empty())
            .collect();
        let trajectory = self.trajectory;
        let stop = |i: usize| Stop::of(survey, trajectory, i);
        let others = |time: usize| free.iter().any(|&i| i != time && columns[i].varies());
        let is_time = |i: &usize| names_a_time(&columns[*i].name) || (is_epoch(&columns[*i]) && others(*i));
        let named: Vec<usize> = free.iter().copied().filter(is_time).collect();
        if let Some(&first) = named.first() {
            self.time = named.iter().copied().find(|&i| stop(i).is_none());
            self.false_time = if self.time.is_none() { stop(first) } else { None };
        } else {
            // A lone rising column is what was measured.
            self.time = free.iter().copied().find(|&i| stop(i).is_none()).filter(|&i| others(i));
            self.time_by_content = self.time.is_some();
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

    /// The unit of each of the first `count` candidates, empty where nothing tells it.
    pub(super) fn units_of(
        &self,
        survey: &Survey,
        row: &[String],
        count: usize,
        degrees: Option<&Degrees>,
    ) -> Vec<String> {
        let unit = |&i: &usize| {
            let row = row.get(i).map(String::as_str).filter(|unit| !unit.is_empty());
            let angle = degrees.and_then(|d| d.columns.iter().any(|(column, _)| *column == i).then_some("deg"));
            row.or_else(|| unit_in(&survey.columns[i].name)).or(angle).unwrap_or_default().to_owned()
        };
        self.candidates[..count].iter().map(unit).collect()
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

/// Where a column that should be a time does not increase.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stop {
    pub(super) column: usize,
    pub(super) line: u64,
    /// How, for messages: "is empty", "stands still", "goes back".
    pub(super) how: &'static str,
}

impl Stop {
    /// The first line where column `i` is missing or no greater than before in its trajectory.
    fn of(survey: &Survey, trajectory: Option<usize>, i: usize) -> Option<Self> {
        let mut last = vec![f64::NEG_INFINITY];
        for (row, &value) in survey.columns[i].values.iter().enumerate() {
            let trajectory = trajectory.map_or(0, |t| survey.columns[t].values[row] as usize);
            last.resize(last.len().max(trajectory + 1), f64::NEG_INFINITY);
            let how = match value {
                v if v.is_nan() => "is empty",
                v if v < last[trajectory] => "goes back",
                v if v <= last[trajectory] => "stands still",
                _ => "",
            };
            if !how.is_empty() {
                return Some(Self { column: i, line: survey.lines[row], how });
            }
            last[trajectory] = value;
        }
        None
    }
}

/// Whether numbers have the size of an epoch of the years 2000 to 2040, and nearly all of them rise.
fn is_epoch(column: &Column) -> bool {
    let present: Vec<f64> = column.values.iter().copied().filter(|v| !v.is_nan()).collect();
    let rising = present.windows(2).filter(|w| w[1] >= w[0]).count();
    let recent = |v: f64, unit: TimeUnit| (9.46e8..2.21e9).contains(&(v / 10f64.powi(unit.decimals())));
    let unit = |v: &f64| TimeUnit::of_epoch(*v).filter(|unit| recent(*v, *unit));
    let of_a_size = present.first().and_then(unit).is_some() && present.iter().all(|v| unit(v) == unit(&present[0]));
    column.content == Content::Numbers && present.len() > 2 && of_a_size && rising * 10 >= present.len() * 8
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
pub(super) fn identifier(text: &str) -> String {
    let mut name: String = text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert(0, 'x');
    }
    if reserved(&name).is_some() { name + "_" } else { name }
}
