//! How good a front is, in one number: hypervolume, distance to the true front, spread.
//!
//! All objectives are minimised. Distances add objectives up, so scale these alike first.

mod hypervolume;
#[cfg(test)]
mod tests;

pub use hypervolume::hypervolume;

/// Mean over `truth` (points of the true front) of the Euclidean distance to the nearest point of `front`; 0 = all of
/// them are in it, infinite without any point.
///
/// C. A. Coello Coello, M. Reyes Sierra, MICAI 2004, doi 10.1007/978-3-540-24694-7_71.
#[must_use]
pub fn igd(front: &[&[f64]], truth: &[&[f64]]) -> f64 {
    mean_nearest(front, truth, |found, true_cost| found - true_cost)
}

/// As [`igd`] with, in place of the distance, how far the point of `front` is **behind**: differences count only where
/// its cost is above the true one. Unlike IGD it never calls a front better that another one dominates.
///
/// H. Ishibuchi, H. Masuda, Y. Tanigaki, Y. Nojima, EMO 2015, doi 10.1007/978-3-319-15892-1_8.
#[must_use]
pub fn igd_plus(front: &[&[f64]], truth: &[&[f64]]) -> f64 {
    mean_nearest(front, truth, |found, true_cost| (found - true_cost).max(0.0))
}

fn mean_nearest(front: &[&[f64]], truth: &[&[f64]], difference: impl Fn(f64, f64) -> f64) -> f64 {
    if truth.is_empty() {
        return f64::INFINITY;
    }
    let length = |found: &[f64], point: &[f64]| {
        found.iter().zip(point).map(|(a, z)| difference(*a, *z).powi(2)).sum::<f64>().sqrt()
    };
    let nearest = |point: &&[f64]| front.iter().map(|found| length(found, point)).fold(f64::INFINITY, f64::min);
    truth.iter().map(nearest).sum::<f64>() / truth.len() as f64
}

/// How unevenly `front` is spread over the true one, whose extreme points are `ends`; 0 = evenly and to the ends. Infinite
/// for fewer than two points.
///
/// For two objectives Deb's Delta (doi 10.1109/4235.996017): with the distances d_i between neighbours along the front,
/// their mean d, and the distances e of the front's first and last point to the ends,
/// (e_1 + e_2 + sum |d_i - d|) / (e_1 + e_2 + sum d_i). For more the generalisation of A. Zhou et al., CEC 2006,
/// doi 10.1109/CEC.2006.1688406: d_i is the distance of point i to its nearest neighbour, and e_k that of end k to the
/// nearest point.
#[must_use]
pub fn spread(front: &[&[f64]], ends: &[&[f64]]) -> f64 {
    if front.len() < 2 {
        return f64::INFINITY;
    }
    let (gaps, to_ends) = if front[0].len() == 2 { along(front, ends) } else { nearest(front, ends) };
    let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
    let uneven: f64 = gaps.iter().map(|gap| (gap - mean).abs()).sum();
    (to_ends + uneven) / (to_ends + gaps.iter().sum::<f64>())
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Gaps between neighbours by the first objective, and the sum of the distances of the outermost points to the ends.
fn along(front: &[&[f64]], ends: &[&[f64]]) -> (Vec<f64>, f64) {
    let sorted = |points: &[&[f64]]| {
        let mut sorted: Vec<Vec<f64>> = points.iter().map(|point| point.to_vec()).collect();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(b[1].total_cmp(&a[1])));
        sorted
    };
    let (front, ends) = (sorted(front), sorted(ends));
    let gaps = front.windows(2).map(|pair| distance(&pair[0], &pair[1])).collect();
    let outer = |of: &[Vec<f64>]| of.first().cloned().into_iter().chain(of.last().cloned());
    (gaps, outer(&front).zip(outer(&ends)).map(|(a, b)| distance(&a, &b)).sum())
}

/// Distance of every point to its nearest neighbour, and the sum of those of the ends to the nearest point.
fn nearest(front: &[&[f64]], ends: &[&[f64]]) -> (Vec<f64>, f64) {
    let least = |distances: &mut dyn Iterator<Item = f64>| distances.fold(f64::INFINITY, f64::min);
    let gap = |i: usize| {
        let others = front.iter().enumerate().filter(|(j, _)| *j != i);
        least(&mut others.map(|(_, other)| distance(front[i], other)))
    };
    let to_front = |end: &&[f64]| least(&mut front.iter().map(|point| distance(end, point)));
    ((0..front.len()).map(gap).collect(), ends.iter().map(to_front).sum())
}
