//! Objectives that are no ratio of two sums over rows, but functions of several such ratios.

use crate::objective::{Kind, Objective};
use crate::reference::{Step, smooth_components};

/// What the rows of such an objective are made of, as they were run through: trajectory, numbers.
#[derive(Debug, Default)]
pub(super) struct Parts(Vec<(usize, Vec<f64>)>);

impl Parts {
    pub(super) fn add(&mut self, objective: &Objective, trajectory: usize, step: &Step) {
        let Some(update) = &step.update else { return };
        if objective.kind == Kind::NisDistribution {
            self.0.push((trajectory, smooth_components(update).to_vec()));
        }
    }

    /// Trajectory, value and weight of each row: values whose mean is the objective, and each of which differs from it by what the
    /// row moves it by, times the number of rows (the delta method).
    pub(super) fn linearised(&self, objective: &Objective) -> Vec<(usize, f64, f64)> {
        match objective.kind {
            // Four means, squared.
            Kind::NisDistribution => {
                self.by_ratios(|k| self.0[k].1.iter().map(|phi| (*phi, 1.0)).collect(), |r| (r * r, 2.0 * r))
            }
            _ => Vec::new(),
        }
    }

    /// Of the sum of f(A_j / B_j), A_j and B_j being sums over rows of the `terms` (a_j, b_j); `f` gives value and slope.
    fn by_ratios(
        &self,
        terms: impl Fn(usize) -> Vec<(f64, f64)>,
        f: impl Fn(f64) -> (f64, f64),
    ) -> Vec<(usize, f64, f64)> {
        let mut sums: Vec<(f64, f64)> = Vec::new();
        for k in 0..self.0.len() {
            let terms = terms(k);
            sums.resize(terms.len(), (0.0, 0.0));
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum = (sum.0 + term.0, sum.1 + term.1));
        }
        let ratios: Vec<f64> = sums.iter().map(|(a, b)| a / b).collect();
        let value: f64 = ratios.iter().map(|ratio| f(*ratio).0).sum();
        let n = self.0.len() as f64;
        let moved = |k: usize| {
            let each = terms(k).into_iter().zip(&sums).zip(&ratios);
            each.map(|(((a, b), (_, whole)), ratio)| f(*ratio).1 * (a - ratio * b) / whole).sum::<f64>()
        };
        self.0.iter().enumerate().map(|(k, (trajectory, _))| (*trajectory, value + n * moved(k), 1.0)).collect()
    }
}
