//! A long series as shares of its rows. Dots of it would cover one another, and its extremes would hide that they are few.

use crate::chart::{Colour, Marker, Panel, Stroke, broken};
use crate::number::count;

/// Rows up to which every one is a dot.
pub(super) const DOTS: usize = 2000;
/// Stretches of a longer series at most, and the rows that a stretch has at least to have quantiles to speak of.
const STRETCHES: usize = 160;
const LEAST: usize = 50;
/// The quantiles of each stretch: the ends of its middle 95 % and 50 %, and its median.
const SHARES: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];

/// Quantiles of a series over time in at most [`STRETCHES`] stretches, of which one is held row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fan {
    every: usize,
    /// An interval longer than this ends a stretch.
    longest: f64,
    current: Vec<f64>,
    /// First and last time of the current stretch.
    times: [f64; 2],
    stretches: Vec<Spread>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Spread {
    time: f64,
    quantiles: [f64; 5],
    low: f64,
    high: f64,
}

impl Fan {
    /// For a series of at most `length` rows, in which an interval above `longest` is a gap.
    pub(super) fn new(length: usize, longest: f64) -> Self {
        let every = length.div_ceil(STRETCHES).max(LEAST);
        Self { every, longest, current: Vec::new(), times: [0.0; 2], stretches: Vec::new() }
    }

    /// The next value; NaN is left out.
    pub(super) fn push(&mut self, time: f64, value: f64) {
        if value.is_nan() {
            return;
        }
        if time - self.times[1] > self.longest {
            self.close();
        }
        if self.current.is_empty() {
            self.times[0] = time;
        }
        self.times[1] = time;
        self.current.push(value);
        if self.current.len() == self.every {
            self.close();
        }
    }

    /// Ends the stretch at hand.
    pub(super) fn close(&mut self) {
        if !self.current.is_empty() {
            self.current.sort_by(f64::total_cmp);
            let last = self.current.len() - 1;
            let at = |share: f64| self.current[(share * last as f64).round() as usize];
            let time = self.times[0].midpoint(self.times[1]);
            let quantiles = SHARES.map(at);
            self.stretches.push(Spread { time, quantiles, low: self.current[0], high: self.current[last] });
        }
        self.current.clear();
    }

    /// The values that are drawn, but for the extremes.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        self.stretches.iter().flat_map(|s| s.quantiles)
    }

    /// The panel with the shares of each stretch, and dots for its highest value and, where asked for, its lowest.
    pub(super) fn draw(&self, panel: Panel, lowest: bool) -> Panel {
        let band = |from: usize, to: usize| {
            let of = move |s: &Spread| std::iter::once((s.time, [s.quantiles[from], s.quantiles[to]]));
            broken(&self.stretches, |s| s.time, of, (f64::NAN, [f64::NAN; 2]))
        };
        let median =
            broken(&self.stretches, |s| s.time, |s| std::iter::once((s.time, s.quantiles[2])), (f64::NAN, f64::NAN));
        let ends = |s: &Spread| [(s.time, s.high), (s.time, s.low)].into_iter().take(if lowest { 2 } else { 1 });
        let extremes = if lowest { "highest and lowest of them" } else { "highest of them" };
        panel
            .band(&format!("middle 95 % of every {} rows", count(self.every as u64)), Colour::Grey, band(0, 4))
            .band("middle 50 %", Colour::Steel, band(1, 3))
            .line("median", Stroke::new(Colour::Black), median)
            .points(extremes, (Marker::Speck, Colour::Black), self.stretches.iter().flat_map(ends))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 160 000 values 0, 1, ..., 999 over and over, each stretch has the quantiles of 0 to 999.
    #[test]
    fn every_stretch_has_the_quantiles_of_its_rows() {
        let mut fan = Fan::new(160_000, 5.0);
        (0..160_000u32).for_each(|k| fan.push(f64::from(k), f64::from(k % 1000)));
        fan.close();
        assert_eq!((fan.stretches.len(), fan.every), (STRETCHES, 1000));
        let Spread { time, quantiles, low, high } = fan.stretches[7];
        let found = [&[time, low, high][..], &quantiles].concat();
        assert_eq!(format!("{found:?}"), "[7499.5, 0.0, 999.0, 25.0, 250.0, 500.0, 749.0, 974.0]");
        fan.push(160_000.0, 5.0);
        fan.push(160_010.0, 6.0);
        fan.close();
        assert_eq!(fan.stretches.len(), STRETCHES + 2, "a gap ends a stretch");
        let mut none = Fan::new(10_000, 5.0);
        none.push(0.0, f64::NAN);
        none.close();
        assert!(none.stretches.is_empty(), "nothing but gaps");
    }
}
