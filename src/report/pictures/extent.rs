//! How much an axis shows: what is usual, and not what a wide start or a gap would make of it.

use super::track::MeasurementSeries;
use crate::chart::{Axis, Envelope};

/// Innovations where S is this many times its median are those of a gap or of a start, and left out of an axis that they
/// would more than multiply by [`HIDES`].
const WIDE: f64 = 5.0;
const HIDES: f64 = 3.0;

/// An axis that shows all values, and of their band what is near: a wide P0 would leave little room for the rest.
pub(super) fn of_course(axis: Axis, values: impl Iterator<Item = f64>, band: &Envelope) -> Axis {
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        let usable = values.filter(|v| v.abs() < 1e300);
        usable.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let [low, high] = ends(&mut values.into_iter());
    // Where the band settles: its width is below three times the median one in all but the first rows.
    let mut widths: Vec<f64> = band.band().map(|(_, [low, high])| high - low).filter(|w| w.is_finite()).collect();
    widths.sort_by(f64::total_cmp);
    let settled = 3.0 * widths.get(widths.len() / 2).copied().unwrap_or(f64::INFINITY);
    let near = band.band().map(|(_, edges)| edges).filter(|[low, high]| high - low <= settled);
    let [band_low, band_high] = ends(&mut near.flatten());
    let (low, high) = (low.min(band_low), high.max(band_high));
    let room = 0.05 * (high - low);
    // Constant values, or none, are left to the axis.
    if room > 1e-9 * low.abs().max(high.abs()) && room < 1e299 { axis.range(low - room, high + room) } else { axis }
}

/// The value that one in twenty of the positive ones is below; infinite if there is none.
pub(super) fn lowest_usual(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| (1e-300..1e300).contains(v)).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 20).copied().unwrap_or(f64::INFINITY)
}

/// Errors but for the few far beyond all others, as those of a wrong x0 are in the first rows.
pub(super) fn without_outliers(mut errors: Vec<f64>) -> Vec<f64> {
    errors.retain(|error| error.abs() < 1e300);
    errors.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let usual = errors.get(errors.len() * 95 / 100).map_or(0.0, |error| error.abs());
    errors.retain(|error| error.abs() <= 5.0 * usual);
    errors
}

/// Whether the innovations of rows with a wide S, as after a gap, would hide all others.
pub(super) fn hides_the_rest(series: &MeasurementSeries) -> bool {
    let widths: Vec<f64> = series.band.band().map(|(_, [_, high])| high).filter(|w| w.is_finite()).collect();
    let mut sorted = widths.clone();
    sorted.sort_by(f64::total_cmp);
    let wide = WIDE * sorted.get(sorted.len() / 2).copied().unwrap_or(f64::INFINITY);
    let sizes = series.innovation.band().map(|(_, [low, high])| low.abs().max(high.abs())).filter(|v| v.is_finite());
    let largest = |[usual, others]: [f64; 2], (width, size): (&f64, f64)| {
        if *width > wide { [usual, others.max(size)] } else { [usual.max(size), others] }
    };
    let [usual, others] = widths.iter().zip(sizes).fold([0.0, 0.0], largest);
    others > HIDES * usual
}
