//! Built-in sensors: what a position, seen from another, measures.

use super::{call, minus, over, plus, power, times};
use crate::model::{Expr, Function};

/// Every built-in sensor.
pub(crate) const SENSORS: [Sensor; 6] = [
    Sensor { name: "range", measures: 1, axes: 2, rates: false, angles: &[], h: |from, _| vec![distance(from)] },
    Sensor { name: "bearing", measures: 1, axes: 2, rates: false, angles: &[0], h: |from, _| vec![bearing(from)] },
    Sensor {
        name: "range-bearing",
        measures: 2,
        axes: 2,
        rates: false,
        angles: &[1],
        h: |from, _| vec![distance(from), bearing(from)],
    },
    Sensor {
        name: "range-bearing-elevation",
        measures: 3,
        axes: 3,
        rates: false,
        angles: &[1, 2],
        h: |from, _| vec![distance(from), bearing(from), elevation(from)],
    },
    Sensor {
        name: "range-rate",
        measures: 2,
        axes: 2,
        rates: true,
        angles: &[],
        h: |from, rates| vec![distance(from), range_rate(from, rates)],
    },
    Sensor { name: RANGES, measures: 1, axes: 2, rates: false, angles: &[], h: |from, _| vec![distance(from)] },
];

/// The sensor whose measurements each have a position of their own.
const RANGES: &str = "ranges";

/// One built-in sensor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sensor {
    /// Name in problem files (`h = "..."`).
    pub(crate) name: &'static str,
    /// Number of measurements of one position.
    pub(crate) measures: usize,
    /// Least number of axes.
    pub(crate) axes: usize,
    /// Whether it sees velocities.
    pub(crate) rates: bool,
    /// Which of its measurements are angles.
    pub(crate) angles: &'static [usize],
    /// Its formulas, from position and velocity less its own: one per axis.
    pub(crate) h: fn(&[Expr], &[Expr]) -> Vec<Expr>,
}

impl Sensor {
    /// Whether each of its measurements has a position of its own, which must be given.
    pub(crate) fn has_beacons(&self) -> bool {
        self.name == RANGES
    }
}

/// A less what is given of B.
pub(crate) fn offset(a: Expr, b: Option<Expr>) -> Expr {
    match b {
        Some(b) => minus(a, b),
        None => a,
    }
}

/// sqrt(x^2 + y^2 + ...).
fn distance(from: &[Expr]) -> Expr {
    let squares = from.iter().map(|x| power(x.clone(), 2));
    call(Function::Sqrt, &[squares.reduce(plus).unwrap_or(Expr::number(0.0))])
}

/// From the first axis towards the second.
fn bearing(from: &[Expr]) -> Expr {
    call(Function::Atan2, &[from[1].clone(), from[0].clone()])
}

/// Above the plane of the first two axes.
fn elevation(from: &[Expr]) -> Expr {
    call(Function::Atan2, &[from[2].clone(), distance(&from[..2])])
}

/// (x vx + y vy + ...) / range.
fn range_rate(from: &[Expr], rates: &[Expr]) -> Expr {
    let products = from.iter().zip(rates).map(|(x, v)| times(x.clone(), v.clone()));
    over(products.reduce(plus).unwrap_or(Expr::number(0.0)), distance(from))
}
