//! The best J of a data set found without any of the optimisers under test: local searches in other coordinates, scored
//! by the oracle alone.

use super::oracle::{Noise, Spectrum};
use crate::evaluate::{Evaluation, Status};
use crate::optimize::nelder_mead::{NelderMead, Options};
use crate::optimize::{OptimizeError, Optimizer as _, Space};
use crate::random::{Purpose, Stream};

/// Evaluations of one local search.
const EVALUATIONS: usize = 800;

/// The range of starts: ln of both eigenvalues of R, and the direction of the first \[rad\].
const STARTS: [[f64; 2]; 3] = [[-3.0, 14.0], [-3.0, 14.0], [0.0, std::f64::consts::PI]];

/// The least J of `searches` Nelder-Mead searches over (ln eigenvalue, ln eigenvalue, direction), which are all that R
/// has. They have no bounds: an eigenvalue may run away, and does.
pub(super) fn search(noise: &Noise, searches: u64, seed: u64) -> Result<f64, OptimizeError> {
    let mut best = f64::INFINITY;
    for index in 0..searches {
        let mut stream = Stream::new(seed, Purpose::Population, 0, index);
        let start = STARTS.map(|[low, high]| low + stream.uniform() * (high - low));
        best = best.min(local(noise, &start)?);
    }
    Ok(best)
}

fn local(noise: &Noise, start: &[f64]) -> Result<f64, OptimizeError> {
    let space = Space {
        lower: vec![f64::NEG_INFINITY; 3],
        upper: vec![f64::INFINITY; 3],
        init: STARTS.to_vec(),
        seeds: Vec::new(),
    };
    let options = Options { evaluations: EVALUATIONS, tolerance: 1e-9, speculative: false };
    let mut simplex = NelderMead::new(&space, start, &[1.0, 1.0, 0.5], options)?;
    let mut best = f64::INFINITY;
    while let Some(positions) = simplex.ask() {
        let score = |x: &[f64]| noise.score(&Spectrum { eigenvalues: [x[0].exp(), x[1].exp()], direction: x[2] });
        let costs: Vec<f64> = positions.rows().map(score).collect();
        best = costs.iter().copied().fold(best, f64::min);
        let status = vec![Status::OK; costs.len()];
        simplex.tell(&positions, &Evaluation::new(1, costs, status));
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::super::scenario;
    use super::*;

    /// Against a grid over the same three numbers, which knows no local search.
    #[test]
    fn local_searches_beat_a_dense_grid() {
        let noise = Noise::of(&scenario::log(9, 0).trajectories[0]);
        let found = search(&noise, 20, 1).unwrap();
        let mut grid = f64::INFINITY;
        for i in 0..40 {
            for j in 0..=i {
                for k in 0..24 {
                    let eigenvalues = [i, j].map(|e| (f64::from(e) * 0.5 - 3.0).exp());
                    let direction = f64::from(k) * std::f64::consts::PI / 24.0;
                    grid = grid.min(noise.score(&Spectrum { eigenvalues, direction }));
                }
            }
        }
        assert!(found <= grid && found > 0.97 * grid, "searches {found}, grid {grid}");
    }
}
