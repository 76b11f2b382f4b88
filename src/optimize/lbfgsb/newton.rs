//! The whole Hessian, before a search says that it has converged.
//!
//! A quasi-Newton model has seen the few directions that it moved along; in a valley that it has not seen it predicts a
//! hundredth of the gain that is there. Two more costs for each pair of coordinates give what it lacks.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::{Lbfgsb, Phase, Point, usable};

/// Coordinates from which on the model is trusted: 4,032 costs.
const LARGEST: usize = 64;

impl Lbfgsb {
    /// Asks for the mixed second differences, if the source says how far its own points lie.
    pub(super) fn verify(&mut self) {
        let offsets = &self.at.offsets;
        let free: Vec<usize> = (0..offsets.len()).filter(|d| self.is_free(*d) && offsets[*d][0] != 0.0).collect();
        if free.len() > LARGEST || free.is_empty() {
            return self.probe();
        }
        let pairs: Vec<(usize, usize)> = free.iter().flat_map(|i| free.iter().map(move |j| (*i, *j))).collect();
        let corner = |&(i, j): &(usize, usize)| {
            // Above the diagonal the one corner, below it the other.
            let side = usize::from(i > j);
            let mut point = self.at.x.clone();
            point[i] += offsets[i][side];
            point[j] += offsets[j][side];
            point
        };
        let points: Vec<Vec<f64>> = pairs.iter().filter(|(i, j)| i != j).map(corner).collect();
        if points.is_empty() {
            let hessian = DMatrix::from_element(1, 1, self.at.slope.curvature[free[0]]);
            return self.newton(&free, hessian);
        }
        self.wait_for(Phase::Corners(free), points);
    }

    /// Whether the bounds let a coordinate move downhill.
    fn is_free(&self, d: usize) -> bool {
        let (x, g) = (self.at.x[d], self.at.slope.gradient[d]);
        !(x <= self.space.lower[d] && g >= 0.0 || x >= self.space.upper[d] && g <= 0.0)
    }

    pub(super) fn judge_corners(&mut self, free: &[usize], costs: &[f64]) {
        let Point { cost, slope, offsets, .. } = &self.at;
        let n = free.len();
        // The parabola through a coordinate's three points goes through them.
        let alone = |d: usize, h: f64| slope.gradient[d] * h + 0.5 * slope.curvature[d] * h * h;
        let mut hessian = DMatrix::from_diagonal(&DVector::from_iterator(n, free.iter().map(|d| slope.curvature[*d])));
        let mut told = costs.iter();
        for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))).filter(|(a, b)| a != b) {
            let (i, j, side) = (free[a], free[b], usize::from(a > b));
            let (h, k) = (offsets[i][side], offsets[j][side]);
            let corner = told.next().filter(|corner| usable(**corner)).map(|c| c - cost - alone(i, h) - alone(j, k));
            let mixed = corner.map_or(0.0, |corner| 0.5 * corner / (h * k));
            hessian[(a, b)] += mixed;
            hessian[(b, a)] += mixed;
        }
        self.newton(free, hessian);
    }

    /// The step of Newton's method in the free coordinates and the gain that it predicts. In units of the coordinates an
    /// eigenvalue below one nat counts as one, as where directions are called flat.
    fn newton(&mut self, free: &[usize], hessian: DMatrix<f64>) {
        let (nat, units) = (self.options.nat, &self.options.units);
        let unit = |a: usize| units[free[a]];
        let scaled = DMatrix::from_fn(free.len(), free.len(), |a, b| hessian[(a, b)] * unit(a) * unit(b) / nat);
        let slope = DVector::from_fn(free.len(), |a, _| self.at.slope.gradient[free[a]] * unit(a) / nat);
        if !scaled.iter().chain(&slope).all(|x| x.is_finite()) {
            return self.probe();
        }
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
        let slopes = eigenvectors.tr_mul(&slope);
        let steps = DVector::from_fn(free.len(), |k, _| -slopes[k] / eigenvalues[k].abs().max(1.0));
        let gain = (-0.5 * nat * steps.dot(&slopes)).max(0.0);
        self.predicted = gain;
        // Where it is good enough one step more is nearly free, and ends at the last digits.
        let near = gain <= self.goal();
        if near && (self.refined || gain <= 4.0 * self.noise()) {
            return self.probe();
        }
        self.refined |= near;
        let moved = eigenvectors * steps;
        self.step.fill(0.0);
        for (a, d) in free.iter().enumerate() {
            self.step[*d] = moved[a] * units[*d];
        }
        self.limit_step();
        self.take_step();
    }
}
