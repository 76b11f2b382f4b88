//! The drafted problem file as commented TOML.

use std::fmt;

use super::MARK;
use super::estimate::{Axis, Motion};
use super::roles::Roles;
use super::survey::{Content, Survey};
use crate::model::DataSpec;

/// Everything the file says; printing it gives the file.
pub(super) struct Page<'a> {
    pub(super) survey: &'a Survey,
    pub(super) roles: &'a Roles,
    pub(super) data: &'a DataSpec,
    pub(super) motion: Motion,
    pub(super) axes: &'a [Axis],
    pub(super) states: &'a [String],
}

impl fmt::Display for Page<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.survey.lines.len();
        let file = self.data.file.as_deref().unwrap_or_default();
        writeln!(f, "{MARK}{file:?} ({rows} rows). Columns are guessed from names and content, starts and")?;
        writeln!(f, "# bounds are rough estimates from the data: check both, then run `kfgpu tune` on this file.\n")?;
        self.data_table(f)?;
        self.model_table(f)?;
        self.parameters(f)?;
        f.write_str("[filter]\nkind = \"kalman\"\n\n[tune]\nalgorithm = \"pso\"\n")?;
        f.write_str("objectives = [\"nll\"]       # negative log-likelihood of the measurements\n")?;
        f.write_str("population = 256\ngenerations = 60\nseed = 7\n")
    }
}

impl Page<'_> {
    fn data_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let data = self.data;
        writeln!(f, "[data]\nfile = {}", quoted(data.file.as_deref().unwrap_or_default()))?;
        match (&data.time, self.roles.false_time) {
            (Some(time), _) => writeln!(f, "time = {}   # {}", quoted(time), self.time_unit())?,
            (None, Some((i, line))) => {
                let name = &self.survey.columns[i].name;
                writeln!(
                    f,
                    "# Column {name:?} is named like a time but does not increase at line {line}, so rows count"
                )?;
                writeln!(
                    f,
                    "# 0, 1, 2, ... s; if the log pools several runs, name their column: trajectory = \"...\""
                )?;
            }
            (None, None) => writeln!(f, "# No column increases from row to row, so rows count 0, 1, 2, ... s.")?,
        }
        if let Some(trajectory) = &data.trajectory {
            writeln!(f, "trajectory = {}   # rows of one value are one run", quoted(trajectory))?;
        }
        writeln!(f, "measurements = {}   # empty cell or NaN = missing", list(&data.measurements))?;
        if !data.truth.is_empty() {
            let pairs = data.truth.iter().map(|(state, column)| format!("{state} = {}", quoted(column)));
            writeln!(f, "truth = {{ {} }}", pairs.collect::<Vec<_>>().join(", "))?;
        }
        self.left_out(f)?;
        writeln!(f)
    }

    fn time_unit(&self) -> &'static str {
        match self.roles.time.map(|i| &self.survey.columns[i].content) {
            Some(Content::Instants(_)) => "becomes seconds since the first row",
            _ => "taken as seconds",
        }
    }

    /// Comments on every column that is not used.
    fn left_out(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let column = |i: usize| &self.survey.columns[i];
        let is_truth = |i: &usize| self.roles.truth.iter().any(|(_, truth)| truth == i);
        let of = |columns: &[usize]| some(columns.iter().map(|&i| format!("{:?}", column(i).name)));
        let unused = (0..self.survey.columns.len()).filter(|&i| !self.uses(&column(i).name));
        let (truth, unused): (Vec<usize>, Vec<usize>) = unused.partition(is_truth);
        let (numbers, useless): (Vec<usize>, Vec<usize>) = unused.into_iter().partition(|&i| column(i).varies());
        if !numbers.is_empty() {
            let taken = self.data.measurements.len();
            writeln!(f, "# Measurements taken: {taken}; not taken: {}.", of(&numbers))?;
            writeln!(f, "# Known inputs among them would be named in `inputs` (and stand in formulas).")?;
        }
        if !truth.is_empty() {
            writeln!(f, "# Looks like truth, but of no state of this model: {}.", of(&truth))?;
        }
        let reasons =
            some(useless.iter().map(|&i| format!("{:?} ({})", column(i).name, why_useless(&column(i).content))));
        if useless.is_empty() { Ok(()) } else { writeln!(f, "# Left out: {reasons}.") }
    }

    /// Whether `[data]` names a column; one without a name cannot be.
    fn uses(&self, name: &str) -> bool {
        let data = self.data;
        let truth = data.truth.iter().map(|(_, column)| column);
        name.is_empty()
            || data.time.iter().chain(&data.trajectory).chain(&data.measurements).chain(truth).any(|n| n == name)
    }

    fn model_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.axes.iter().map(|a| a.name.clone()).collect();
        let q: Vec<String> = names.iter().map(|axis| format!("q_{axis}")).collect();
        f.write_str("[model]\n# ")?;
        f.write_str(match self.motion {
            Motion::ConstantVelocity => "Mean square changes grow with lag as a motion's do: constant velocity.\n",
            _ => "Mean square changes grow with lag no faster than a wandering level's: a random walk.\n",
        })?;
        match self.motion {
            Motion::RandomWalkByFormulas => {
                writeln!(f, "state = {}\nf = {0}\nh = {0}", list(&names))?;
                let steps: Vec<String> = q.iter().map(|q| format!("{q}*dt")).collect();
                writeln!(f, "Q = {}   # covariance of one step", list(&steps))?;
            }
            motion => {
                let kind = match motion {
                    Motion::LocalLevel => "local-level",
                    Motion::RandomWalk => "random-walk",
                    _ => "constant-velocity",
                };
                writeln!(f, "kind = \"{kind}\"\naxes = {}   # states: {}", list(&names), self.states.join(", "))?;
                writeln!(f, "noise = \"continuous\"\nq = {}   # spectral density of the process noise", list(&q))?;
            }
        }
        let r = self.data.measurements.iter().zip(&names).map(|(z, axis)| format!("{} = \"r_{axis}\"", key(z)));
        writeln!(f, "R = {{ {} }}   # variance of the measurement noise", r.collect::<Vec<_>>().join(", "))?;
        let mut p0: Vec<String> = names.iter().map(|axis| format!("\"r_{axis}\"")).collect();
        if self.motion == Motion::ConstantVelocity {
            p0.extend(self.axes.iter().map(|a| number(a.velocity_variance)));
        }
        writeln!(f, "x0 = \"measurement\"   # the first complete one of each trajectory, as uncertain as any other;")?;
        writeln!(f, "P0 = [{}]   # what it does not measure varies as in the log\n", p0.join(", "))
    }

    fn parameters(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = if self.motion == Motion::ConstantVelocity { "unit^2/s^3" } else { "unit^2/s" };
        writeln!(f, "[parameters]\n# r from second differences, q [{unit}] from how fast changes grow with lag;")?;
        writeln!(f, "# bounds 1e-4 and 1e4 times that.")?;
        let all = self.axes.iter().map(|a| ("r", &a.name, a.r)).chain(self.axes.iter().map(|a| ("q", &a.name, a.q)));
        for (kind, axis, start) in all {
            let (min, max) = (number(1e-4 * start), number(1e4 * start));
            let start = number(start);
            writeln!(f, "{kind}_{axis} = {{ min = {min}, max = {max}, scale = \"log\", start = {start} }}")?;
        }
        writeln!(f)
    }
}

const fn why_useless(content: &Content) -> &'static str {
    match content {
        Content::Empty => "empty",
        Content::Numbers => "constant",
        Content::Text => "text",
        Content::Instants(_) => "times",
        Content::Labels(_) => "no value appears twice",
    }
}

/// The first few, and how many more there are: comments stay short in wide logs.
fn some(mut texts: impl ExactSizeIterator<Item = String>) -> String {
    let shown: Vec<String> = texts.by_ref().take(6).collect();
    let rest = if texts.len() > 0 { format!(" and {} more", texts.len()) } else { String::new() };
    shown.join(", ") + &rest
}

/// A TOML number of three significant digits.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded < 1e5 { format!("{rounded:?}") } else { format!("{rounded:e}") }
}

/// A TOML string on one line, which may also stand as a key.
fn quoted(text: &str) -> String {
    let escape = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}

/// A TOML key.
fn key(text: &str) -> String {
    let is_bare = !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if is_bare { text.to_owned() } else { quoted(text) }
}

/// A TOML list of strings.
fn list(texts: &[String]) -> String {
    format!("[{}]", texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", "))
}
