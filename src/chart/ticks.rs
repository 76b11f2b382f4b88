//! Ticks: round values, and labels that are short whatever the range.

use super::axis::{Axis, Scale};
use super::{dates, text};

/// Size of tick labels \[px\].
pub(super) const LABEL: f64 = 12.0;
/// Labels that a vertical axis has at least, where its values allow: one or two leave its scale to be guessed.
const LEAST: usize = 3;

/// The marks along an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ticks {
    /// Place (0 to 1) and label of each, from low to high.
    pub(super) major: Vec<(f64, String)>,
    /// Places between them.
    pub(super) minor: Vec<f64>,
    /// The axis as it is named: with what the labels leave out.
    pub(super) name: String,
}

impl Ticks {
    /// For the horizontal axis: as many as have room side by side in `length` \[px\].
    pub(super) fn along(axis: &Axis, scale: Scale, length: f64) -> Self {
        if !axis.labels.is_empty() {
            return Self::named(axis, scale, length);
        }
        let mut usual = (2..10).rev().map(|most| Self::at_most(axis, scale, most));
        if let Some(ticks) = usual.find(|ticks| ticks.major.len() > 1 && ticks.have_room(length)) {
            return ticks;
        }
        // One label says nothing of the scale. Of closer steps the outermost two have room before all have.
        let steps = |most| {
            // On a log axis these are 1, 2 and 5 however many are asked for.
            let even = (scale.log && axis.instants.is_none()).then(|| linear(axis, scale, most));
            [Some(Self::at_most(axis, scale, most)), even].into_iter().flatten()
        };
        let mut closer = (3..60).flat_map(steps).map(Self::outermost);
        closer.find(|ticks| ticks.major.len() > 1 && ticks.have_room(length)).unwrap_or_else(|| {
            let mut ticks = Self::at_most(axis, scale, 2);
            ticks.major.truncate(1);
            ticks
        })
    }

    /// With labels at the first and the last tick alone.
    fn outermost(mut self) -> Self {
        if self.major.len() > 2 {
            let last = self.major.len() - 1;
            let between = self.major.drain(1..last).map(|(place, _)| place);
            self.minor.extend(between);
        }
        self
    }

    /// At 0, 1, 2, ... with the labels that the axis was given, shortened where they would touch.
    fn named(axis: &Axis, scale: Scale, length: f64) -> Self {
        let room = (length / axis.labels.len() as f64 - 10.0).min(160.0);
        let tick = |(i, label): (usize, &String)| Some((scale.share(i as f64)?, text::fitted(label, LABEL, room)));
        let major = axis.labels.iter().enumerate().filter_map(tick).collect();
        Self { major, minor: Vec::new(), name: named(axis, 0.0, 0) }
    }

    /// For the vertical axis of a height \[px\].
    pub(super) fn up(axis: &Axis, scale: Scale, height: f64) -> Self {
        let most = ((height / 32.0) as usize).clamp(2, 9);
        let ticks = Self::at_most(axis, scale, most);
        if ticks.major.len() >= LEAST {
            return ticks;
        }
        // The next smaller step puts at most five where there were two.
        let closer = || (most + 1..=3 * most).map(|most| Self::at_most(axis, scale, most));
        let with = |least: usize| closer().find(|ticks| ticks.major.len() >= least);
        with(LEAST).or_else(|| with(2).filter(|_| ticks.major.len() < 2)).unwrap_or(ticks)
    }

    /// Width of the widest label \[px\].
    pub(super) fn label_width(&self) -> f64 {
        self.major.iter().map(|(_, label)| text::width(label, LABEL)).fold(0.0, f64::max)
    }

    fn have_room(&self, length: f64) -> bool {
        let half = |label: &str| 0.5 * text::width(label, LABEL);
        self.major.windows(2).all(|pair| {
            let ((a, left), (b, right)) = (&pair[0], &pair[1]);
            (b - a) * length > half(left) + half(right) + 10.0
        })
    }

    fn at_most(axis: &Axis, scale: Scale, most: usize) -> Self {
        if let Some((major, name)) = axis.instants.and_then(|clock| dates::ticks(&axis.name, clock, scale, most)) {
            return Self { major, minor: Vec::new(), name };
        }
        if scale.log {
            let name = named(axis, 0.0, 0);
            if let Some((major, minor)) = decades(scale, most) {
                return Self { major, minor, name };
            }
            return linear(axis, scale, most);
        }
        linear(axis, scale, most)
    }
}

/// Steps of 1, 2 or 5 times a power of ten. A large value common to all is left to the axis's name, as is a power of
/// ten. On a log axis of less than a decade they are ticks of the values.
fn linear(axis: &Axis, scale: Scale, most: usize) -> Ticks {
    let ends = if scale.log { [10f64.powf(scale.low), 10f64.powf(scale.high)] } else { [scale.low, scale.high] };
    let [low, high] = ends;
    let step = round_step((high - low) / most as f64, axis.whole);
    let largest = low.abs().max(high.abs());
    let offset = if largest / step >= 1e6 { common(low, high) } else { 0.0 };
    let first = ((low - offset) / step).ceil();
    let last = ((high - offset) / step).floor();
    // At most `most` + 1 of them, and none where rounding has left no whole step.
    let count = (last - first).clamp(-1.0, 50.0) as i64 + 1;
    let parts = (0..count).map(|i| (first + i as f64) * step);
    let size = parts.clone().fold(0.0f64, |size, part| size.max(part.abs()));
    let exponent = exponent_of(size);
    let decimals = usize::try_from(exponent - step.log10().floor() as i32).unwrap_or(0);
    let unit = 10f64.powi(exponent);
    let major = parts.filter_map(|part| Some((scale.share(offset + part)?, signed(part / unit, decimals))));
    Ticks { major: major.collect(), minor: Vec::new(), name: named(axis, offset, exponent) }
}

/// The next larger of 1, 2 and 5 times a power of ten.
fn round_step(least: f64, whole: bool) -> f64 {
    let decade = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0].iter().map(|m| m * decade).find(|step| *step >= least * (1.0 - 1e-9));
    let step = step.unwrap_or(10.0 * decade);
    if whole { step.max(1.0) } else { step }
}

/// A round value between or near `low` and `high`, for labels to count from. Powers of ten from 1 on are exact and those
/// below are not, so that it is divided by one where it has decimals.
fn common(low: f64, high: f64) -> f64 {
    let (power, middle) = ((high - low).log10().ceil() as i32, f64::midpoint(low, high));
    let decade = 10f64.powi(power.abs());
    if power < 0 { (middle * decade).round() / decade } else { (middle / decade).round() * decade }
}

/// The power of ten, a multiple of three, that is taken out of labels up to `size`.
fn exponent_of(size: f64) -> i32 {
    if size <= 0.0 || (1e-2..1e6).contains(&size) {
        return 0;
    }
    ((size.log10() / 3.0).floor() * 3.0) as i32
}

fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let is_zero = text.bytes().all(|b| matches!(b, b'0' | b'.'));
    if value < 0.0 && !is_zero { format!("−{text}") } else { text }
}

/// Name and unit; `level − 5 [1e-12 m]` where labels leave out an offset of 5 and a factor of 1e-12.
fn named(axis: &Axis, offset: f64, exponent: i32) -> String {
    let mut name = axis.name.clone();
    if offset.abs() > 0.0 {
        let sign = if offset < 0.0 { '+' } else { '−' };
        name = format!("{name} {sign} {}", crate::number::exact(offset.abs()));
    }
    let factor = (exponent != 0).then(|| format!("1e{exponent}"));
    match (factor, axis.unit.as_deref().filter(|unit| !unit.is_empty())) {
        (None, None) => name,
        (Some(factor), None) => format!("{name} [{factor}]"),
        (None, Some(unit)) => format!("{name} [{unit}]"),
        (Some(factor), Some(unit)) => format!("{name} [{factor} {unit}]"),
    }
}

type Marks = (Vec<(f64, String)>, Vec<f64>);

/// Powers of ten, or 1, 2 and 5 times them; `None` where fewer than two of those lie in the range.
fn decades(scale: Scale, most: usize) -> Option<Marks> {
    let [first, last] = [scale.low.ceil() as i32, scale.high.floor() as i32];
    let count = usize::try_from(last - first + 1).unwrap_or(0);
    let share = |value: f64| scale.share(value).filter(|s| (-1e-9..=1.0 + 1e-9).contains(s));
    let times = |k: i32, m: i32| f64::from(m) * 10f64.powi(k);
    if count >= 3 {
        let stride = count.div_ceil(most.max(1));
        let major = (first..=last).step_by(stride);
        let major = major.filter_map(|k| Some((share(times(k, 1))?, power(k)))).collect();
        let within = (first - 1..=last).flat_map(|k| (2..10).map(move |m| (k, m)));
        let between = (first..=last).map(|k| (k, 1));
        let minor = if stride == 1 { within.collect::<Vec<_>>() } else { between.collect() };
        return Some((major, minor.into_iter().filter_map(|(k, m)| share(times(k, m))).collect()));
    }
    let steps: Vec<_> = (first - 1..=last).flat_map(|k| [1, 2, 5].map(|m| (k, m))).collect();
    let major: Vec<_> = steps.into_iter().filter_map(|(k, m)| Some((share(times(k, m))?, plain(k, m)))).collect();
    (2..=most.max(2)).contains(&major.len()).then(|| (major, Vec::new()))
}

fn power(k: i32) -> String {
    plain(k, 1)
}

/// m 10^k.
fn plain(k: i32, m: i32) -> String {
    match k {
        0..=4 => format!("{m}{}", "0".repeat(usize::try_from(k).unwrap_or(0))),
        -3..=-1 => format!("0.{}{m}", "0".repeat(usize::try_from(-k - 1).unwrap_or(0))),
        _ => format!("{m}e{k}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, data: [f64; 2]) -> (Vec<String>, String) {
        let ticks = Ticks::at_most(axis, axis.scale(data.into_iter(), 0.0).unwrap(), 5);
        assert!(ticks.major.iter().all(|(place, _)| (-0.01..=1.01).contains(place)), "{ticks:?}");
        (ticks.major.into_iter().map(|(_, label)| label).collect(), ticks.name)
    }

    #[test]
    fn labels_are_round_and_short() {
        let axis = Axis::new("x").unit("m");
        let cases: [([f64; 2], &str, &str); 7] = [
            ([0.0, 10.0], "0 2 4 6 8 10", "x [m]"),
            ([-1.0, 1.0], "−1.0 −0.5 0.0 0.5 1.0", "x [m]"),
            ([0.0, 4e-12], "0 1 2 3 4", "x [1e-12 m]"),
            ([-2e9, 2e9], "−2 −1 0 1 2", "x [1e9 m]"),
            ([1.7e9, 1.7e9 + 40.0], "0 10 20 30 40", "x − 1700000000 [m]"),
            ([400.0, 1600.0], "500 1000 1500", "x [m]"),
            ([8.088_991e-3, 8.089_009e-3], "−5 0 5", "x − 0.008089 [1e-9 m]"),
        ];
        for (data, expected, name) in cases {
            let (found, named) = labels(&axis, data);
            assert_eq!((found.join(" ").as_str(), named.as_str()), (expected, name), "{data:?}");
        }
    }

    #[test]
    fn log_axes_count_decades_or_less() {
        let axis = Axis::new("q").log();
        assert_eq!(labels(&axis, [1e-6, 1e2]).0.join(" "), "1e-6 1e-4 0.01 1 100");
        assert_eq!(labels(&axis, [1.0, 40.0]).0.join(" "), "1 2 5 10 20");
        assert_eq!(labels(&axis, [3.1, 3.9]).0.join(" "), "3.2 3.4 3.6 3.8");
    }

    #[test]
    fn a_low_panel_still_says_its_scale() {
        let axis = Axis::new("v");
        for data in [[-4.6, 4.9], [-180.0, 3860.0], [-19.0, 76.0], [0.11, 0.19]] {
            let ticks = Ticks::up(&axis, axis.scale(data.into_iter(), 0.0).unwrap(), 150.0);
            assert!((3..=6).contains(&ticks.major.len()), "{data:?}: {ticks:?}");
        }
        let counts = Axis::new("failed").whole();
        let ticks = Ticks::up(&counts, counts.scale([0.0, 1.0].into_iter(), 0.0).unwrap(), 150.0);
        assert_eq!(ticks.major.len(), 2, "no ticks between 0 and 1: {ticks:?}");
    }

    /// Whatever the range, an axis as wide as the narrowest panel or as high as the lowest says its scale.
    #[test]
    fn an_axis_has_two_labels_at_least() {
        let mut x = 0.37_f64;
        for i in 0..4000 {
            // A logistic map scatters the ranges the same way on every machine.
            x = 3.99 * x * (1.0 - x);
            let low = 10f64.powi(i % 13 - 6) * (0.2 + x);
            let high = low * (1.0 + 10f64.powf(-3.5 + 6.0 * ((f64::from(i) * 0.618).fract())));
            for axis in [Axis::new("r"), Axis::new("r").log()] {
                let scale = axis.scale([low, high].into_iter(), 0.0).unwrap();
                for length in [130.0, 300.0, 680.0] {
                    let ticks = Ticks::along(&axis, scale, length);
                    assert!(ticks.major.len() > 1 && ticks.have_room(length), "{low} to {high}: {ticks:?}");
                }
                let ticks = Ticks::up(&axis, scale, 150.0);
                assert!(ticks.major.len() > 1, "{low} to {high}: {ticks:?}");
            }
        }
    }

    #[test]
    fn counts_have_whole_ticks() {
        assert_eq!(labels(&Axis::new("generation").whole(), [0.0, 2.0]).0.join(" "), "0 1 2");
    }

    #[test]
    fn labels_never_touch() {
        let axis = Axis::new("x");
        for data in [[0.0, 1e5], [-12_345.0, 98_765.0], [1.234_567_8, 1.234_568_9]] {
            let scale = axis.scale(data.into_iter(), 0.0).unwrap();
            for length in [40.0, 120.0, 600.0] {
                assert!(Ticks::along(&axis, scale, length).have_room(length), "{data:?} in {length} px");
            }
        }
    }
}
