//! Values of one column over time.

use crate::data::{Log, Trajectory};

/// An interval this many times the median one is a gap: what happened in it says nothing about a step.
const JUMP: f64 = 10.0;

/// Present values of one column in one trajectory, with their times.
pub(super) struct Series {
    pub(super) time: Vec<f64>,
    pub(super) value: Vec<f64>,
}

/// The present values of measurement `i`, trajectory by trajectory, parted where time jumps.
pub(super) fn series(log: &Log, i: usize) -> Vec<Series> {
    let one = |t: &Trajectory| {
        let present = || (0..t.len()).filter(|&k| !t.z.row(k)[i].is_nan());
        Series { time: present().map(|k| t.time[k]).collect(), value: present().map(|k| t.z.row(k)[i]).collect() }
    };
    let whole: Vec<Series> = log.trajectories.iter().map(one).collect();
    let jump = JUMP * median(whole.iter().flat_map(Series::intervals).collect());
    whole.iter().flat_map(|series| series.parted(jump)).collect()
}

/// The first value of measurement `i` in every trajectory that has one.
pub(super) fn firsts(log: &Log, i: usize) -> Vec<f64> {
    log.trajectories.iter().filter_map(|t| t.z.column(i).find(|z| !z.is_nan())).collect()
}

impl Series {
    /// Intervals between values.
    pub(super) fn intervals(&self) -> impl Iterator<Item = f64> {
        self.time.windows(2).map(|w| w[1] - w[0])
    }

    fn parted(&self, jump: f64) -> Vec<Self> {
        let ends = self.intervals().enumerate().filter(|(_, dt)| *dt > jump).map(|(k, _)| k + 1);
        let (mut parts, mut start) = (Vec::new(), 0);
        for end in ends.chain([self.time.len()]) {
            parts.push(Self { time: self.time[start..end].to_vec(), value: self.value[start..end].to_vec() });
            start = end;
        }
        parts
    }
}

/// NaN of no values; the upper of the middle two of an even number.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
