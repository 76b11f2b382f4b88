//! The drafted problem file as commented TOML.

use std::fmt;

use super::MARK;
use super::estimate::{Axis, Motion};
use super::roles::{Roles, identifier};
use super::survey::{Content, Survey};
use super::{clockwork, series};
use crate::data::{DataSpec, Format, Log, Trajectory};

/// Everything the file says; printing it gives the file.
pub(super) struct Page<'a> {
    pub(super) survey: &'a Survey,
    pub(super) roles: &'a Roles,
    pub(super) data: &'a DataSpec,
    pub(super) motion: Motion,
    pub(super) axes: &'a [Axis],
    pub(super) states: &'a [String],
    /// What the user should know, in sentences.
    pub(super) said: &'a [String],
    pub(super) start: &'a Start,
    /// The unit of each axis, empty where it is not known.
    pub(super) units: &'a [String],
}

/// Where the filter starts.
pub(super) enum Start {
    /// At the first complete measurement of each trajectory.
    Measurement,
    /// Somewhere no row measures all at once: positions, each its own first value, and their variances.
    Numbers(Vec<(f64, f64)>),
}

impl Start {
    /// From the measurements of `log` that come first, one an axis.
    pub(super) fn of(log: &Log, axes: &[Axis]) -> Self {
        // A sensor that is not taken must not count.
        let complete = |t: &Trajectory| (0..t.len()).any(|k| t.z.row(k)[..axes.len()].iter().all(|z| !z.is_nan()));
        if log.trajectories.iter().all(complete) {
            return Self::Measurement;
        }
        Self::Numbers(axes.iter().enumerate().map(|(i, axis)| first_of(log, i, axis)).collect())
    }
}

/// The first value of an axis, and how far from it those of other trajectories and the values that follow are; at most
/// 1e4 times its noise, which is as good as no knowledge.
fn first_of(log: &Log, i: usize, axis: &Axis) -> (f64, f64) {
    let firsts = series::firsts(log, i);
    let first = firsts.first().copied().unwrap_or(0.0);
    let values = log.trajectories.iter().flat_map(|t| t.z.column(i)).filter(|z| !z.is_nan());
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), z| (sum + (z - first).powi(2), count + 1.0));
    let spread = if count > 0.0 { sum / count } else { 0.0 };
    let apart = firsts.iter().map(|z| (z - first).powi(2)).fold(0.0, f64::max);
    let variance = apart.max(spread.min(1e4 * axis.r)).max(axis.r);
    (first, if variance.is_finite() { variance } else { axis.r })
}

impl fmt::Display for Page<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.survey.lines.len();
        let file = self.data.file.as_deref().unwrap_or_default();
        writeln!(f, "{MARK}{file:?} ({rows} rows). Columns are guessed from names and content, starts and")?;
        writeln!(f, "# bounds are rough estimates from the data: check both, then run `kfgpu tune` on this file.")?;
        for sentence in self.said {
            writeln!(f, "# Note: {}.", sentence.replace(char::is_control, " "))?;
        }
        writeln!(f)?;
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
        self.file_keys(f)?;
        match (&data.time, &self.roles.false_time) {
            (Some(time), _) => writeln!(f, "time = {}   # {}", quoted(time), self.time_unit())?,
            (None, Some(stop)) => {
                let name = &self.survey.columns[stop.column].name;
                writeln!(
                    f,
                    "# Column {name:?} cannot be the time: it {} at line {}, so rows count",
                    stop.how, stop.line
                )?;
                writeln!(f, "# 0, 1, 2, ... s; {}.", clockwork::remedy(stop.how))?;
            }
            (None, None) => writeln!(f, "# No column increases from row to row, so rows count 0, 1, 2, ... s.")?,
        }
        if let Some(unit) = data.time_unit {
            let name = unit.name();
            let counts =
                if unit.decimals() > 0 { "guessed from name and size; dt is in seconds" } else { "what dt counts" };
            writeln!(f, "time_unit = \"{name}\"   # {counts}")?;
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

    /// How the file is written, where that is not as usual.
    fn file_keys(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Format { separator, decimal_comma, thousands, header_line, skip_lines } = &self.data.format;
        if let Some(separator) = separator {
            writeln!(f, "separator = {}", quoted(&separator.to_string()))?;
        }
        if *decimal_comma {
            writeln!(f, "decimal = \",\"")?;
        }
        if let Some(mark) = thousands {
            writeln!(f, "thousands = {}", quoted(&mark.to_string()))?;
        }
        if let Some(line) = header_line {
            writeln!(f, "header_line = {line}   # lines before it are left out")?;
        }
        if !skip_lines.is_empty() {
            writeln!(f, "skip_lines = {skip_lines:?}   # hold no row of numbers")?;
        }
        Ok(())
    }

    fn time_unit(&self) -> &'static str {
        match self.roles.time.map(|i| &self.survey.columns[i].content) {
            Some(Content::Instants(_)) => "counts from the first row",
            _ if self.data.time_unit.is_some() => "numbers",
            _ => "taken as seconds",
        }
    }

    /// Comments on every column that is not used.
    fn left_out(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let column = |i: usize| &self.survey.columns[i];
        let is_truth = |i: &usize| self.roles.truth.iter().any(|(_, truth)| truth == i);
        let of = |columns: &[usize]| some(columns.iter().map(|&i| format!("{:?}", column(i).name)));
        let no_time = self.roles.false_time.as_ref().map(|stop| stop.column);
        let unused = (0..self.survey.columns.len()).filter(|&i| !self.uses(&column(i).name) && Some(i) != no_time);
        let (truth, unused): (Vec<usize>, Vec<usize>) = unused.partition(is_truth);
        let (numbers, useless): (Vec<usize>, Vec<usize>) = unused.into_iter().partition(|&i| column(i).varies());
        if !numbers.is_empty() {
            let taken = self.data.measurements.len();
            writeln!(f, "# Measurements taken: {taken}; not taken: {}.", of(&numbers))?;
            writeln!(f, "# Known inputs among them would be named in `inputs` (and stand in formulas).")?;
            let named = |i: &&usize| identifier(&column(**i).name) != column(**i).name;
            let unfit: Vec<usize> = numbers.iter().filter(named).copied().collect();
            if !unfit.is_empty() {
                writeln!(
                    f,
                    "# For that, rename in the file what cannot stand in formulas (letters, digits, _): {}.",
                    of(&unfit)
                )?;
            }
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
        let Start::Numbers(positions) = self.start else {
            writeln!(
                f,
                "x0 = \"measurement\"   # the first complete one of each trajectory, as uncertain as any other;"
            )?;
            return writeln!(f, "P0 = [{}]   # what it does not measure varies as in the log\n", p0.join(", "));
        };
        let velocities = p0.len() - positions.len();
        let x0 = positions.iter().map(|(x, _)| exact(*x)).chain(vec!["0".to_owned(); velocities]);
        for (variance, (_, spread)) in p0.iter_mut().zip(positions) {
            *variance = number(*spread);
        }
        writeln!(
            f,
            "# No row measures everything at once (in every trajectory), so each state starts at its own first value."
        )?;
        writeln!(f, "x0 = [{}]\nP0 = [{}]   # varies as in the log\n", x0.collect::<Vec<_>>().join(", "), p0.join(", "))
    }

    fn parameters(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = self.data.time_unit.unwrap_or_default().counted();
        let per = if self.motion == Motion::ConstantVelocity { format!("{time}^3") } else { time.to_owned() };
        writeln!(
            f,
            "[parameters]\n# r from second differences, q [unit^2/{per}] from how fast changes grow with lag;"
        )?;
        writeln!(f, "# bounds 1e-4 and 1e4 times that.")?;
        let r = self.axes.iter().zip(self.units).map(|(a, unit)| ("r", &a.name, a.r, squared(unit)));
        let q = self.axes.iter().zip(self.units).map(|(a, unit)| ("q", &a.name, a.q, squared(unit) + "/" + &per));
        for (kind, axis, start, unit) in r.chain(q) {
            let (min, max) = (number(1e-4 * start), number(1e4 * start));
            let start = number(start);
            let unit = if unit.starts_with(['/', '^']) || unit.is_empty() {
                String::new()
            } else {
                format!(", unit = {}", quoted(&unit))
            };
            writeln!(f, "{kind}_{axis} = {{ min = {min}, max = {max}, scale = \"log\", start = {start}{unit} }}")?;
        }
        writeln!(f)
    }
}

/// The square of a unit, which may be a product or quotient itself.
fn squared(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit if unit.chars().all(char::is_alphabetic) => format!("{unit}^2"),
        unit => format!("({unit})^2"),
    }
}

/// A TOML number that reads back as the same bits.
fn exact(value: f64) -> String {
    if value.abs() < 1e15 { format!("{value:?}") } else { format!("{value:e}") }
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
