//! Which member of a front to take.

use super::Among;
use crate::model::Pick;

/// Places on a front that have a name, as indices of its members.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Landmarks {
    /// The knee: the member farthest on the good side of the plane through the ends (see [`Landmarks::of`]); where no
    /// member lies on that side, the most even one.
    pub knee: usize,
    /// Whether the front has a knee at all.
    pub has_knee: bool,
    /// The best member in each objective.
    pub ends: Vec<usize>,
    /// What the problem asks for.
    pub recommended: usize,
    /// The members that the recommended one was chosen from; all, before [`crate::study::Outcome::prefer_consistent`].
    pub among: Among,
}

impl Landmarks {
    /// Of a front's objectives, one row a member; `None` of an empty front.
    ///
    /// Objectives are scaled so that the front spans 0 to 1 in each: u = (f - best) / (worst - best). The **knee** has the
    /// smallest sum of u: it lies farthest from the plane sum u = 1, which in two objectives is the chord between the ends
    /// (I. Das, Struct. Optim. 18 (1999), doi 10.1007/BF01195985); for more objectives this is the minimum Manhattan
    /// distance (W.-Y. Chiu, G. G. Yen, T.-K. Juan, IEEE Trans. Evol. Comput. 20 (2016), doi 10.1109/TEVC.2016.2564158).
    /// Of a front that bulges the other way this would be an end; then the member whose largest u is smallest stands in.
    /// **Weights** ask for the smallest weighted sum of u.
    #[must_use]
    pub fn of(front: &[Vec<f64>], pick: &Pick) -> Option<Self> {
        let objectives = front.first()?.len();
        let scaled = scaled(front);
        let sum = |u: &[f64]| u.iter().sum::<f64>();
        let ends: Vec<usize> = (0..objectives).filter_map(|j| best(&scaled, |u| (u[j], sum(u)))).collect();
        let nearest = best(&scaled, |u| (sum(u), largest(u)))?;
        // The ends themselves lie on the plane, but for rounding.
        let has_knee = objectives < 2 || sum(&scaled[nearest]) < 1.0 - 1e-9;
        let knee = knee_of(front, has_knee, &vec![true; front.len()])?;
        let recommended = match pick {
            Pick::Knee => knee,
            Pick::Best(j) => *ends.get(*j)?,
            Pick::Weights(weights) => {
                let weighted = |u: &[f64]| u.iter().zip(weights).map(|(u, w)| u * w).sum::<f64>();
                best(&scaled, |u| (weighted(u), sum(u)))?
            }
        };
        Some(Self { knee, has_knee, ends, recommended, among: Among::All })
    }
}

/// The knee of the members that are allowed, or the most even of them, on the scale of the whole front; `None` without any.
pub(super) fn knee_of(front: &[Vec<f64>], has_knee: bool, allowed: &[bool]) -> Option<usize> {
    let scaled = scaled(front);
    let key = |u: &[f64]| {
        let (sum, largest) = (u.iter().sum::<f64>(), largest(u));
        if has_knee { (sum, largest) } else { (largest, sum) }
    };
    let mut members = (0..front.len()).filter(|i| allowed.get(*i) == Some(&true)).map(|i| (i, key(&scaled[i])));
    let first = members.next()?;
    let less = |a: (f64, f64), b: (f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).is_lt();
    Some(members.fold(first, |best, next| if less(next.1, best.1) { next } else { best }).0)
}

/// Objectives scaled to the front's range; 0 where it has none.
fn scaled(front: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let fold = |by: fn(f64, f64) -> f64, from: f64| {
        let merge = |limits: Vec<f64>, row: &Vec<f64>| limits.iter().zip(row).map(|(a, b)| by(*a, *b)).collect();
        front.iter().fold(vec![from; front.first().map_or(0, Vec::len)], merge)
    };
    let (low, high) = (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY));
    let scale = |((f, low), high): ((&f64, &f64), &f64)| if high > low { (f - low) / (high - low) } else { 0.0 };
    front.iter().map(|row| row.iter().zip(&low).zip(&high).map(scale).collect()).collect()
}

fn largest(u: &[f64]) -> f64 {
    u.iter().copied().fold(0.0, f64::max)
}

/// The member with the smallest key, the first of equals.
fn best(scaled: &[Vec<f64>], key: impl Fn(&[f64]) -> (f64, f64)) -> Option<usize> {
    let keys: Vec<(f64, f64)> = scaled.iter().map(|u| key(u)).collect();
    (0..keys.len()).min_by(|a, b| keys[*a].0.total_cmp(&keys[*b].0).then(keys[*a].1.total_cmp(&keys[*b].1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn landmarks(front: &[[f64; 2]], pick: &Pick) -> Landmarks {
        let rows: Vec<Vec<f64>> = front.iter().map(|row| row.to_vec()).collect();
        Landmarks::of(&rows, pick).expect("a front that is not empty")
    }

    /// f2 = 1 / f1 from 1/10 to 10: by symmetry the chord is farthest at (1, 1), in whatever units.
    #[test]
    fn the_knee_of_a_hyperbola_is_its_vertex() {
        let x = [0.1, 0.2, 0.5, 0.8, 1.0, 1.25, 2.0, 5.0, 10.0];
        for [a, b] in [[1.0, 1.0], [1e6, 1e-3]] {
            let front: Vec<[f64; 2]> = x.iter().map(|x| [a * x - 3.0, b / x + 7.0]).collect();
            let found = landmarks(&front, &Pick::Knee);
            assert_eq!((found.knee, found.has_knee, found.recommended), (4, true, 4));
            assert_eq!(found.ends, [0, 8]);
            assert_eq!(landmarks(&front, &Pick::Best(1)).recommended, 8);
        }
    }

    /// u = (0, 1), (0.2, 0.5), (0.4, 0.3), (1, 0): sums 1, 0.7, 0.7, 1.
    #[test]
    fn weights_move_along_the_front_and_ties_go_to_the_evener() {
        let front = [[0.0, 10.0], [2.0, 5.0], [4.0, 3.0], [10.0, 0.0]];
        assert_eq!(landmarks(&front, &Pick::Knee).recommended, 2);
        let by = |weights: [f64; 2]| landmarks(&front, &Pick::Weights(weights.to_vec())).recommended;
        assert_eq!([by([1.0, 0.0]), by([0.7, 0.3]), by([0.4, 0.6]), by([0.0, 1.0])], [0, 1, 2, 3]);
    }

    #[test]
    fn a_front_that_bulges_outwards_has_no_knee_but_an_even_member() {
        let circle: Vec<[f64; 2]> =
            (0..=8).map(|i| (f64::from(i) * std::f64::consts::PI / 16.0).sin_cos().into()).collect();
        let found = landmarks(&circle, &Pick::Knee);
        assert_eq!((found.knee, found.has_knee), (4, false));
        let line = [[0.0, 1.0], [0.3, 0.7], [0.55, 0.45], [1.0, 0.0]];
        assert_eq!((landmarks(&line, &Pick::Knee).knee, landmarks(&line, &Pick::Knee).has_knee), (2, false));
    }

    #[test]
    fn one_member_is_everything_and_no_member_nothing() {
        let found = landmarks(&[[3.0, 4.0]], &Pick::Knee);
        assert_eq!((found.knee, found.ends, found.recommended), (0, vec![0, 0], 0));
        assert_eq!(Landmarks::of(&[], &Pick::Knee), None);
    }

    /// Sums of u: 1, 1, 1, 0.6 and 0.75; the plane through the three ends is sum u = 1.
    #[test]
    fn in_three_objectives_the_knee_has_the_least_manhattan_distance() {
        let u = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.2, 0.2], [0.05, 0.1, 0.6]];
        let front: Vec<Vec<f64>> = u.iter().map(|u| vec![3.0 * u[0] - 1.0, u[1], 1e3 * u[2]]).collect();
        let found = Landmarks::of(&front, &Pick::Knee).expect("a front");
        assert_eq!((found.knee, found.has_knee), (3, true));
        assert_eq!(found.ends, [1, 0, 0], "of equals the evener, then the first");
    }
}
