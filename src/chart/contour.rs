//! Levels of a function on a grid.

/// Values at the crossings of a rectangular grid. NaN counts as above every level.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Row by row: the first x.len() values belong to y\[0\].
    values: Vec<f64>,
}

impl Grid {
    /// A grid with `values[j * x.len() + i]` at (x\[i\], y\[j\]); values that are missing are NaN.
    #[must_use]
    pub fn new(x: Vec<f64>, y: Vec<f64>, mut values: Vec<f64>) -> Self {
        values.resize(x.len() * y.len(), f64::NAN);
        Self { x, y, values }
    }

    /// Its values, row by row.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Closed curves around the points at or below `level`, in pieces that touch; edges are cut where a straight line
    /// between neighbours reaches it.
    #[must_use]
    pub fn region(&self, level: f64) -> Vec<Vec<(f64, f64)>> {
        let mut pieces = Vec::new();
        for j in 0..self.y.len().saturating_sub(1) {
            // Whole cells side by side are one piece.
            let mut run: Option<usize> = None;
            for i in 0..self.x.len().saturating_sub(1) {
                let corners = self.cell(i, j);
                let whole = corners.iter().all(|(_, value)| *value <= level);
                if whole {
                    run.get_or_insert(i);
                    continue;
                }
                pieces.extend(run.take().map(|from| self.rectangle(from, i, j)));
                let piece = below(corners, level);
                pieces.extend((piece.len() > 2).then_some(piece));
            }
            pieces.extend(run.map(|from| self.rectangle(from, self.x.len() - 1, j)));
        }
        pieces
    }

    /// The level's line as pairs of points with a gap (NaN) after each.
    #[must_use]
    pub fn line(&self, level: f64) -> Vec<(f64, f64)> {
        let mut line = Vec::new();
        for j in 0..self.y.len().saturating_sub(1) {
            for i in 0..self.x.len().saturating_sub(1) {
                let crossings = crossings(self.cell(i, j), level);
                for pair in crossings.chunks_exact(2) {
                    line.extend([pair[0], pair[1], (f64::NAN, f64::NAN)]);
                }
            }
        }
        line
    }

    /// The corners of a cell, around it.
    fn cell(&self, i: usize, j: usize) -> [((f64, f64), f64); 4] {
        [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
            let value = self.values[j * self.x.len() + i];
            ((self.x[i], self.y[j]), if value.is_nan() { f64::INFINITY } else { value })
        })
    }

    fn rectangle(&self, from: usize, to: usize, j: usize) -> Vec<(f64, f64)> {
        let ([left, right], [low, high]) = ([self.x[from], self.x[to]], [self.y[j], self.y[j + 1]]);
        vec![(left, low), (right, low), (right, high), (left, high)]
    }
}

type Corner = ((f64, f64), f64);

/// The part of a cell at or below `level`.
fn below(corners: [Corner; 4], level: f64) -> Vec<(f64, f64)> {
    let mut outline = Vec::new();
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        if a.1 <= level {
            outline.push(a.0);
        }
        outline.extend(crossing(a, b, level));
    }
    outline
}

/// Where the four edges of a cell cross `level`: 0, 2 or 4 points, neighbours in pairs.
fn crossings(corners: [Corner; 4], level: f64) -> Vec<(f64, f64)> {
    (0..4).filter_map(|k| crossing(corners[k], corners[(k + 1) % 4], level)).collect()
}

/// Where the edge from `a` to `b` crosses `level`; half way to a corner that has no value.
fn crossing(a: Corner, b: Corner, level: f64) -> Option<(f64, f64)> {
    if (a.1 <= level) == (b.1 <= level) {
        return None;
    }
    let share = (level - a.1) / (b.1 - a.1);
    let share = if share.is_finite() && a.1.is_finite() && b.1.is_finite() { share } else { 0.5 };
    let between = |from: f64, to: f64| {
        // Cells of a log axis are equal in ratio, not in difference; over one cell both agree closely.
        from + share * (to - from)
    };
    Some((between(a.0.0, b.0.0), between(a.0.1, b.0.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cone(n: usize) -> Grid {
        let axis: Vec<f64> = (0..n).map(|i| -1.0 + 2.0 * i as f64 / (n - 1) as f64).collect();
        let values = axis.iter().flat_map(|y| axis.iter().map(move |x| x.hypot(*y))).collect();
        Grid::new(axis.clone(), axis, values)
    }

    /// Shoelace formula.
    fn area(outline: &[(f64, f64)]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        0.5 * outline.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>()
    }

    #[test]
    fn a_cone_is_cut_in_circles() {
        let cone = cone(101);
        for radius in [0.3, 0.7] {
            let found: f64 = cone.region(radius).iter().map(|piece| area(piece)).sum();
            let expected = std::f64::consts::PI * radius * radius;
            assert!((found / expected - 1.0).abs() < 2e-3, "area {found}, expected {expected}");
            let line = cone.line(radius);
            assert!(line.iter().filter(|p| !p.0.is_nan()).all(|p| (p.0.hypot(p.1) - radius).abs() < 1e-3), "{radius}");
        }
        assert!((cone.region(9.0).iter().map(|piece| area(piece)).sum::<f64>() - 4.0).abs() < 1e-12, "all of it");
        assert!(cone.region(-1.0).is_empty() && cone.line(-1.0).is_empty(), "none of it");
    }

    #[test]
    fn missing_values_are_above_every_level() {
        let grid = Grid::new(vec![0.0, 1.0], vec![0.0, 1.0], vec![0.0, 0.0, f64::NAN]);
        let found: f64 = grid.region(1.0).iter().map(|piece| area(piece)).sum();
        assert!((found - 0.5).abs() < 1e-12, "the lower half, not {found}");
        assert!(Grid::new(vec![], vec![], vec![]).region(1.0).is_empty(), "no grid");
    }
}
