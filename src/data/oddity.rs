//! Values that a sensor hardly measured: placeholders, frozen readings, spikes and jumps.
//!
//! Everything is compared with robust scales of the column itself (medians of differences), so that quantised, integer
//! and resting sensors raise no alarm.
#![expect(clippy::float_cmp, reason = "a frozen reading and a placeholder are the same number again")]

use std::collections::{HashMap, HashSet};
use std::fmt;

use super::{Log, Trajectory};

/// Something odd in one column.
#[derive(Debug, Clone, PartialEq)]
pub struct Oddity {
    /// The column.
    pub column: String,
    /// What is odd.
    pub kind: Kind,
    /// How many rows of this kind the column has.
    pub rows: usize,
    /// 1-based line of the first.
    pub line: u64,
}

/// What is odd.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// One value again and again, far from all others: what a logger writes where nothing was measured.
    Placeholder(f64),
    /// Exactly 0 until the first value, which is far from 0.
    LeadingZero,
    /// One value for many rows of a column that else changes from row to row.
    Frozen(f64),
    /// Single values far from those around them, the first this far.
    Spike(f64),
    /// The level changes by this within one row, and stays.
    Jump(f64),
}

/// Numbers that loggers write where nothing was measured, and 0.
const PLACEHOLDERS: [f64; 14] = [
    0.0,
    -1.0,
    99.0,
    999.0,
    -99.0,
    -999.0,
    9999.0,
    -9999.0,
    99999.0,
    -99999.0,
    -32768.0,
    32767.0,
    65535.0,
    2_147_483_647.0,
];
/// From this size on a number is no measurement in any unit.
const ABSURD: f64 = 1e29;
/// A placeholder is this many ranges (of the middle half of the values) away from them.
const FAR: f64 = 10.0;
/// A spike or jump is this many scales of the differences.
const LEAP: f64 = 20.0;
/// Values before and after a leap that tell its kind.
const AROUND: usize = 5;
/// Fewest values from which a scale is taken.
const FEWEST: usize = 20;
/// Fewest rows that are frozen, and the chance that such a run arises where one of this length is expected by chance.
const FROZEN: usize = 10;
const CHANCE: f64 = 1e-6;

impl Oddity {
    /// All oddities of the measurements of a log, column by column. What jumps in a log with inputs may follow one of them.
    #[must_use]
    pub fn of(log: &Log) -> Vec<Self> {
        let mut all = Vec::new();
        for (i, column) in log.measurements.iter().enumerate() {
            let mut found = Column::of(log, i).oddities();
            found.retain(|(kind, ..)| log.inputs.is_empty() || !matches!(kind, Kind::Jump(_)));
            all.extend(found.into_iter().map(|(kind, rows, line)| Self { column: column.clone(), kind, rows, line }));
        }
        all
    }
}

impl fmt::Display for Oddity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { column, kind, rows, line } = self;
        let row = if *rows == 1 { "row" } else { "rows" };
        match kind {
            Kind::Placeholder(value) => write!(
                f,
                "column {column:?} is {} in {rows} {row}, first in line {line}, far from its other values: if nothing was \
                 measured there, empty the cells",
                Short(*value)
            ),
            Kind::LeadingZero => write!(
                f,
                "column {column:?} is 0 in {rows} {row} from line {line} on, until its first value: if nothing was measured \
                 there, empty the cells"
            ),
            Kind::Frozen(value) => write!(
                f,
                "column {column:?} stands at {} for {rows} {row} from line {line} on, though it changes elsewhere: if the \
                 sensor was frozen, empty the cells after the first",
                Short(*value)
            ),
            Kind::Spike(size) => write!(
                f,
                "column {column:?} leaps by {} and back in line {line} ({rows} such {row}): if it is an outlier, empty the \
                 cell",
                Short(*size)
            ),
            Kind::Jump(size) => write!(
                f,
                "column {column:?} jumps by {} in line {line} and stays there ({rows} such {row}): no noise of a constant \
                 size explains that; if the sensor was reset, split the log there (`trajectory`)",
                Short(*size)
            ),
        }
    }
}

/// A number to four significant digits.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.3e}", self.0).parse().unwrap_or(self.0);
        if (1e-4..1e7).contains(&rounded.abs()) || rounded == 0.0 {
            write!(f, "{rounded}")
        } else {
            write!(f, "{rounded:e}")
        }
    }
}

/// A value with its time and line.
#[derive(Debug, Clone, Copy)]
struct Sample {
    time: f64,
    value: f64,
    line: u64,
}

/// Present values of one column, trajectory by trajectory.
struct Column {
    runs: Vec<Vec<Sample>>,
}

type Found = (Kind, usize, u64);

impl Column {
    fn of(log: &Log, i: usize) -> Self {
        let samples = |t: &Trajectory| {
            let all = (0..t.len()).map(|k| Sample { time: t.time[k], value: t.z.row(k)[i], line: t.line[k] });
            all.filter(|s| !s.value.is_nan()).collect()
        };
        Self { runs: log.trajectories.iter().map(samples).collect() }
    }

    fn oddities(mut self) -> Vec<Found> {
        let mut found = self.placeholders();
        for (kind, ..) in &found {
            if let Kind::Placeholder(value) = *kind {
                self.runs.iter_mut().for_each(|run| run.retain(|s| s.value != value));
            }
        }
        found.extend(self.leading_zeros());
        self.runs.iter_mut().for_each(|run| {
            let zeros = run.iter().take_while(|s| s.value == 0.0).count();
            if found.iter().any(|(kind, ..)| *kind == Kind::LeadingZero) {
                run.drain(..zeros);
            }
        });
        found.extend(self.frozen());
        found.extend(self.leaps());
        found
    }

    fn samples(&self) -> impl Iterator<Item = &Sample> {
        self.runs.iter().flatten()
    }

    /// Known placeholders, absurd numbers, and repeated extremes, that are far from the middle half of the values.
    fn placeholders(&self) -> Vec<Found> {
        let mut counts: HashMap<u64, (usize, u64)> = HashMap::new();
        let sizes: Vec<f64> = self.samples().map(|s| s.value.abs()).collect();
        if sizes.is_empty() {
            return Vec::new();
        }
        // Unless all values are of that size.
        let absurd = ABSURD.max(1e6 * median(sizes));
        let is_known = |v: f64| PLACEHOLDERS.contains(&v) || v.abs() >= absurd;
        for s in self.samples().filter(|s| is_known(s.value)) {
            // Both zeros are one.
            counts.entry((s.value + 0.0).to_bits()).or_insert((0, s.line)).0 += 1;
        }
        let others: Vec<f64> = self.samples().map(|s| s.value).filter(|v| v.abs() < absurd).collect();
        let mut found: Vec<Found> = counts
            .into_iter()
            .map(|(bits, (count, line))| (f64::from_bits(bits), count, line))
            .filter(|&(value, count, _)| value.abs() >= absurd || is_far(value, count, &others))
            .map(|(value, count, line)| (Kind::Placeholder(value), count, line))
            .collect();
        found.sort_by_key(|(_, _, line)| *line);
        found
    }

    /// Zeros at the beginning of a trajectory, before values that stay away from 0.
    fn leading_zeros(&self) -> Option<Found> {
        let scale = self.scale()?;
        let mut rows = 0;
        let mut line = None;
        for run in &self.runs {
            let zeros = run.iter().take_while(|s| s.value == 0.0).count();
            let rest = &run[zeros..];
            let least = rest.iter().map(|s| s.value.abs()).fold(f64::INFINITY, f64::min);
            if zeros > 0 && rest.len() >= FEWEST && least > LEAP * scale {
                rows += zeros;
                line = line.or(Some(run[0].line));
            }
        }
        line.map(|line| (Kind::LeadingZero, rows, line))
    }

    /// The longest run of one value, where such a run is no chance.
    fn frozen(&self) -> Option<Found> {
        let (mut pairs, mut equal) = (0_usize, 0_usize);
        let mut longest: (usize, Option<Sample>) = (0, None);
        for run in &self.runs {
            let mut length = 1;
            for w in run.windows(2) {
                pairs += 1;
                length = if w[0].value == w[1].value { length + 1 } else { 1 };
                equal += usize::from(length > 1);
                if length > longest.0 {
                    longest = (length, Some(w[1]));
                }
            }
        }
        let (length, Some(end)) = longest else { return None };
        let (pairs, equal) = (pairs - (length - 1), equal - (length - 1));
        if length < FROZEN || pairs < FEWEST || self.is_coarse() {
            return None;
        }
        // Laplace's rule of succession: the share of pairs that are equal elsewhere.
        let share = (equal + 1) as f64 / (pairs + 2) as f64;
        let by_chance = share.powf((length - 1) as f64) * (pairs + length) as f64;
        let start = self.start_of(end, length)?;
        (share < 0.2 && by_chance < CHANCE).then_some((Kind::Frozen(end.value), length, start))
    }

    /// Whether few values make up the column, so that a sensor at rest shows one of them for long.
    fn is_coarse(&self) -> bool {
        let mut distinct = HashSet::new();
        self.samples().all(|s| {
            distinct.insert(s.value.to_bits());
            distinct.len() <= FEWEST
        })
    }

    /// Line of the first of `length` equal values that end with `end`.
    fn start_of(&self, end: Sample, length: usize) -> Option<u64> {
        let run = self.runs.iter().find(|run| run.iter().any(|s| s.line == end.line))?;
        let last = run.iter().position(|s| s.line == end.line)?;
        Some(run[last + 1 - length].line)
    }

    /// Differences between neighbours in time far beyond the usual ones: what comes back is a spike, what stays a jump.
    fn leaps(&self) -> Vec<Found> {
        let Some(scale) = self.scale() else { return Vec::new() };
        let (mut spikes, mut jumps) = ((0, None), (0, None));
        for run in &self.runs {
            let usual = usual_interval(run);
            let mut k = 1;
            while k < run.len() {
                let leap = run[k].value - run[k - 1].value;
                let near = run[k].time - run[k - 1].time <= 3.0 * usual;
                if near && leap.abs() > LEAP * scale && leap.abs() > LEAP * local_scale(run, k) {
                    let (before, after) = (&run[k.saturating_sub(AROUND)..k], &run[(k + 1).min(run.len())..]);
                    let after = &after[..after.len().min(AROUND)];
                    let stays = middle(after) - middle(before);
                    let (kind, width) = match after.len() {
                        _ if stays.abs() < 0.3 * leap.abs() => (&mut spikes, width(run, k, leap)),
                        AROUND if (stays / leap - 1.0).abs() < 0.3 => (&mut jumps, 1),
                        _ => {
                            k += 1;
                            continue;
                        }
                    };
                    kind.0 += width;
                    kind.1 = kind.1.or(Some((leap, run[k].line)));
                    // The way back of a spike is not another.
                    k += width;
                }
                k += 1;
            }
        }
        let found = |(rows, first): (usize, Option<(f64, u64)>), kind: fn(f64) -> Kind| {
            first.map(|(leap, line)| (kind(leap), rows, line))
        };
        found(spikes, Kind::Spike).into_iter().chain(found(jumps, Kind::Jump)).collect()
    }

    /// Standard deviation of differences between neighbours in time, from their median size; of those that are not 0
    /// where most are. `None` for too few, or values that never change.
    fn scale(&self) -> Option<f64> {
        let mut sizes: Vec<f64> = Vec::new();
        for run in &self.runs {
            let usual = usual_interval(run);
            sizes.extend(run.windows(2).filter(|w| w[1].time - w[0].time <= 3.0 * usual).map(size));
        }
        if sizes.len() < FEWEST {
            return None;
        }
        let scale = SIGMA_OVER_MEDIAN * median(sizes.clone());
        if scale > 0.0 {
            return Some(scale);
        }
        sizes.retain(|size| *size > 0.0);
        (sizes.len() >= AROUND).then(|| SIGMA_OVER_MEDIAN * median(sizes))
    }
}

/// Of a normal distribution: 1 / (quantile of 3/4).
const SIGMA_OVER_MEDIAN: f64 = 1.482_602_218_505_602;

/// How many values a spike at `k` lasts.
fn width(run: &[Sample], k: usize, leap: f64) -> usize {
    let level = run[k - 1].value;
    run[k..].iter().take(AROUND).take_while(|s| (s.value - level) / leap > 0.5).count()
}

/// Scale of the differences around `k`, without those at it: what moves fast there may move faster.
fn local_scale(run: &[Sample], k: usize) -> f64 {
    let before = run[k.saturating_sub(10)..k].windows(2).map(size);
    let after = run[(k + 2).min(run.len())..(k + 12).min(run.len())].windows(2).map(size);
    let sizes: Vec<f64> = before.chain(after).collect();
    if sizes.is_empty() { 0.0 } else { SIGMA_OVER_MEDIAN * median(sizes) }
}

fn size(pair: &[Sample]) -> f64 {
    (pair[1].value - pair[0].value).abs()
}

fn usual_interval(run: &[Sample]) -> f64 {
    if run.len() < 2 { 0.0 } else { median(run.windows(2).map(|w| w[1].time - w[0].time).collect()) }
}

fn middle(samples: &[Sample]) -> f64 {
    if samples.is_empty() { f64::NAN } else { median(samples.iter().map(|s| s.value).collect()) }
}

/// Whether `value`, which stands in `count` of all `values`, is far from the middle half of the others.
fn is_far(value: f64, count: usize, values: &[f64]) -> bool {
    let mut others: Vec<f64> = values.iter().copied().filter(|v| *v != value).collect();
    if others.len() < FEWEST || others.len() < count {
        return false;
    }
    others.sort_unstable_by(f64::total_cmp);
    let (low, high) = (others[others.len() / 4], others[others.len() * 3 / 4]);
    let (first, last) = (others[0], others[others.len() - 1]);
    // Of coarse values the range is at least one of their steps, of a single one its size.
    let steps = others.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0);
    let step = steps.fold(f64::INFINITY, f64::min);
    let range = (high - low).max(if step.is_finite() { step } else { first.abs().max(1.0) });
    let beyond = value < low - FAR * range || value > high + FAR * range;
    // A number beyond which others go on is no placeholder but part of a long tail.
    let alone = value < first || value > last;
    let nearest = if value < first { first - value } else { value - last };
    beyond && alone && nearest > range
}

/// The upper of the middle two of an even number.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
