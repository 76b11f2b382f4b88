//! Objectives that are no ratio of two sums over rows, but functions of several such ratios.

use crate::objective::{Kind, Objective};
use crate::reference::{Step, smooth_components, standardised};

/// What the rows of such an objective are made of, as they were run through.
#[derive(Debug, Default)]
pub(super) struct Parts(Vec<Part>);

#[derive(Debug)]
struct Part {
    trajectory: usize,
    /// `nis_distribution`: the four polynomials. `whiteness`: the standardised innovations by component, NaN where missing.
    values: Vec<f64>,
}

/// Numerators and denominators of the ratios in one row.
type Terms = Vec<(f64, f64)>;

impl Parts {
    pub(super) fn add(&mut self, objective: &Objective, trajectory: usize, step: &Step) {
        let Some(update) = &step.update else { return };
        let values = match objective.kind {
            Kind::NisDistribution => smooth_components(update).to_vec(),
            Kind::Whiteness => {
                let mut values = Vec::new();
                for (i, value) in standardised(update) {
                    values.resize(values.len().max(i), f64::NAN);
                    values.push(value);
                }
                values
            }
            _ => return,
        };
        self.0.push(Part { trajectory, values });
    }

    /// Trajectory, value and weight of each row: values whose mean is the objective, and each of which differs from it by what the
    /// row moves it by, times the number of rows (the delta method).
    pub(super) fn linearised(&self, objective: &Objective) -> Vec<(usize, f64, f64)> {
        match objective.kind {
            Kind::NisDistribution => self.by_ratios(|k| self.0[k].values.iter().map(|phi| (*phi, 1.0)).collect()),
            Kind::Whiteness => {
                let series = self.series();
                self.by_ratios(|k| series.iter().flat_map(|series| series.terms(k, objective.lags)).collect())
            }
            _ => Vec::new(),
        }
    }

    /// The components that have values.
    fn series(&self) -> Vec<Series> {
        let components = self.0.iter().map(|part| part.values.len()).max().unwrap_or(0);
        let of = |i: usize| {
            let mut series = Series { values: Vec::new(), place: Vec::with_capacity(self.0.len()) };
            for part in &self.0 {
                let value = part.values.get(i).copied().filter(|value| !value.is_nan());
                series.place.push(value.map(|_| series.values.len()));
                series.values.extend(value.map(|value| (part.trajectory, value)));
            }
            series
        };
        (0..components).map(of).filter(|series| !series.values.is_empty()).collect()
    }

    /// Of the sum of (A_j / B_j)^2, A_j and B_j being sums over rows of the terms (a_j, b_j).
    fn by_ratios(&self, terms: impl Fn(usize) -> Terms) -> Vec<(usize, f64, f64)> {
        let mut sums = Terms::new();
        for k in 0..self.0.len() {
            let terms = terms(k);
            sums.resize(terms.len(), (0.0, 0.0));
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum = (sum.0 + term.0, sum.1 + term.1));
        }
        let ratios: Vec<f64> = sums.iter().map(|(a, b)| a / b).collect();
        let value: f64 = ratios.iter().map(|ratio| ratio * ratio).sum();
        let n = self.0.len() as f64;
        let moved = |k: usize| {
            let each = terms(k).into_iter().zip(&sums).zip(&ratios);
            each.map(|(((a, b), (_, whole)), ratio)| 2.0 * ratio * (a - ratio * b) / whole).sum::<f64>()
        };
        self.0.iter().enumerate().map(|(k, part)| (part.trajectory, value + n * moved(k), 1.0)).collect()
    }
}

/// The values of one component.
struct Series {
    /// Trajectory and value, where it is present.
    values: Vec<(usize, f64)>,
    /// For each row the place of its value among those.
    place: Vec<Option<usize>>,
}

impl Series {
    /// For each lag the product with the value so many values ago, and the square.
    fn terms(&self, row: usize, lags: usize) -> impl Iterator<Item = (f64, f64)> {
        let place = self.place[row];
        let (trajectory, value) = place.map_or((0, 0.0), |place| self.values[place]);
        let earlier = move |lag: usize| {
            let (of, earlier) = self.values[place?.checked_sub(lag)?];
            (of == trajectory).then_some(earlier)
        };
        (1..=lags).map(move |lag| (value * earlier(lag).unwrap_or(0.0), value * value))
    }
}
