//! Points far off, before a search says that it has converged.
//!
//! On a logarithmic scale a variance that does not matter lies on a shelf: a + b exp(x), where slope and curvature both
//! vanish towards small x whatever b is, and a small gradient says nothing of the gain. So each coordinate is looked along,
//! others held; what is better there is where the search goes on. A bound that is as good as any place before it is taken
//! exactly.

use super::{GOAL, Lbfgsb, MOVES, Phase, Standing, usable};

/// Offsets in units of a coordinate.
const OFFSETS: [f64; 8] = [-4.0, -2.0, -1.0, -0.3, 0.3, 1.0, 2.0, 4.0];

impl Lbfgsb {
    /// Looks along every coordinate, the bounds included.
    pub(super) fn probe(&mut self) {
        let (mut coordinates, mut points) = (Vec::new(), Vec::new());
        for d in 0..self.at.x.len() {
            let at = self.at.x[d];
            let [lower, upper] = [self.space.lower[d], self.space.upper[d]];
            let ends = [lower, upper].into_iter().filter(|end| end.is_finite());
            let inside = OFFSETS.iter().map(|offset| at + offset * self.options.units[d]);
            for x in ends.chain(inside.filter(|x| lower < *x && *x < upper)).filter(|x| (x - at).abs() > 0.0) {
                let mut point = self.at.x.clone();
                point[d] = x;
                coordinates.push(d);
                points.push(point);
            }
        }
        self.wait_for(Phase::Probe(coordinates), points);
    }

    pub(super) fn judge_probe(&mut self, coordinates: &[usize], costs: &[f64]) {
        let n = self.at.x.len();
        let mut best: Vec<Option<usize>> = vec![None; n];
        for (i, d) in coordinates.iter().enumerate() {
            let x = self.batch.row(i)[*d];
            let at_bound = x <= self.space.lower[*d] || x >= self.space.upper[*d];
            let gain = self.at.cost - costs[i];
            let worth = if at_bound { 0.0 } else { GOAL * self.options.nat };
            if usable(costs[i]) && gain > worth.max(4.0 * self.noise()) && best[*d].is_none_or(|b| costs[i] < costs[b])
            {
                best[*d] = Some(i);
            }
        }
        let mut better: Vec<usize> = best.into_iter().flatten().collect();
        better.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let moved: Vec<Vec<f64>> = (1..=better.len())
            .map(|count| {
                let mut point = self.at.x.clone();
                better[..count].iter().for_each(|&i| point[coordinates[i]] = self.batch.row(i)[coordinates[i]]);
                point
            })
            .collect();
        match moved.len() {
            0 => self.end(Standing::Converged),
            // Each move gains, so that this many say that there is no end to it.
            _ if self.moves >= MOVES => self.end(Standing::Unfinished),
            1 => self.move_to(&moved[0]),
            _ => self.wait_for(Phase::Combine, moved),
        }
    }

    pub(super) fn judge_combined(&mut self, costs: &[f64]) {
        let best = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
        let point = self.batch.row(best).to_vec();
        self.move_to(&point);
    }

    fn move_to(&mut self, point: &[f64]) {
        self.moves += 1;
        self.begin(point);
    }
}
