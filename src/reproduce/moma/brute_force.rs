//! Ranks and crowding distances by their definitions, in O(N^2) and more, against which the fast ones are held.

use crate::optimize::pareto::{self, Scores};
use crate::random::{Purpose, Stream};

/// Fronts peeled off one after another: the candidates that no remaining one dominates.
fn ranks(points: &[[f64; 2]]) -> Vec<usize> {
    let dominates = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && (a[0] < b[0] || a[1] < b[1]);
    let mut rank = vec![usize::MAX; points.len()];
    for front in 0..points.len() {
        let left: Vec<usize> = (0..points.len()).filter(|i| rank[*i] == usize::MAX).collect();
        for i in &left {
            if !left.iter().any(|j| dominates(&points[*j], &points[*i])) {
                rank[*i] = front;
            }
        }
    }
    rank
}

/// For each front and objective: a stable sort by index, both extremes infinite, others plus (next - previous) / (max -
/// min). Of copies, the first at the low end and the last at the high end are the extremes.
fn crowding(points: &[[f64; 2]], rank: &[usize]) -> Vec<f64> {
    let mut distance = vec![0.0; points.len()];
    for front in 0..points.len() {
        for objective in 0..2 {
            let value = |i: usize| points[i][objective];
            let mut members: Vec<usize> = (0..points.len()).filter(|i| rank[*i] == front).collect();
            members.sort_by(|i, j| value(*i).total_cmp(&value(*j)));
            let (Some(&first), Some(&last)) = (members.first(), members.last()) else { continue };
            let width = value(last) - value(first);
            for three in members.windows(3) {
                let share = (value(three[2]) - value(three[0])) / width;
                distance[three[1]] += if width > 0.0 { share } else { 0.0 };
            }
            distance[first] = f64::INFINITY;
            distance[last] = f64::INFINITY;
        }
    }
    distance
}

/// Candidates of which every third is a copy of an earlier one, and whose values repeat besides.
fn random_front(seed: u64, index: u64) -> Vec<[f64; 2]> {
    let mut stream = Stream::new(seed, Purpose::Workload, u64::MAX, index);
    let mut points: Vec<[f64; 2]> = Vec::new();
    for i in 0..40_usize {
        let copied = if i % 3 == 2 { points.get((stream.uniform() * i as f64) as usize).copied() } else { None };
        let fresh = [(stream.uniform() * 12.0).floor() / 4.0, stream.uniform()];
        points.push(copied.unwrap_or(fresh));
    }
    points
}

/// On how many of `fronts` random sets ranks and crowding distances agree.
pub(super) fn agreements(seed: u64, fronts: u64) -> u64 {
    let agrees = |index: &u64| {
        let points = random_front(seed, *index);
        let mut scores = Scores::new(2);
        points.iter().for_each(|p| scores.push(p, 0.0));
        let (slow, fast) = (ranks(&points), pareto::fronts(&scores));
        let near = |(a, b): (&f64, &f64)| a.total_cmp(b).is_eq() || (a - b).abs() < 1e-12;
        fast == slow && pareto::crowding(&scores, &fast).iter().zip(&crowding(&points, &slow)).all(near)
    };
    (0..fronts).filter(agrees).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let points = [[1.0, 4.0], [2.0, 2.0], [4.0, 1.0], [3.0, 3.0], [1.0, 4.0]];
        let rank = ranks(&points);
        assert_eq!(rank, [0, 0, 0, 1, 0]);
        let distance = crowding(&points, &rank);
        // f1 in order: 0, 4, 1, 2; f2: 2, 1, 0, 4. So 4 is inside for f1 and an extreme for f2.
        assert!((distance[1] - 2.0).abs() < 1e-15, "{distance:?}");
        assert!([0, 2, 3, 4].iter().all(|i| distance[*i].is_infinite()), "{distance:?}");
    }

    #[test]
    fn random_fronts_have_copies() {
        let points = random_front(1, 0);
        assert!(points.iter().enumerate().any(|(i, p)| points[..i].contains(p)), "{points:?}");
        assert_eq!(agreements(1, 50), 50);
    }
}
