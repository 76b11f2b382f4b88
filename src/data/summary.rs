//! What a log holds, at a glance: shown before any work starts.

use std::fmt;

use super::{Log, TimeUnit, Trajectory};

/// Rows, times and gaps of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Where the log came from.
    pub source: String,
    /// Total number of rows.
    pub rows: usize,
    /// Number of trajectories.
    pub trajectories: usize,
    /// First and last time of the log.
    pub span: [f64; 2],
    /// The cells that they stand in, where those are not plain numbers.
    pub stamps: Option<[String; 2]>,
    /// What times count.
    pub unit: TimeUnit,
    /// Intervals between rows; `None` when no trajectory has rows at two times.
    pub dt: Option<Intervals>,
    /// Gaps in each measurement, input and truth column, in that order.
    pub columns: Vec<ColumnSummary>,
}

/// Intervals between rows at different times.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Intervals {
    pub min: f64,
    pub median: f64,
    pub max: f64,
    /// Whether all are equal, to one part in 1e9 of the first.
    pub regular: bool,
    /// Number of rows at the time of the row before.
    pub together: usize,
}

/// Gaps in one column.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnSummary {
    /// Column name; for truth the state's name.
    pub name: String,
    /// `measurement`, `input` or `truth`.
    pub role: &'static str,
    /// Number of rows without a value.
    pub missing: usize,
    /// [`Self::missing`] as a share of all rows, 0 to 1.
    pub share: f64,
}

impl Summary {
    /// Summarises a log.
    #[must_use]
    pub fn of(log: &Log) -> Self {
        let times = || log.trajectories.iter().flat_map(|t| &t.time).copied();
        let columns = [
            gaps(log, "measurement", &log.measurements, |t, k| t.z.row(k)),
            gaps(log, "input", &log.inputs, |t, k| t.u.row(k)),
            gaps(log, "truth", &log.truth, |t, k| t.truth.row(k)),
        ];
        Self {
            source: log.source.clone(),
            rows: log.rows(),
            trajectories: log.trajectories.len(),
            span: [times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)],
            stamps: log.stamps(),
            unit: log.times.unit,
            dt: Intervals::of(log),
            columns: columns.concat(),
        }
    }
}

impl Intervals {
    /// `None` when no trajectory has rows at two times.
    #[must_use]
    pub fn of(log: &Log) -> Option<Self> {
        let mut all: Vec<f64> = log.trajectories.iter().flat_map(|t| (0..t.len()).filter_map(|k| t.dt(k))).collect();
        let rows = all.len();
        all.retain(|dt| *dt > 0.0);
        let first = *all.first()?;
        let regular = all.iter().all(|dt| (dt - first).abs() <= 1e-9 * first);
        let together = rows - all.len();
        let middle = (all.len() - 1) / 2;
        let even = all.len().is_multiple_of(2);
        let (below, &mut lower, above) = all.select_nth_unstable_by(middle, f64::total_cmp);
        let next = above.iter().copied().fold(f64::INFINITY, f64::min);
        Some(Self {
            min: below.iter().copied().fold(lower, f64::min),
            median: if even { 0.5 * (lower + next) } else { lower },
            max: above.iter().copied().fold(lower, f64::max),
            regular,
            together,
        })
    }
}

fn gaps(log: &Log, role: &'static str, names: &[String], row: fn(&Trajectory, usize) -> &[f64]) -> Vec<ColumnSummary> {
    let mut missing = vec![0; names.len()];
    for t in &log.trajectories {
        for k in 0..t.len() {
            missing.iter_mut().zip(row(t, k)).for_each(|(count, value)| *count += usize::from(value.is_nan()));
        }
    }
    let column = |(name, missing): (&String, usize)| ColumnSummary {
        name: name.clone(),
        role,
        missing,
        share: missing as f64 / log.rows().max(1) as f64,
    };
    names.iter().zip(missing).map(column).collect()
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
        let rows = plural(self.rows, "row", "rows");
        let trajectories = plural(self.trajectories, "trajectory", "trajectories");
        write!(f, "{}: {rows} in {trajectories}, time ", self.source)?;
        let ([first, last], unit) = (self.span, |count| self.unit.after(count));
        match &self.stamps {
            Some([from, to]) => writeln!(f, "{from} to {to} ({} {})", Short(last - first), unit(last - first))?,
            None => writeln!(f, "{} to {} {}", Long(first, last - first), Long(last, last - first), unit(last))?,
        }
        let together = |dt: &Intervals| match dt.together {
            0 => String::new(),
            n => format!("; {} at the time of the row before", plural(n, "row", "rows")),
        };
        match self.dt {
            None => writeln!(f, "  dt: none (single rows)")?,
            Some(dt) if dt.regular => {
                writeln!(f, "  dt: {} {}, regular{}", Short(dt.median), unit(dt.median), together(&dt))?;
            }
            Some(dt) => {
                let (min, median, max) = (Short(dt.min), Short(dt.median), Short(dt.max));
                let unit = unit(dt.max);
                writeln!(f, "  dt: min {min}, median {median}, max {max} {unit}, irregular{}", together(&dt))?;
            }
        }
        let with_gaps: Vec<String> = self.columns.iter().filter(|c| c.missing > 0).map(ToString::to_string).collect();
        if with_gaps.is_empty() {
            let columns = plural(self.columns.len(), "column", "columns");
            write!(f, "  missing: none in {columns}")
        } else {
            write!(f, "  missing: {}", with_gaps.join(", "))
        }
    }
}

impl fmt::Display for ColumnSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let role = if self.role == "measurement" { String::new() } else { format!("{} ", self.role) };
        write!(f, "{role}{} {} ({:.1} %)", self.name, self.missing, 100.0 * self.share)
    }
}

/// A number to six significant digits.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Long(self.0, f64::INFINITY).fmt(f)
    }
}

/// A number to six significant digits, or to as many more as tell it from one this far away to three.
struct Long(f64, f64);

impl fmt::Display for Long {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, apart) = *self;
        let places = (value.abs() / apart).log10();
        // A cast saturates; a double has no more than 17 digits.
        let decimals = if places.is_finite() { (places.ceil() as usize + 3).clamp(5, 16) } else { 5 };
        let rounded: f64 = format!("{value:.decimals$e}").parse().unwrap_or(value);
        if (1e-300..1e-4).contains(&rounded.abs()) { write!(f, "{rounded:e}") } else { write!(f, "{rounded}") }
    }
}
