//! Series that are thinned while they are collected, so that a picture of any log takes the same memory.

use super::thin::Stretch;

/// Rows kept of a series; about five times what a picture shows side by side.
const ROWS: usize = 4000;
/// Intervals beyond this many times a usual one are gaps in time, across which no line is drawn.
const GAP: f64 = 10.0;

/// A series over time in at most [`ROWS`] stretches: the first value of each, and the lowest and highest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Envelope {
    /// Rows of the log in one stretch.
    every: usize,
    seen: usize,
    rows: Vec<Stretch>,
}

impl Envelope {
    /// For a series of `length` rows.
    pub(crate) fn new(length: usize) -> Self {
        Self { every: length.div_ceil(ROWS).max(1), seen: 0, rows: Vec::new() }
    }

    /// The next value; NaN is a gap where a whole stretch has no other.
    pub(crate) fn push(&mut self, time: f64, value: f64) {
        self.push_band(time, [value, value]);
    }

    /// The next lower and upper edge of a band.
    pub(crate) fn push_band(&mut self, time: f64, [low, high]: [f64; 2]) {
        if self.seen.is_multiple_of(self.every) {
            self.rows.push(Stretch::of((time, low)));
        }
        if let Some(last) = self.rows.last_mut() {
            last.add((time, low));
            last.add((time, high));
        }
        self.seen += 1;
    }

    /// As a line: up and down in every stretch, broken at gaps in time.
    pub(crate) fn line(&self) -> impl Iterator<Item = (f64, f64)> {
        let points = if self.every == 1 { 1 } else { 2 };
        let of = move |s: &Stretch| [(s.first.0, s.low.1), (s.first.0, s.high.1)].into_iter().take(points);
        broken(&self.rows, |s| s.first.0, of, (f64::NAN, f64::NAN))
    }

    /// As points: of each stretch its ends and one more.
    pub(crate) fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let points = if self.every == 1 { 1 } else { 3 };
        let of = move |s: &Stretch| [s.first, (s.first.0, s.low.1), (s.first.0, s.high.1)].into_iter().take(points);
        self.rows.iter().flat_map(of)
    }

    /// As a band, broken at gaps in time.
    pub(crate) fn band(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let of = |s: &Stretch| std::iter::once((s.first.0, [s.low.1, s.high.1]));
        broken(&self.rows, |s| s.first.0, of, (f64::NAN, [f64::NAN; 2]))
    }

    /// Rows of the log that one drawn stretch stands for.
    pub(crate) const fn every(&self) -> usize {
        self.every
    }

    /// Whether there is any value at all.
    pub(crate) fn has_values(&self) -> bool {
        self.rows.iter().any(|s| s.low.1.is_finite() || s.high.1.is_finite())
    }
}

/// What `of` makes of each row, with `gap` between rows whose times are much farther apart than usual.
pub(crate) fn broken<R, T: Copy, I: IntoIterator<Item = T>>(
    rows: &[R],
    time: impl Fn(&R) -> f64,
    of: impl Fn(&R) -> I,
    gap: T,
) -> std::vec::IntoIter<T> {
    let longest = longest(rows.iter().map(&time));
    let mut drawn = Vec::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        if i > 0 && time(row) - time(&rows[i - 1]) > longest {
            drawn.push(gap);
        }
        drawn.extend(of(row));
    }
    drawn.into_iter()
}

/// The interval between times that is no gap yet: so many times that which 19 in 20 do not exceed. One that a log takes
/// now and then, as every weekend, is usual.
pub(crate) fn longest(times: impl Iterator<Item = f64>) -> f64 {
    let times: Vec<f64> = times.collect();
    let mut intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    intervals.sort_by(f64::total_cmp);
    GAP * intervals.get(intervals.len() * 19 / 20).copied().unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_in_time_breaks_the_line_and_a_weekend_does_not() {
        let drawn = |times: &[f64]| {
            let mut series = Envelope::new(times.len());
            times.iter().for_each(|t| series.push(*t, 1.0));
            let gaps = |all: Vec<f64>| all.iter().filter(|t| t.is_nan()).count();
            (gaps(series.line().map(|p| p.0).collect()), gaps(series.band().map(|row| row.0).collect()))
        };
        let steady: Vec<f64> = (0..100).map(f64::from).collect();
        let weekends: Vec<f64> = steady.iter().map(|t| t + 2.0 * (t / 5.0).floor()).collect();
        let away: Vec<f64> = steady.iter().map(|t| if *t < 50.0 { *t } else { t + 40.0 }).collect();
        assert_eq!([steady, weekends, away].map(|times| drawn(&times)), [(0, 0), (0, 0), (1, 1)]);
    }

    #[test]
    fn a_short_series_stays_as_it_is() {
        let mut series = Envelope::new(3);
        let rows = [(0.0, 1.0), (1.0, -2.0), (2.0, 5.0)];
        rows.iter().for_each(|(t, v)| series.push(*t, *v));
        assert_eq!(series.line().collect::<Vec<_>>(), rows);
        assert_eq!(series.points().collect::<Vec<_>>(), rows);
    }

    #[test]
    fn a_long_series_keeps_its_extremes_and_gaps() {
        let mut series = Envelope::new(1_000_000);
        for k in 0..1_000_000u32 {
            let gap = (500_000..600_000).contains(&k);
            let spike = if k == 123_456 { 9.0 } else { 0.0 };
            series.push(f64::from(k), if gap { f64::NAN } else { spike });
        }
        assert_eq!(series.rows.len(), ROWS);
        assert!(series.line().any(|(_, v)| v > 8.9), "the spike is gone");
        let gaps = series.line().filter(|(_, v)| v.is_nan()).count();
        assert_eq!(gaps, 2 * ROWS / 10, "a tenth of the series is a gap");
    }
}
