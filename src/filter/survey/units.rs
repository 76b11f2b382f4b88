//! Which units a filter computes in.
#![expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, P, S")]

use super::Survey;
use crate::filter::covariance::Symmetric;
use crate::filter::nodes::ModelNodes;
use crate::filter::tracer::Tracer;
use crate::filter::units::Units;
use crate::precision::Precision;
use crate::tape::Id;

/// Binary logarithms between which a variance lies: with the start values, and with any candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    low: f64,
    high: f64,
}

/// Exponents up to which every power of two that is used, and its square, is a normal f64.
const LARGEST: f64 = 500.0;

/// Where every variance is within 2^-`window` and 2^`window`, the problem's own; else one power of two for all, which
/// leaves F and H alone, where that brings them there; else one each.
///
/// An angle is always in radians, of which 2 pi make a turn.
pub(in crate::filter) fn choose(survey: &Survey<'_>, precision: Precision) -> Units {
    let mut units = of_sizes(survey, precision);
    let angles = &survey.t.problem.model.angles;
    angles.states.iter().for_each(|i| units.states[*i] = 0);
    angles.measurements.iter().for_each(|i| units.measurements[*i] = 0);
    units
}

fn of_sizes(survey: &Survey<'_>, precision: Precision) -> Units {
    // A product of innovation variances is split every 2 rows in f32 and every 8 in f64 (tape/lanes.rs), which holds
    // variances from 2^-62 to 2^62 and from 2^-127 to 2^127; the rest is for candidates beyond those looked at.
    let window = match precision {
        Precision::F32 => 50.0,
        Precision::F64 => 112.0,
    };
    let (states, measurements) = sizes(survey, window);
    let all: Vec<Range> = states.iter().chain(&measurements).flatten().copied().collect();
    let fits = |range: &Range, exponent: i32| {
        let shift = 2.0 * f64::from(exponent);
        range.low - shift >= -window && range.high - shift <= window
    };
    let low = all.iter().map(|range| range.low).fold(f64::INFINITY, f64::min);
    let high = all.iter().map(|range| range.high).fold(f64::NEG_INFINITY, f64::max);
    let common = Range { low, high }.exponent(window);
    for exponent in [0, common] {
        if all.iter().all(|range| fits(range, exponent)) {
            return Units { states: vec![exponent; states.len()], measurements: vec![exponent; measurements.len()] };
        }
    }
    let own = |range: &Option<Range>| range.filter(|range| !fits(range, 0)).map_or(0, |range| range.exponent(window));
    Units { states: states.iter().map(own).collect(), measurements: measurements.iter().map(own).collect() }
}

impl Range {
    const NOTHING: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };

    fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn is_something(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// The exponent that centres it; where it is wider than the window, the one that holds its lower end, since innovation
    /// variances come down from a diffuse start and stay there.
    fn exponent(self, window: f64) -> i32 {
        let centre = f64::midpoint(self.low, self.high).min(self.low + window);
        #[expect(clippy::cast_possible_truncation, reason = "within 500")]
        let exponent = (centre / 2.0).clamp(-LARGEST, LARGEST).round() as i32;
        exponent
    }
}

type Sizes = Vec<Option<Range>>;

/// Variances that states and innovations have, as far as P0, Q, R and H tell; `None` where they are 0 throughout. Bounds of
/// a search may be absurd, so other candidates count only up to `window` beyond the start values.
fn sizes(survey: &Survey<'_>, window: f64) -> (Sizes, Sizes) {
    let all = || std::iter::once(&survey.corners).chain(&survey.modes);
    let (mut states, mut measurements) = sizes_of(&survey.t, survey.baseline());
    for [_, baseline, _] in &survey.modes {
        let (x, z) = sizes_of(&survey.t, baseline);
        states.iter_mut().zip(x).for_each(|(range, found)| *range = range.hull(found));
        measurements.iter_mut().zip(z).for_each(|(range, found)| *range = range.hull(found));
    }
    let start = (states.clone(), measurements.clone());
    for candidate in all().flat_map(|[lowest, _, highest]| [lowest, highest]) {
        let (x, z) = sizes_of(&survey.t, candidate);
        let widen = |(range, (start, found)): (&mut Range, (&Range, Range))| {
            let beyond = if start.is_something() { window } else { f64::INFINITY };
            let found = Range { low: found.low.max(start.low - beyond), high: found.high.min(start.high + beyond) };
            if found.is_something() {
                *range = range.hull(found);
            }
        };
        states.iter_mut().zip(start.0.iter().zip(x)).for_each(widen);
        measurements.iter_mut().zip(start.1.iter().zip(z)).for_each(widen);
    }
    let found = |ranges: Vec<Range>| ranges.into_iter().map(|r| Some(r).filter(Range::is_something)).collect();
    (found(states), found(measurements))
}

/// The same with one candidate: a state is as large as the larger of its P0 and its Q, or as what F brings to it where both
/// are 0; an innovation lies between the least R (where there is any) and the largest R with what H sees of the states.
fn sizes_of(tracer: &Tracer<'_>, model: &ModelNodes) -> (Vec<Range>, Vec<Range>) {
    let largest = |ids: &[Id]| extremes(tracer, ids).iter().map(|r| r.high).collect::<Vec<_>>();
    let variances = |matrix: &Symmetric| largest(&matrix.diagonal());
    let mut sizes: Vec<f64> =
        variances(&model.P0).into_iter().zip(variances(&model.Q)).map(|(a, b)| a.max(b)).collect();
    if sizes.iter().any(|size| !size.is_finite()) {
        let F: Vec<Vec<f64>> = model.f.jacobian.iter().map(|row| largest(row)).collect();
        for _ in 0..sizes.len() {
            let known = sizes.clone();
            let brought =
                |row: &[f64]| row.iter().zip(&known).map(|(f, size)| 2.0 * f + size).fold(f64::NEG_INFINITY, f64::max);
            sizes.iter_mut().zip(&F).filter(|(size, _)| !size.is_finite()).for_each(|(size, row)| *size = brought(row));
        }
    }
    let R = extremes(tracer, &model.R.diagonal());
    let innovations = model.h.jacobian.iter().zip(R).map(|(row, r)| {
        let seen = largest(row).iter().zip(&sizes).map(|(h, size)| 2.0 * h + size).fold(f64::NEG_INFINITY, f64::max);
        let high = seen.max(r.high);
        Range { low: if r.low.is_finite() { r.low } else { high }, high }
    });
    let innovations = innovations.collect();
    (sizes.into_iter().map(|size| Range { low: size, high: size }).collect(), innovations)
}

/// The binary logarithms of the least and the largest size of nodes over the rows of the log, zeros left out.
fn extremes(tracer: &Tracer<'_>, ids: &[Id]) -> Vec<Range> {
    let mut found = vec![Range::NOTHING; ids.len()];
    let mut i = 0;
    tracer.over_rows(ids, |value| {
        let size = value.abs().log2();
        if size.is_finite() {
            found[i] = found[i].hull(Range { low: size, high: size });
        }
        i = (i + 1) % ids.len();
    });
    found
}
