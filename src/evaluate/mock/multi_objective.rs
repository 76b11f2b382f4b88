//! Functions of several objectives with a known Pareto front.

use std::f64::consts::{FRAC_PI_2, PI};

/// Test functions on the unit box. Their fronts are where all but the leading coordinates stand at their optimum.
///
/// E. Zitzler, K. Deb, L. Thiele, Evol. Comput. 8 (2000), doi 10.1162/106365600568202 (ZDT); K. Deb, L. Thiele,
/// M. Laumanns, E. Zitzler, CEC 2002, doi 10.1109/CEC.2002.1007032 (DTLZ).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultiObjective {
    /// A convex front f2 = 1 - sqrt(f1).
    Zdt1,
    /// A concave front f2 = 1 - f1^2.
    Zdt2,
    /// Five pieces of f2 = 1 - sqrt(f1) - f1 sin(10 pi f1).
    Zdt3,
    /// A concave front f2 = 1 - f1^2 from f1 = 0.28 on, with few candidates near it and unevenly spread along it.
    Zdt6,
    /// An octant (orthant) of the unit sphere in this many objectives.
    Dtlz2(usize),
}

impl MultiObjective {
    /// Number of objectives.
    #[must_use]
    pub const fn objectives(self) -> usize {
        match self {
            Self::Dtlz2(objectives) => objectives,
            _ => 2,
        }
    }

    /// The unit box in the number of coordinates of the publications: 30, 10 for ZDT6, and ten more than angles for DTLZ2.
    #[must_use]
    pub fn bounds(self) -> Vec<[f64; 2]> {
        let coordinates = match self {
            Self::Zdt6 => 10,
            Self::Dtlz2(objectives) => objectives + 9,
            _ => 30,
        };
        vec![[0.0, 1.0]; coordinates]
    }

    /// Costs at `x`, of at least two coordinates (for DTLZ2, as many as objectives).
    #[must_use]
    pub fn values(self, x: &[f64]) -> Vec<f64> {
        let mean = x[1..].iter().sum::<f64>() / (x.len() - 1) as f64;
        match self {
            Self::Dtlz2(objectives) => sphere(x, objectives),
            Self::Zdt6 => {
                let first = 1.0 - (-4.0 * x[0]).exp() * (6.0 * PI * x[0]).sin().powi(6);
                self.pair(first, 1.0 + 9.0 * mean.powf(0.25))
            }
            _ => self.pair(x[0], 1.0 + 9.0 * mean),
        }
    }

    /// f1 and f2 = g h(f1, g).
    fn pair(self, first: f64, g: f64) -> Vec<f64> {
        let ratio = first / g;
        let shape = match self {
            Self::Zdt1 => 1.0 - ratio.sqrt(),
            Self::Zdt3 => 1.0 - ratio.sqrt() - ratio * (10.0 * PI * first).sin(),
            _ => 1.0 - ratio * ratio,
        };
        vec![first, g * shape]
    }

    /// Points of the front. For two objectives `n` of them, evenly spaced in f1 (n / 5 on each piece of ZDT3); for DTLZ2
    /// a simplex lattice with `n` steps on each edge, projected on the sphere.
    #[must_use]
    pub fn front(self, n: usize) -> Vec<Vec<f64>> {
        let pieces: &[[f64; 2]] = match self {
            Self::Dtlz2(objectives) => return lattice(objectives, n),
            Self::Zdt3 => &ZDT3_PIECES,
            Self::Zdt6 => &[[ZDT6_START, 1.0]],
            _ => &[[0.0, 1.0]],
        };
        let each = n / pieces.len();
        let place = |low: f64, high: f64, i: usize| low + (high - low) * i as f64 / (each - 1) as f64;
        let points = pieces.iter().flat_map(|[low, high]| (0..each).map(move |i| place(*low, *high, i)));
        points.map(|first| self.pair(first, 1.0)).collect()
    }
}

/// f1 on the pieces of ZDT3's front: each begins where f2 has fallen to the minimum before, and ends at its own minimum.
const ZDT3_PIECES: [[f64; 2]; 5] = [
    [0.0, 0.083_001_534_9],
    [0.182_228_728_0, 0.257_762_363_4],
    [0.409_313_674_8, 0.453_882_104_1],
    [0.618_396_794_4, 0.652_511_703_8],
    [0.823_331_798_3, 0.851_832_865_4],
];

/// The least f1 of ZDT6, at x1 = 0.0814.
const ZDT6_START: f64 = 0.280_775_318_8;

/// (1 + g) times the point of the unit sphere at the angles pi/2 x_1 ... pi/2 x_(M-1).
fn sphere(x: &[f64], objectives: usize) -> Vec<f64> {
    let (angles, rest) = x.split_at(objectives - 1);
    let radius = 1.0 + rest.iter().map(|x| (x - 0.5).powi(2)).sum::<f64>();
    let cosines = |count: usize| angles[..count].iter().map(|x| (FRAC_PI_2 * x).cos()).product::<f64>();
    let sine = |i: usize| angles.get(objectives - 1 - i).map_or(1.0, |x| (FRAC_PI_2 * x).sin());
    (0..objectives).map(|i| radius * cosines(objectives - 1 - i) * sine(i)).collect()
}

/// All (k_1, ..., k_M) / n with whole k_i >= 0 that sum to n, scaled to unit length.
fn lattice(objectives: usize, n: usize) -> Vec<Vec<f64>> {
    let mut counts = vec![Vec::new()];
    for objective in 0..objectives {
        let extend = |head: Vec<usize>| {
            let left = n - head.iter().sum::<usize>();
            let least = if objective + 1 == objectives { left } else { 0 };
            (least..=left).map(move |k| [head.as_slice(), &[k]].concat())
        };
        counts = counts.into_iter().flat_map(extend).collect();
    }
    let unit = |counts: Vec<usize>| {
        let length = counts.iter().map(|k| (k * k) as f64).sum::<f64>().sqrt();
        counts.iter().map(|k| *k as f64 / length).collect()
    };
    counts.into_iter().map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimize::pareto::{Scores, dominates, fronts};
    use crate::random::{Purpose, Stream};

    const ALL: [MultiObjective; 6] = [
        MultiObjective::Zdt1,
        MultiObjective::Zdt2,
        MultiObjective::Zdt3,
        MultiObjective::Zdt6,
        MultiObjective::Dtlz2(3),
        MultiObjective::Dtlz2(4),
    ];

    /// By hand: g = 1 + 9 x 0.25 = 3.25 for ZDT1-3 with x = (0.25, 0.25, 0.25).
    #[test]
    fn values_by_hand() {
        let x = [0.25; 3];
        let cases = [
            (MultiObjective::Zdt1, vec![0.25, 3.25 - (0.25_f64 * 3.25).sqrt()]),
            (MultiObjective::Zdt2, vec![0.25, 3.25 - 0.0625 / 3.25]),
            (MultiObjective::Zdt3, vec![0.25, 3.25 - (0.25_f64 * 3.25).sqrt() - 0.25]),
            (MultiObjective::Dtlz2(2), vec![1.125 * (PI / 8.0).cos(), 1.125 * (PI / 8.0).sin()]),
        ];
        for (function, expected) in cases {
            for (found, expected) in function.values(&x).iter().zip(expected) {
                assert!((found - expected).abs() < 1e-14, "{function:?}: {found}, expected {expected}");
            }
        }
        let first = 1.0 - (-1.0_f64).exp();
        let g = 1.0 + 9.0 * 0.25_f64.powf(0.25);
        let found = MultiObjective::Zdt6.values(&x);
        assert!((found[0] - first).abs() < 1e-14 && (found[1] - (g - first * first / g)).abs() < 1e-14, "{found:?}");
    }

    /// No point of a front dominates another, and no candidate dominates a point of a front.
    #[test]
    fn nothing_dominates_the_fronts() {
        for function in ALL {
            let front = function.front(if function.objectives() == 2 { 500 } else { 12 });
            let mut scores = Scores::new(function.objectives());
            front.iter().for_each(|costs| scores.push(costs, 0.0));
            let ranks = fronts(&scores);
            // The pieces of ZDT3 are known to ten digits, so their ends may dominate each other by less than that.
            assert!(ranks.iter().filter(|rank| **rank > 0).count() <= 4, "{function:?}");
            for index in 0..2000 {
                let mut stream = Stream::new(1, Purpose::Workload, 0, index);
                let shrink = if index % 2 == 0 { 1.0 } else { 1e-3 };
                let rest = if matches!(function, MultiObjective::Dtlz2(_)) { 0.5 } else { 0.0 };
                let mut x: Vec<f64> = function.bounds().iter().map(|_| stream.uniform()).collect();
                x[1..].iter_mut().for_each(|x| *x = rest + shrink * (*x - rest));
                let above: Vec<f64> = function.values(&x).iter().map(|cost| cost + 1e-8).collect();
                assert!(!front.iter().any(|point| dominates(&above, point)), "{function:?} at {x:?}");
            }
        }
    }

    #[test]
    fn sizes_of_fronts() {
        assert_eq!(MultiObjective::Dtlz2(3).front(30).len(), 496);
        assert_eq!(MultiObjective::Zdt3.front(2000).len(), 2000);
        let on_sphere = |point: &Vec<f64>| (point.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-14;
        assert!(MultiObjective::Dtlz2(4).front(7).iter().all(on_sphere));
    }
}
