//! Repeated runs and their times.

use std::time::{Duration, Instant};

use super::BenchError;
use super::process::cpu_time;

/// Timed evaluations, in seconds.
#[derive(Debug, Default)]
pub(super) struct Times {
    pub(super) wall: Vec<f64>,
    pub(super) cpu: Vec<f64>,
    pub(super) kernel: Vec<f64>,
}

impl Times {
    /// Runs `evaluate`, which returns its time in kernels, at least once, at most `repetitions` times, and not again
    /// once `budget` is spent.
    pub(super) fn measure(
        repetitions: usize,
        budget: Duration,
        mut evaluate: impl FnMut() -> Result<Option<Duration>, BenchError>,
    ) -> Result<Self, BenchError> {
        let mut times = Self::default();
        let begin = Instant::now();
        while times.wall.len() < repetitions && (times.wall.is_empty() || begin.elapsed() < budget) {
            let (start, start_cpu) = (Instant::now(), cpu_time());
            let kernel = evaluate()?;
            times.wall.push(start.elapsed().as_secs_f64());
            let spent = start_cpu.zip(cpu_time()).map(|(start, end)| end.saturating_sub(start));
            times.cpu.extend(spent.map(|spent| spent.as_secs_f64()));
            times.kernel.extend(kernel.map(|kernel| kernel.as_secs_f64()));
        }
        Ok(times)
    }
}

/// The middle value, or the mean of the two middle ones; `None` of nothing.
pub(super) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let upper = sorted.get(sorted.len() / 2)?;
    let lower = sorted.get((sorted.len() - 1) / 2)?;
    Some(0.5 * (lower + upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_or_between_the_middle_two() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0), "odd");
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5), "even");
        assert_eq!(median(&[]), None, "empty");
    }

    #[test]
    fn a_spent_budget_still_times_once_and_a_failure_ends_it() {
        let run = || Ok(Some(Duration::from_millis(3)));
        let times = Times::measure(5, Duration::ZERO, run).unwrap();
        assert_eq!((times.wall.len(), times.kernel), (1, vec![0.003]), "one run, its kernel time");
        let failed = Times::measure(5, Duration::MAX, || Err(BenchError::Zero("x")));
        assert!(matches!(failed, Err(BenchError::Zero("x"))), "{failed:?}");
    }
}
