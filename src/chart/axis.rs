//! Axes: what is drawn along them, and the mapping of values to shares of their length.

use super::FigureError;

/// Values beyond this stand for failures (a failed candidate costs `f64::MAX`) and are gaps.
const LARGEST: f64 = 1e300;
/// Ranges below this cannot be divided into steps.
const SMALLEST: f64 = 1e-290;

/// An axis as its user describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    pub(super) log: bool,
    pub(super) whole: bool,
    pub(super) labels: Vec<String>,
    /// Seconds from 1970 to 0, and seconds in one, where values are instants.
    pub(super) instants: Option<[f64; 2]>,
    range: Option<[f64; 2]>,
    include: Vec<f64>,
}

impl Axis {
    /// A linear axis without unit that shows all of its data.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        let (name, labels, include) = (name.into(), Vec::new(), Vec::new());
        Self { name, unit: None, log: false, whole: false, labels, instants: None, range: None, include }
    }

    /// With a unit.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// Logarithmic where `log`; see [`Self::log`].
    #[must_use]
    pub const fn log_if(mut self, log: bool) -> Self {
        self.log = log;
        self
    }

    /// Names in place of numbers at 0, 1, 2, ...; for horizontal axes.
    #[must_use]
    pub fn labels(mut self, labels: impl IntoIterator<Item = String>) -> Self {
        self.labels = labels.into_iter().collect();
        let last = self.labels.len() as f64 - 0.5;
        if last > 0.0 { self.range(-0.5, last) } else { self }
    }

    /// Logarithmic; values that are not positive are gaps.
    #[must_use]
    pub const fn log(mut self) -> Self {
        self.log = true;
        self
    }

    /// Ticks at whole numbers only, as for counts.
    #[must_use]
    pub const fn whole(mut self) -> Self {
        self.whole = true;
        self
    }

    /// Dates and times of day as labels, in UTC: 0 stands for `zero` seconds after 1970, and 1 for `unit` seconds more.
    #[must_use]
    pub const fn instants(mut self, zero: f64, unit: f64) -> Self {
        self.instants = Some([zero, unit]);
        self
    }

    /// From `low` to `high`, whatever the data.
    #[must_use]
    pub const fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }

    /// Shows `value` too.
    #[must_use]
    pub fn including(mut self, value: f64) -> Self {
        self.include.push(value);
        self
    }

    /// The range that shows `data`, with a margin of a share of it on both sides.
    pub(super) fn scale(&self, data: impl Iterator<Item = f64>, margin: f64) -> Result<Scale, FigureError> {
        let log = self.log;
        if let Some([low, high]) = self.range {
            let usable = is_usable(low, log) && is_usable(high, log) && low < high;
            return if usable { Ok(Scale::between(low, high, log)) } else { Err(self.bad_range(low, high)) };
        }
        let values = data.chain(self.include.iter().copied()).filter(|v| is_usable(*v, log));
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        if low > high {
            return Ok(Scale::between(if log { 0.1 } else { 0.0 }, 1.0, log));
        }
        let scale = Scale::between(low, high, log).opened();
        let room = margin * (scale.high - scale.low);
        // A histogram stands on its zero line, without room under it.
        let stands_on_zero = !log && low.abs() <= 0.0 && self.include.iter().any(|v| v.abs() <= 0.0);
        Ok(Scale { low: if stands_on_zero { 0.0 } else { scale.low - room }, high: scale.high + room, log })
    }

    fn bad_range(&self, low: f64, high: f64) -> FigureError {
        FigureError::Range { axis: self.name.clone(), low, high, log: self.log }
    }
}

fn is_usable(value: f64, log: bool) -> bool {
    value.abs() <= LARGEST && (!log || value > SMALLEST)
}

/// A range of values along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Ends; of the common logarithm on a log axis.
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) log: bool,
}

impl Scale {
    fn between(low: f64, high: f64, log: bool) -> Self {
        if log { Self { low: low.log10(), high: high.log10(), log } } else { Self { low, high, log } }
    }

    /// Wider where its ends are equal, or nearer to one another than f64 can count steps between.
    fn opened(self) -> Self {
        let size = self.low.abs().max(self.high.abs());
        if self.high - self.low > (1e-14 * size).max(SMALLEST) {
            return self;
        }
        let half = match (self.log, size > SMALLEST) {
            (true, _) => 0.5,
            (false, true) => 0.1 * size,
            (false, false) => 1.0,
        };
        Self { low: self.low - half, high: self.high + half, log: self.log }
    }

    /// Wider on both sides, so that `length` \[px\] shows `per_pixel` each; as it is where that would be less.
    pub(super) fn widened(self, length: f64, per_pixel: f64) -> Self {
        let room = (0.5 * (per_pixel * length - (self.high - self.low))).max(0.0);
        Self { low: self.low - room, high: self.high + room, log: self.log }
    }

    /// Where a value stands, 0 at the low and 1 at the high end; `None` for a gap. Values far outside stay finite.
    pub(super) fn share(&self, value: f64) -> Option<f64> {
        if !is_usable(value, self.log) {
            return None;
        }
        let value = if self.log { value.log10() } else { value };
        Some(((value - self.low) / (self.high - self.low)).clamp(-50.0, 50.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(axis: &Axis, data: &[f64]) -> Scale {
        axis.scale(data.iter().copied(), 0.05).unwrap()
    }

    #[test]
    fn any_data_give_a_range() {
        let axis = Axis::new("x");
        for data in [&[][..], &[f64::NAN], &[3.0, 3.0], &[0.0], &[f64::MAX, 1.0], &[1e-320, 0.0], &[-1e300, 1e300]] {
            for axis in [axis.clone(), axis.clone().log()] {
                let found = scale(&axis, data);
                assert!(found.low < found.high && (found.high - found.low).is_finite(), "{data:?}: {found:?}");
            }
        }
        let tiny = scale(&axis, &[5.0, 5.0 + 1e-12]);
        assert!(tiny.high - tiny.low < 2e-12, "{tiny:?}");
    }

    #[test]
    fn values_map_to_shares() {
        let found = scale(&Axis::new("x").range(10.0, 1000.0).log(), &[]);
        assert!((found.share(100.0).unwrap() - 0.5).abs() < 1e-12, "{found:?}");
        assert_eq!(found.share(-1.0), None);
        assert_eq!(found.share(f64::NAN), None);
        assert_eq!(scale(&Axis::new("x").including(0.0), &[0.0, 9.0]).low.to_bits(), 0, "no room under zero");
    }

    #[test]
    fn a_range_that_is_none_is_refused() {
        for (low, high, log) in [(1.0, 1.0, false), (f64::NAN, 1.0, false), (0.0, 1.0, true)] {
            let axis = Axis::new("x").range(low, high);
            let axis = if log { axis.log() } else { axis };
            let refused = axis.scale(std::iter::empty(), 0.0);
            assert!(matches!(refused, Err(FigureError::Range { .. })), "{low} {high}: {refused:?}");
        }
    }
}
