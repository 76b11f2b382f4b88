//! Variation of real-coded candidates: simulated binary crossover and polynomial mutation, each in two forms.
//!
//! K. Deb, R. B. Agrawal, "Simulated binary crossover for continuous search space", Complex Systems 9 (1995); K. Deb,
//! M. Goyal, "A combined genetic adaptive search (GeneAS) for engineering design", Comput. Sci. Inform. 26 (1996); the
//! bounded forms are those of Deb's own NSGA-II program.

use super::Space;
use crate::random::Stream;

/// How far apart two parents must be for a crossover to give something new.
const DISTINCT: f64 = 1e-14;

/// Limits of one coordinate, and the width that mutation and local search scale their steps by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower bound; -inf without one.
    pub lower: f64,
    /// Upper bound; +inf without one.
    pub upper: f64,
    /// `upper - lower`; without bounds the width of the first population, or 1 where that has none.
    pub width: f64,
}

impl Range {
    /// One a coordinate.
    #[must_use]
    pub fn of(space: &Space) -> Vec<Self> {
        let bounds = space.lower.iter().zip(&space.upper).zip(&space.init);
        bounds
            .map(|((lower, upper), [low, high])| {
                let (box_width, init_width) = (upper - lower, high - low);
                let scale = if init_width > 0.0 { init_width } else { 1.0 };
                let width = if box_width.is_finite() { box_width } else { scale };
                Self { lower: *lower, upper: *upper, width }
            })
            .collect()
    }

    const fn clip(&self, x: f64) -> f64 {
        x.max(self.lower).min(self.upper)
    }
}

/// Simulated binary crossover, in place on two parents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossover {
    /// eta_c: the larger, the nearer are children to their parents.
    pub index: f64,
    /// Whether the spread of the children ends at the bounds; then each coordinate takes part with probability 1/2 and
    /// the children exchange it with probability 1/2, as in Deb's program. Otherwise every coordinate is crossed by the
    /// unbounded formula and clipped.
    pub bounded: bool,
}

impl Crossover {
    /// Turns parents `a` and `b` into two children inside the bounds.
    pub fn apply(&self, a: &mut [f64], b: &mut [f64], ranges: &[Range], stream: &mut Stream) {
        for ((a, b), range) in a.iter_mut().zip(b).zip(ranges) {
            if !self.bounded {
                (*a, *b) = self.unbounded(*a, *b, stream.uniform());
            } else if stream.uniform() <= 0.5 && (*a - *b).abs() > DISTINCT {
                let (low, high) = self.within(a.min(*b), a.max(*b), range, stream.uniform());
                (*a, *b) = if stream.uniform() <= 0.5 { (high, low) } else { (low, high) };
            }
            *a = range.clip(*a);
            *b = range.clip(*b);
        }
    }

    /// beta is distributed such that children are as far from their parents as one-point crossover of bit strings puts
    /// them.
    fn unbounded(&self, a: f64, b: f64, u: f64) -> (f64, f64) {
        let beta = if u <= 0.5 { 2.0 * u } else { 0.5 / (1.0 - u) }.powf(1.0 / (self.index + 1.0));
        (0.5 * ((1.0 + beta) * a + (1.0 - beta) * b), 0.5 * ((1.0 - beta) * a + (1.0 + beta) * b))
    }

    /// Children of `low` < `high`, the distribution of each cut off at the bound on its side.
    fn within(&self, low: f64, high: f64, range: &Range, u: f64) -> (f64, f64) {
        let (sum, distance) = (low + high, high - low);
        let beta = |room: f64| {
            // 2 - alpha of the published form, written such that nothing cancels near u = 1.
            let beyond = (1.0 + 2.0 * room / distance).powf(-(self.index + 1.0));
            let share = u * (2.0 - beyond);
            let spread = if share <= 1.0 { share } else { 1.0 / (2.0 * (1.0 - u) + u * beyond) };
            spread.powf(1.0 / (self.index + 1.0))
        };
        (0.5 * (sum - beta(low - range.lower) * distance), 0.5 * (sum + beta(range.upper - high) * distance))
    }
}

/// Polynomial mutation, in place on one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mutation {
    /// p_m, for each coordinate.
    pub probability: f64,
    /// eta_m: the larger, the smaller are the steps.
    pub index: f64,
    /// Whether the distribution of the step ends at the bounds; otherwise it is the same everywhere, and clipped.
    pub bounded: bool,
}

impl Mutation {
    /// Mutates `x` inside the bounds.
    pub fn apply(&self, x: &mut [f64], ranges: &[Range], stream: &mut Stream) {
        for (x, range) in x.iter_mut().zip(ranges) {
            if stream.uniform() < self.probability && range.width > 0.0 {
                let u = stream.uniform();
                let step = if u < 0.5 {
                    self.power(2.0 * u, *x - range.lower, range.width) - 1.0
                } else {
                    1.0 - self.power(2.0 * (1.0 - u), range.upper - *x, range.width)
                };
                *x = range.clip(*x + step * range.width);
            }
        }
    }

    /// (v + (1 - v) (1 - room/width)^(eta + 1))^(1/(eta + 1)), where the second term is how much of the distribution lies
    /// beyond the bound: none without a bound, or with one further away than the width.
    fn power(&self, v: f64, room: f64, width: f64) -> f64 {
        let exponent = self.index + 1.0;
        let beyond = if self.bounded { (1.0 - room / width).max(0.0).powf(exponent) } else { 0.0 };
        (v + (1.0 - v) * beyond).powf(1.0 / exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    const ONE: Range = Range { lower: 0.0, upper: 1.0, width: 1.0 };
    const FREE: Range = Range { lower: f64::NEG_INFINITY, upper: f64::INFINITY, width: 1.0 };

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-13, "{found}, expected {expected}");
    }

    /// By hand with eta = 1, so that the root is a square root: u = 0.08 gives beta = 0.4, u = 0.875 gives beta = 2.
    #[test]
    fn unbounded_crossover_by_hand() {
        let crossover = Crossover { index: 1.0, bounded: false };
        let (a, b) = crossover.unbounded(1.0, 3.0, 0.08);
        close(a, 1.6);
        close(b, 2.4);
        let (a, b) = crossover.unbounded(1.0, 3.0, 0.875);
        close(a, 0.0);
        close(b, 4.0);
    }

    /// At u = 1 a child stands on its bound, at u = 0 both meet in the middle; without bounds both forms agree.
    #[test]
    fn bounded_crossover_ends_at_the_bounds() {
        let crossover = Crossover { index: 20.0, bounded: true };
        let (low, high) = crossover.within(0.2, 0.5, &ONE, 1.0);
        close(low, 0.0);
        close(high, 1.0);
        let (low, high) = crossover.within(0.2, 0.5, &ONE, 0.0);
        close(low, 0.35);
        close(high, 0.35);
        for u in [0.1, 0.5, 0.9] {
            let (low, high) = crossover.within(0.2, 0.5, &FREE, u);
            let (a, b) = crossover.unbounded(0.2, 0.5, u);
            close(low, a);
            close(high, b);
        }
    }

    /// By hand with eta = 1: at u = 0.32 a simple step is sqrt(0.64) - 1, at u = 0.82 it is 1 - sqrt(0.36); from x = 0.5
    /// in [0, 1] a quarter of either tail lies beyond the bound.
    #[test]
    fn mutation_by_hand() {
        let mutation = |bounded| Mutation { probability: 1.0, index: 1.0, bounded };
        close(mutation(false).power(0.64, 0.5, 1.0) - 1.0, -0.2);
        close(1.0 - mutation(false).power(0.36, 0.5, 1.0), 0.4);
        close(mutation(true).power(0.64, 0.5, 1.0), (0.64_f64 + 0.36 * 0.25).sqrt());
        close(mutation(true).power(0.0, 0.5, 1.0), 0.5);
        close(mutation(true).power(0.64, f64::INFINITY, 1.0), 0.8);
    }

    /// The published property: the mean of the children is the mean of the parents, and nothing leaves the box.
    #[test]
    fn children_keep_the_mean_and_stay_inside() {
        for (bounded, range) in [(false, FREE), (true, FREE), (true, ONE), (false, ONE)] {
            let crossover = Crossover { index: 2.0, bounded };
            let mutation = Mutation { probability: 0.5, index: 2.0, bounded };
            for index in 0..2000 {
                let mut stream = Stream::new(3, Purpose::Workload, 0, index);
                let (mut a, mut b) = ([stream.uniform()], [stream.uniform()]);
                let sum = a[0] + b[0];
                crossover.apply(&mut a, &mut b, &[range], &mut stream);
                assert!(range.upper.is_finite() || (a[0] + b[0] - sum).abs() < 1e-12, "{a:?} + {b:?}, {sum}");
                mutation.apply(&mut a, &[range], &mut stream);
                assert!([a[0], b[0]].iter().all(|x| (range.lower..=range.upper).contains(x)), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_coordinate_without_room_stays() {
        let space = Space { lower: vec![2.0], upper: vec![2.0], init: vec![[2.0, 2.0]], seeds: Vec::new() };
        let ranges = Range::of(&space);
        let mut stream = Stream::new(3, Purpose::Workload, 0, 0);
        let mut x = [2.0];
        Mutation { probability: 1.0, index: 20.0, bounded: true }.apply(&mut x, &ranges, &mut stream);
        close(x[0], 2.0);
        let free =
            Space { lower: vec![f64::NEG_INFINITY], upper: vec![f64::INFINITY], init: vec![[2.0; 2]], seeds: vec![] };
        close(Range::of(&free)[0].width, 1.0);
    }
}
