//! How a log writes its times.

use std::borrow::Cow;
use std::sync::Arc;

use jiff::Timestamp;

use super::{Log, TimeUnit, Trajectory};

/// Unit, origin and texts of a log's times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Times {
    /// What the times of its trajectories count.
    pub unit: TimeUnit,
    /// Where time 0 is.
    pub origin: Origin,
    texts: Arc<Texts>,
}

/// Where time 0 of a log is.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Origin {
    /// The log's own zero.
    #[default]
    Zero,
    /// The first row, which this number stands in: more digits than a double holds.
    Number(String),
    /// The first row, at this instant.
    Instant(Timestamp),
    /// The first row, at this time of a day that the log does not tell (here 1970-01-01).
    TimeOfDay(Timestamp),
}

/// Time cells that are not the plain number of their row, by line.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Texts {
    lines: Vec<u64>,
    ends: Vec<usize>,
    text: String,
}

impl Times {
    /// Times of no file, from 0.
    #[must_use]
    pub fn counting(unit: TimeUnit) -> Self {
        Self { unit, ..Self::default() }
    }

    pub(super) fn new(unit: TimeUnit, origin: Origin, texts: Texts) -> Self {
        Self { unit, origin, texts: Arc::new(texts) }
    }
}

impl Texts {
    /// Keeps the cell of a later line than any before.
    pub(super) fn push(&mut self, line: u64, text: &str) {
        self.lines.push(line);
        self.text.push_str(text);
        self.ends.push(self.text.len());
    }

    fn get(&self, line: u64) -> Option<&str> {
        let at = self.lines.binary_search(&line).ok()?;
        let start = at.checked_sub(1).map_or(0, |before| self.ends[before]);
        Some(&self.text[start..self.ends[at]])
    }
}

/// The shortest text that reads back as the same bits.
fn number(time: f64) -> String {
    if time.abs() > 0.0 && !(1e-5..1e16).contains(&time.abs()) { format!("{time:e}") } else { time.to_string() }
}

impl Log {
    /// The time of row `k` of a trajectory of this log, as its file writes it.
    #[must_use]
    pub fn time_text(&self, trajectory: &Trajectory, k: usize) -> Cow<'_, str> {
        let kept = trajectory.line.get(k).and_then(|line| self.times.texts.get(*line));
        kept.map_or_else(|| number(trajectory.time[k]).into(), Cow::Borrowed)
    }

    /// The first and the last time as the file writes them; `None` where times count from its own zero.
    #[must_use]
    pub fn stamps(&self) -> Option<[String; 2]> {
        if self.times.origin == Origin::Zero {
            return None;
        }
        let rows = || self.trajectories.iter().flat_map(|t| (0..t.len()).map(move |k| (t, k)));
        let earlier = |a: &(&Trajectory, usize), b: &(&Trajectory, usize)| a.0.time[a.1].total_cmp(&b.0.time[b.1]);
        let ends = [rows().min_by(earlier)?, rows().max_by(earlier)?];
        Some(ends.map(|(t, k)| self.time_text(t, k).into_owned()))
    }
}
