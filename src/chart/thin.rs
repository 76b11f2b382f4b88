//! Points in pixels: gaps, and no more of them than a screen can show.

/// Points per pixel of width above which a line is thinned.
const DENSE: f64 = 4.0;
/// Lines that go to and fro are cut to this many points.
const MOST: usize = 40_000;

/// A point in the window \[px\]; `None` = gap.
pub(super) type Pixel = Option<(f64, f64)>;

/// Unbroken stretches of a line, each thinned to what `width` pixels can show.
pub(super) fn stretches(points: impl Iterator<Item = Pixel>, width: f64) -> Vec<Vec<(f64, f64)>> {
    let mut all = vec![Vec::new()];
    for point in points {
        match (point, all.last_mut()) {
            (Some(point), Some(last)) => last.push(point),
            (None, Some(last)) if !last.is_empty() => all.push(Vec::new()),
            _ => {}
        }
    }
    all.retain(|stretch| !stretch.is_empty());
    all.into_iter().map(|stretch| thinned(stretch, width)).collect()
}

fn thinned(points: Vec<(f64, f64)>, width: f64) -> Vec<(f64, f64)> {
    if points.len() as f64 <= DENSE * width.max(100.0) {
        return points;
    }
    if points.is_sorted_by(|a, b| a.0 <= b.0) {
        return columns(&points);
    }
    let apart = far_apart(&points);
    let stride = apart.len().div_ceil(MOST).max(1);
    apart.into_iter().step_by(stride).collect()
}

/// What every column of one pixel shows of a line.
fn columns(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut columns: Vec<Stretch> = Vec::new();
    for point in points {
        match columns.last_mut() {
            Some(last) if point.0.floor() <= last.first.0.floor() => last.add(*point),
            _ => columns.push(Stretch::of(*point)),
        }
    }
    columns.iter().flat_map(Stretch::ends).collect()
}

/// What is drawn of a stretch of a line, however many points it has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) first: (f64, f64),
    pub(super) low: (f64, f64),
    pub(super) high: (f64, f64),
    last: (f64, f64),
}

impl Stretch {
    pub(super) const fn of(point: (f64, f64)) -> Self {
        Self { first: point, low: point, high: point, last: point }
    }

    /// The next point; NaN is neither lowest nor highest, unless all are.
    pub(super) fn add(&mut self, point: (f64, f64)) {
        if point.1 < self.low.1 || self.low.1.is_nan() {
            self.low = point;
        }
        if point.1 >= self.high.1 || self.high.1.is_nan() {
            self.high = point;
        }
        self.last = point;
    }

    /// Its ends and its extremes in their order, without repetition.
    fn ends(&self) -> Vec<(f64, f64)> {
        let mut ends = vec![self.first, self.low, self.high, self.last];
        ends[1..].sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.dedup();
        ends
    }
}

/// Drops points less than a third of a pixel from the one kept before; the last stays.
fn far_apart(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let near = kept.last().is_some_and(|last| (last.0 - point.0).hypot(last.1 - point.1) < 0.33);
        if !near || i + 1 == points.len() {
            kept.push(*point);
        }
    }
    kept
}

/// Of many markers, one a cell of `cell` pixels; few stay as they are.
pub(super) fn markers(points: impl Iterator<Item = Pixel>, cell: f64) -> Vec<(f64, f64)> {
    let points: Vec<(f64, f64)> = points.flatten().collect();
    if points.len() <= 2_000 {
        return points;
    }
    let place = |v: f64| (v / cell).floor() as i64;
    let mut taken = std::collections::HashSet::new();
    points.into_iter().filter(|(x, y)| taken.insert((place(*x), place(*y)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_breaks_the_line() {
        let points = [Some((0.0, 0.0)), None, None, Some((2.0, 1.0)), Some((3.0, 1.0))];
        assert_eq!(stretches(points.into_iter(), 100.0), [vec![(0.0, 0.0)], vec![(2.0, 1.0), (3.0, 1.0)]]);
        assert!(stretches(std::iter::repeat_n(None, 5), 100.0).is_empty(), "nothing but gaps");
    }

    #[test]
    fn a_spike_among_a_million_points_stays() {
        let height = |i: u32| if i == 654_321 { -40.0 } else { f64::from(i % 7) };
        let points = (0..1_000_000u32).map(|i| Some((f64::from(i) * 6e-4, height(i))));
        let kept = stretches(points, 600.0).concat();
        assert!(kept.len() <= 4 * 601, "{}", kept.len());
        assert!(kept.iter().any(|p| p.1 < -39.0), "the spike is gone");
        assert_eq!(kept[0].0.to_bits(), 0, "the first point stays");
        assert!(kept[kept.len() - 1].0 > 599.999, "the last point stays");
    }

    #[test]
    fn a_track_that_turns_back_is_thinned_too() {
        let points = (0..200_000).map(|i| Some((100.0 * (f64::from(i) * 1e-4).sin(), f64::from(i) * 1e-3)));
        let kept = stretches(points, 600.0).concat();
        assert!((1000..MOST + 1).contains(&kept.len()), "{}", kept.len());
        let jumps = (0..200_000).map(|i| Some((f64::from(i % 2) * 100.0, 0.0)));
        assert!(stretches(jumps, 600.0).concat().len() <= MOST, "jumps");
    }

    #[test]
    fn markers_on_one_another_are_one() {
        assert_eq!(markers((0..100_000).map(|_| Some((5.0, 5.0))), 2.0).len(), 1);
        assert_eq!(markers((0..100).map(|_| Some((5.0, 5.0))), 2.0).len(), 100, "few are kept");
    }
}
