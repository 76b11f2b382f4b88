//! A curve through points: what `table("ocv.csv", x)` looks up.

use std::fmt;

/// A piecewise cubic through points, monotone where they are (Fritsch and Carlson 1980, SIAM J. Numer. Anal. 17, 238),
/// with a continuous derivative; beyond its ends it goes on straight.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    file: String,
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

/// A cubic between two points, in t = x - start: y(start) + t (linear + t (square + t cube)), for t from 0 to length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Its first x.
    pub start: f64,
    /// How far it goes.
    pub length: f64,
    /// How much y rises over it.
    pub rise: f64,
    /// Coefficient of t, the slope at its start.
    pub linear: f64,
    /// Coefficient of t^2.
    pub square: f64,
    /// Coefficient of t^3.
    pub cube: f64,
}

/// Why points are no curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoCurve {
    /// Fewer than two points.
    TooFew,
    /// The x of a point, by its index, is not above the one before.
    NotIncreasing(usize),
    /// Numbers so large, or points so close, that a slope is not finite.
    NotFinite,
}

impl Curve {
    /// Through the points (x, y), as many of each; `file` is what formulas call it.
    pub(crate) fn new(file: &str, x: Vec<f64>, y: Vec<f64>) -> Result<Self, NoCurve> {
        if x.len() < 2 || x.len() != y.len() {
            return Err(NoCurve::TooFew);
        }
        if let Some(i) = x.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(NoCurve::NotIncreasing(i + 1));
        }
        let slopes = slopes(&x, &y);
        let curve = Self { file: file.to_owned(), x, y, slopes };
        let finite = |piece: Piece| {
            [piece.length, piece.rise, piece.linear, piece.square, piece.cube].iter().all(|v| v.is_finite())
        };
        let ends = curve.slopes.iter().all(|slope| slope.is_finite());
        if ends && curve.pieces().all(finite) { Ok(curve) } else { Err(NoCurve::NotFinite) }
    }

    /// The file that it was read from, as the formula names it.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The x of its points, increasing.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// The y of its points.
    #[must_use]
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// The slopes at its points.
    #[must_use]
    pub fn slopes(&self) -> &[f64] {
        &self.slopes
    }

    /// The cubics between its points, in order.
    pub fn pieces(&self) -> impl Iterator<Item = Piece> + '_ {
        (1..self.x.len()).map(|i| {
            let (length, rise) = (self.x[i] - self.x[i - 1], self.y[i] - self.y[i - 1]);
            let (first, last, mean) = (self.slopes[i - 1], self.slopes[i], rise / length);
            let square = (3.0 * mean - 2.0 * first - last) / length;
            let cube = (first + last - 2.0 * mean) / (length * length);
            Piece { start: self.x[i - 1], length, rise, linear: first, square, cube }
        })
    }

    /// Value and slope at x, by Hermite's form on the segment that x is in.
    pub(crate) fn at(&self, x: f64) -> (f64, f64) {
        let last = self.x.len() - 1;
        let beyond = |i: usize| (self.y[i] + (x - self.x[i]) * self.slopes[i], self.slopes[i]);
        if x < self.x[0] {
            return beyond(0);
        }
        if x >= self.x[last] {
            return beyond(last);
        }
        let i = self.x.partition_point(|knot| *knot <= x).clamp(1, last);
        let length = self.x[i] - self.x[i - 1];
        let (t, u) = ((x - self.x[i - 1]) / length, (self.x[i] - x) / length);
        let (from, to) = (self.slopes[i - 1] * length, self.slopes[i] * length);
        let value =
            u * u * ((1.0 + 2.0 * t) * self.y[i - 1] + t * from) + t * t * ((1.0 + 2.0 * u) * self.y[i] - u * to);
        let rise = self.y[i] - self.y[i - 1];
        let slope = (6.0 * t * u * rise + u * (1.0 - 3.0 * t) * from + t * (1.0 - 3.0 * u) * to) / length;
        (value, slope)
    }
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quote = if self.file.contains('"') { '\'' } else { '"' };
        write!(f, "{quote}{}{quote}", self.file)
    }
}

/// Slopes at the points: of the parabola through three neighbours, 0 where the data turn; at the ends those of the first and
/// last chord. Then, chord by chord, as small as Fritsch and Carlson's circle of radius 3 asks for.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let length: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let chord: Vec<f64> = y.windows(2).zip(&length).map(|(pair, length)| (pair[1] - pair[0]) / length).collect();
    let inner = (1..chord.len()).map(|i| {
        let (before, after) = (chord[i - 1], chord[i]);
        let turns = before <= 0.0 && after >= 0.0 || before >= 0.0 && after <= 0.0;
        if turns { 0.0 } else { (length[i] * before + length[i - 1] * after) / (length[i] + length[i - 1]) }
    });
    let mut slopes: Vec<f64> = chord.first().copied().into_iter().chain(inner).chain(chord.last().copied()).collect();
    for (i, chord) in chord.iter().enumerate().filter(|(_, chord)| chord.abs() > 0.0) {
        let radius = (slopes[i] / chord).hypot(slopes[i + 1] / chord);
        if radius > 3.0 {
            slopes[i] *= 3.0 / radius;
            slopes[i + 1] *= 3.0 / radius;
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve(points: &[(f64, f64)]) -> Curve {
        let (x, y) = points.iter().copied().unzip();
        Curve::new("c.csv", x, y).unwrap()
    }

    #[test]
    fn a_line_is_kept_and_goes_on() {
        let line = curve(&[(0.0, 1.0), (1.0, 3.0), (4.0, 9.0)]);
        for x in [-5.0, 0.0, 0.3, 1.0, 2.7, 4.0, 11.0] {
            let (value, slope) = line.at(x);
            assert!((value - (1.0 + 2.0 * x)).abs() < 1e-14 && (slope - 2.0).abs() < 1e-14, "{x}: {value}, {slope}");
        }
    }

    /// By hand: chords 1 and 4 make the parabola's slope 2.5 at the middle; the first chord has (1, 2.5), inside the circle.
    #[test]
    fn slopes_by_hand() {
        assert_eq!(curve(&[(0.0, 0.0), (1.0, 1.0), (2.0, 5.0)]).slopes(), [1.0, 2.5, 4.0]);
        assert_eq!(curve(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]).slopes(), [1.0, 0.0, -1.0], "the data turn");
        // Chords 1 and 9: 5 at the middle, and (1, 5) is shrunk to the radius 3.
        let steep = curve(&[(0.0, 0.0), (1.0, 1.0), (2.0, 10.0)]);
        let shrunk = 3.0 / 26f64.sqrt();
        assert!((steep.slopes()[0] - shrunk).abs() < 1e-15 && (steep.slopes()[1] - 5.0 * shrunk).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_curve() {
        assert_eq!(Curve::new("c", vec![1.0], vec![1.0]), Err(NoCurve::TooFew));
        assert_eq!(Curve::new("c", vec![1.0, 2.0, 2.0], vec![1.0; 3]), Err(NoCurve::NotIncreasing(2)));
        assert_eq!(Curve::new("c", vec![0.0, 1e-300], vec![0.0, 1e300]), Err(NoCurve::NotFinite));
    }

    proptest! {
        /// It goes through its points, with one slope from both sides, and rises wherever they do.
        #[test]
        fn it_is_smooth_and_monotone_where_the_points_are(
            steps in prop::collection::vec((0.01f64..10.0, -5.0f64..5.0), 1..12),
            rising in any::<bool>(),
        ) {
            let mut points = vec![(-3.0, 0.5)];
            for (dx, dy) in steps {
                let (x, y) = points[points.len() - 1];
                points.push((x + dx, y + if rising { dy.abs() } else { dy }));
            }
            let curve = curve(&points);
            for ((x, y), piece) in points.iter().zip(curve.pieces()) {
                prop_assert!((curve.at(*x).0 - y).abs() < 1e-12);
                let end = piece.length;
                let slope = piece.linear + end * (2.0 * piece.square + 3.0 * end * piece.cube);
                let expected = curve.at(x + end).1;
                prop_assert!((slope - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{} {}", slope, expected);
                for k in 0..20 {
                    let t = end * f64::from(k) / 20.0;
                    let (value, slope) = curve.at(x + t);
                    let cubic = y + t * (piece.linear + t * (piece.square + t * piece.cube));
                    prop_assert!((value - cubic).abs() < 1e-11, "{} {}", value, cubic);
                    prop_assert!(!rising || slope >= -1e-9, "slope {}", slope);
                }
            }
        }
    }
}
