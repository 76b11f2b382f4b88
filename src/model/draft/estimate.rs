//! Rough noise variances by the method of moments, good enough to start a search from.

use super::series::{Series, median};

/// Most axes of a built-in model, and of a random walk written as formulas.
const BUILT_IN_AXES: usize = 3;
const FORMULA_AXES: usize = 8;

/// How the state moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// One level that wanders.
    LocalLevel,
    /// Two or three levels that wander.
    RandomWalk,
    /// More levels than a built-in model takes.
    RandomWalkByFormulas,
    /// Up to three positions with their velocities.
    ConstantVelocity,
}

/// One axis of the drafted model.
pub(super) struct Axis {
    pub(super) name: String,
    /// Measurement noise variance [unit^2].
    pub(super) r: f64,
    /// Process noise: of a level [unit^2/T], of a velocity [unit^2/T^3], T the unit of time.
    pub(super) q: f64,
    /// Variance of the velocity at the start [unit^2/T^2].
    pub(super) velocity_variance: f64,
}

impl Motion {
    /// Levels if no column travels; see [`travels`].
    pub(super) fn of(columns: &[Vec<Series>]) -> Self {
        let motion = columns.iter().take(BUILT_IN_AXES).any(|series| travels(series));
        match columns.len() {
            _ if motion => Self::ConstantVelocity,
            1 => Self::LocalLevel,
            2..=BUILT_IN_AXES => Self::RandomWalk,
            _ => Self::RandomWalkByFormulas,
        }
    }

    pub(super) const fn most_axes(self) -> usize {
        if matches!(self, Self::RandomWalkByFormulas) { FORMULA_AXES } else { BUILT_IN_AXES }
    }

    /// State names: the axes, then their velocities.
    pub(super) fn states(self, axes: &[Axis]) -> Vec<String> {
        let positions = axes.iter().map(|a| a.name.clone());
        match self {
            Self::ConstantVelocity => positions.chain(axes.iter().map(|a| format!("v{}", a.name))).collect(),
            _ => positions.collect(),
        }
    }

    /// Noise of one axis from its measurements.
    ///
    /// With a measurement noise of variance r, second differences of a level or of a straight line have variance 6 r,
    /// to which the process adds (2/3) q (k dt)^3 over k rows for a velocity driven by white noise; mean square changes
    /// over k rows of a level are 2 r + q k dt. The differences between two k give q.
    pub(super) fn axis(self, name: String, series: &[Series]) -> Axis {
        let dt = usable(median(series.iter().flat_map(Series::intervals).collect()), 1.0);
        let spread = usable(mean_square_about_mean(series), 1.0);
        let second = |lag| second_differences(series, lag).collect::<Vec<f64>>();
        let robust = usable(robust_variance(second(1)), mean_square(second(1).into_iter()));
        let r = usable(robust / 6.0, 1e-6 * spread);
        let lag = if series.iter().any(|s| s.value.len() > 32) { 8 } else { 2 };
        let span = lag as f64 * dt;
        let q = match self {
            Self::ConstantVelocity => {
                let growth = mean_square(second(lag).into_iter()) - mean_square(second(1).into_iter());
                usable(1.5 * growth / (span.powi(3) - dt.powi(3)), 1e-3 * r / dt.powi(3))
            }
            _ => {
                let growth = mean_square(changes(series, lag)) - mean_square(changes(series, 1));
                usable(growth / (span - dt), 1e-3 * r / dt)
            }
        };
        let velocity_variance = usable(mean_square(changes(series, lag)) / (span * span), r / (dt * dt));
        Axis { name, r, q, velocity_variance }
    }
}

/// Whether changes grow like a motion's rather than a level's.
///
/// The mean square change over k rows is 2 r + q k dt for a wandering level and 2 r + v^2 (k dt)^2 for a motion, so
/// between k = 1, s, s^2 it grows by a factor of s or of s^2, whatever r is: the middle, s^1.5, parts the two. Where it
/// does not even double over all, there is nothing but noise.
fn travels(series: &[Series]) -> bool {
    let longest = series.iter().map(|s| s.value.len()).max().unwrap_or(0);
    let stride = if longest >= 64 { 4 } else { 2 };
    let [one, few, many] = [1, stride, stride * stride].map(|lag| mean_square(changes(series, lag)));
    longest >= 8 && few > one && many > 2.0 * one && many - few > (stride as f64).powf(1.5) * (few - one)
}

/// z[k + lag] - z[k].
fn changes(series: &[Series], lag: usize) -> impl Iterator<Item = f64> {
    series.iter().flat_map(move |s| s.value.iter().zip(s.value.iter().skip(lag)).map(|(a, b)| b - a))
}

/// z[k + lag] - 2 z[k] + z[k - lag].
fn second_differences(series: &[Series], lag: usize) -> impl Iterator<Item = f64> {
    let triples = move |s: &'_ Series| {
        (2 * lag..s.value.len()).map(|k| s.value[k] - 2.0 * s.value[k - lag] + s.value[k - 2 * lag]).collect::<Vec<_>>()
    };
    series.iter().flat_map(triples)
}

fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    sum / count
}

fn mean_square_about_mean(series: &[Series]) -> f64 {
    let values = || series.iter().flat_map(|s| s.value.iter().copied());
    let mean = values().sum::<f64>() / values().count() as f64;
    mean_square(values().map(|v| v - mean))
}

/// Variance of a normal distribution from the median absolute deviation, which outliers hardly move.
fn robust_variance(values: Vec<f64>) -> f64 {
    const SIGMA_OVER_MAD: f64 = 1.482_602_218_505_602; // 1 / (normal quantile of 3/4)
    let middle = median(values.clone());
    let deviation = median(values.into_iter().map(|v| (v - middle).abs()).collect());
    (SIGMA_OVER_MAD * deviation).powi(2)
}

/// `value` if a search can start from it, else `otherwise`, else 1.
fn usable(value: f64, otherwise: f64) -> f64 {
    let sound = |v: &f64| (1e-150..1e150).contains(v);
    [value, otherwise].into_iter().find(sound).unwrap_or(1.0)
}
