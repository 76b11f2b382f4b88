//! The measurement update of a gaussian, traced: Särkkä, *Bayesian Filtering and Smoothing* (2013), theorem 4.2, taken
//! one decorrelated scalar at a time (Bierman 1977, ch. V), so that nothing is ever inverted.
#![expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, P, S, K")]

use crate::filter::covariance::Covariance;
use crate::filter::covariance::Symmetric;
use crate::filter::covariance::{Gain, Scalar};
use crate::tape::{Graph, Id};

/// The measurement of one row, as nodes: z = H x + v.
///
/// With a nominal (the deviation form) x is the deviation from it, and z is corrected for it: exact algebra.
pub(super) struct Measurement {
    pub(super) H: Vec<Vec<Id>>,
    pub(super) R: Symmetric,
    /// Joint innovation z - H x, m; meaningless where missing.
    pub(super) nu: Vec<Id>,
    /// What z is without the part of it that does not depend on x.
    pub(super) z: Vec<Id>,
    /// 1 where a component updates, 0 where it is missing.
    pub(super) present: Vec<Id>,
    /// Whether x may be so far off before an update that taking the correction off it leaves its rounding.
    pub(super) anchored: bool,
}

/// What an update yields besides the posterior.
pub(super) struct Update {
    /// Diagonal of the joint S = H P H' + R, m.
    pub(super) S_diagonal: Vec<Id>,
    /// Variances of the decorrelated innovations: their product is det S over the present components.
    pub(super) pivots: Vec<Id>,
    /// Their normalised squares: their sum is the NIS over the present components.
    pub(super) nis: Vec<Id>,
    /// 1 over these variances, 0 where missing.
    pub(super) inverses: Vec<Id>,
    /// What the update adds to x: K nu, n.
    pub(super) correction: Vec<Id>,
    /// The gain of each decorrelated component.
    pub(super) gains: Vec<Gain>,
    /// What each of them counts, where they are weighed one by one.
    pub(super) weights: Vec<Id>,
}

/// What a decorrelated component counts, by its number and its NIS; without one every component counts in full.
pub(super) type Weigh<'a> = Option<&'a mut dyn FnMut(&mut Graph, usize, Id) -> Id>;

/// What an update did, and the mean and covariance after it.
pub(super) type Updated = (Update, Vec<Id>, Covariance);

impl Update {
    fn new(S_diagonal: Vec<Id>) -> Self {
        let [pivots, nis, inverses, correction, weights] = [const { vec![] }; 5];
        Self { S_diagonal, pivots, nis, inverses, correction, gains: vec![], weights }
    }
}

impl Measurement {
    /// The measurement update. R = L D L' decorrelates the components (L unit, so the likelihood needs no Jacobian);
    /// with a missing component its row of H, its innovation and its row of R are 0 and its variance is 1.
    pub(super) fn update_by(&self, g: &mut Graph, x: &[Id], P: &Covariance, mut weigh: Weigh<'_>) -> Updated {
        let (n, m) = (x.len(), self.H.len());
        let zero = g.constant(0.0);
        let correlated = self.correlated(g);
        let S_diagonal = (0..m).map(|i| P.variance(g, &self.H[i], self.R.at(i, i))).collect();
        let mut update = Update::new(S_diagonal);
        // Anchored, each component is held against x as it is by then; else against what moved since the joint innovation.
        let from = if self.anchored { &self.z } else { &self.nu };
        let components = if correlated { self.decorrelate(g, from) } else { self.diagonal(from) };
        let (mut dx, mut P, mut at) = (vec![zero; n], P.clone(), x.to_vec());
        for (i, component) in components.iter().enumerate() {
            let Component { H, z, D, gate } = component;
            let seen = if self.anchored { &at } else { &dx };
            let moved = g.dot(H.iter().copied().zip(seen.iter().copied()));
            let innovation = g.sub(*z, moved);
            let prior = P.clone();
            let gain = P.update(g, &Scalar { H, D: *D, gate: *gate });
            let weight = weigh.as_mut().map(|weigh| {
                let nis = gain.nis(g, innovation);
                weigh(g, i, nis)
            });
            let counted = weight.map_or(innovation, |weight| g.mul(weight, innovation));
            for (dx, K) in dx.iter_mut().zip(&gain.K) {
                let moved = g.mul(*K, counted);
                *dx = g.add(*dx, moved);
            }
            if self.anchored {
                component.anchor(g, &gain, innovation, weight, &mut at);
            }
            let nis = gain.nis(g, innovation);
            update.nis.push(nis);
            if let Some(weight) = weight {
                P = prior.partly(g, &P, weight, std::slice::from_ref(&gain));
                update.weights.push(weight);
            }
            update.pivots.push(gain.S);
            update.inverses.push(gain.inverse);
            update.gains.push(gain);
        }
        let x = if self.anchored { at } else { x.iter().zip(&dx).map(|(x, dx)| g.add(*x, *dx)).collect() };
        update.correction = dx;
        (update, x, P)
    }

    fn correlated(&self, g: &Graph) -> bool {
        Symmetric::places(self.R.n()).any(|(i, j)| i != j && !g.is(self.R.at(i, j), 0.0))
    }

    /// The presence of the components that see state `i` by itself, each by itself.
    pub(super) fn alone(&self, g: &Graph, i: usize) -> Vec<Id> {
        let sees = |row: &&Vec<Id>| (0..row.len()).all(|j| (j == i) != g.is(row[j], 0.0));
        let rows = self.H.iter().zip(&self.present).filter(|(row, _)| sees(row));
        if self.correlated(g) { vec![] } else { rows.map(|(_, present)| *present).collect() }
    }

    /// Uncorrelated components as they are: D = R, gated by their presence. `z` is what their H x is held against.
    fn diagonal(&self, z: &[Id]) -> Vec<Component> {
        let component =
            |i: usize| Component { H: self.H[i].clone(), z: z[i], D: self.R.at(i, i), gate: self.present[i] };
        (0..z.len()).map(component).collect()
    }

    /// L^-1 H, L^-1 z and D of R = L D L', missing components masked out.
    fn decorrelate(&self, g: &mut Graph, z: &[Id]) -> Vec<Component> {
        let (m, one) = (z.len(), g.constant(1.0));
        let masked = Symmetric::from_fn(m, |i, j| {
            let both = g.mul(self.present[i], self.present[j]);
            let entry = g.mul(both, self.R.at(i, j));
            if i != j {
                return entry;
            }
            let absent = g.sub(one, self.present[i]);
            g.add(entry, absent)
        });
        let (L, D) = masked.ldl_semidefinite(g);
        let mut components: Vec<Component> = Vec::with_capacity(m);
        for i in 0..m {
            let mut H: Vec<Id> = self.H[i].iter().map(|h| g.mul(self.present[i], *h)).collect();
            let mut z = g.mul(self.present[i], z[i]);
            for (L, earlier) in L[i].iter().zip(&components) {
                for (h, earlier) in H.iter_mut().zip(&earlier.H) {
                    let part = g.mul(*L, *earlier);
                    *h = g.sub(*h, part);
                }
                let part = g.mul(*L, earlier.z);
                z = g.sub(z, part);
            }
            components.push(Component { H, z, D: D[i], gate: one });
        }
        components
    }
}

/// One decorrelated component: z = H x + v with var v = D.
struct Component {
    H: Vec<Id>,
    z: Id,
    D: Id,
    /// 1 where it updates, 0 where it is missing.
    gate: Id,
}

impl Component {
    /// x <- x + K nu, and once more by what rounding left: of the exact x, z - H x is D / S nu. Of that the share `weight`.
    fn anchor(&self, g: &mut Graph, gain: &Gain, innovation: Id, weight: Option<Id>, x: &mut [Id]) {
        let before = x.to_vec();
        let moved_by = |g: &mut Graph, x: &mut [Id], by: Id| {
            for (x, K) in x.iter_mut().zip(&gain.K) {
                let moved = g.mul(*K, by);
                *x = g.add(*x, moved);
            }
        };
        moved_by(g, x, innovation);
        let seen = g.dot(self.H.iter().copied().zip(x.iter().copied()));
        let left = g.sub(self.z, seen);
        let share = g.mul(self.D, gain.inverse);
        let kept = g.mul(share, innovation);
        let left = g.sub(left, kept);
        moved_by(g, x, left);
        if let Some(weight) = weight {
            between(g, weight, &before, x);
        }
    }
}

/// x <- (1 - weight) before + weight x: where the weight is 1 or 0, one of the two to the last bit.
pub(super) fn between(g: &mut Graph, weight: Id, before: &[Id], x: &mut [Id]) {
    let one = g.constant(1.0);
    let left = g.sub(one, weight);
    for (x, before) in x.iter_mut().zip(before) {
        *x = g.dot([(left, *before), (weight, *x)]);
    }
}
