//! Counts of normalised values in bins, and how they are drawn.

use crate::chart::{Axis, Colour, Panel, Stroke};

/// Width of the bins that are counted.
const BIN: f64 = 0.05;
/// Bins on each side of 0; what lies beyond is counted in the outermost.
const HALF: usize = 160;

/// How often values near each multiple of [`BIN`] came, within plus and minus 8.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Histogram {
    bins: Vec<u64>,
    count: u64,
    beyond: u64,
    largest: f64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { bins: vec![0; 2 * HALF], count: 0, beyond: 0, largest: 0.0 }
    }
}

impl Histogram {
    pub(super) fn add(&mut self, value: f64) {
        if value.is_nan() {
            return;
        }
        let bin = (value / BIN).floor() + HALF as f64;
        let inside = bin.clamp(0.0, 2.0 * HALF as f64 - 1.0);
        self.bins[inside as usize] += 1;
        self.count += 1;
        self.beyond += u64::from((bin - inside).abs() > 0.0);
        self.largest = self.largest.max(value.abs());
    }

    /// Bars of density, with the density of N(0, 1) that a consistent filter has.
    pub(super) fn panel(&self, name: &str) -> Panel {
        // Wide enough for counts to be steady: about 1, 1/2, ... of a standard deviation.
        let merged = match self.count {
            0..60 => 20,
            60..400 => 10,
            400..4000 => 5,
            _ => 2,
        };
        let width = merged as f64 * BIN;
        let end = self.largest.ceil().clamp(4.0, BIN * HALF as f64);
        let density = |count: u64| count as f64 / (self.count.max(1) as f64 * width);
        let bars = self.bins.chunks(merged).enumerate().map(|(i, bins)| {
            let left = i as f64 * width - BIN * HALF as f64;
            ([left, left + width], density(bins.iter().sum()))
        });
        let bars = bars.filter(|([left, right], _)| *left > -end - 1e-9 && *right < end + 1e-9);
        let normal = |z: f64| (z, (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt());
        let curve = (-100..=100).map(|i| normal(f64::from(i) / 100.0 * end));
        let title = match self.beyond {
            0 => format!("{name}: {} values", self.count),
            beyond => format!("{name}: {} values, {beyond} beyond ±8 in the outer bars", self.count),
        };
        Panel::new(Axis::new("normalised innovation").range(-end, end), Axis::new("density"))
            .title(title)
            .bars("innovations", Colour::Blue, bars)
            .line("N(0, 1)", Stroke::of_series(1), curve)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_counted_once() {
        let mut found = Histogram::default();
        [0.01, -0.01, 0.07, 7.99, 99.0, -99.0, f64::NAN].iter().for_each(|v| found.add(*v));
        assert_eq!((found.count, found.beyond), (6, 2));
        assert_eq!((found.bins[HALF], found.bins[HALF - 1], found.bins[HALF + 1]), (1, 1, 1));
        assert_eq!((found.bins[0], found.bins[2 * HALF - 1]), (1, 2), "7.99 and 99 stand in the last bin");
        assert_eq!(found.bins.iter().sum::<u64>(), found.count);
    }
}
