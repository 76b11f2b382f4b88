//! Objectives that are no ratio of two sums over rows, but functions of several such ratios.

use crate::data::Trajectory;
use crate::model::Problem;
use crate::objective::{Kind, Objective};
use crate::reference::{Predictor, Step, smooth_components, standardised};

/// What the rows of such an objective are made of, as they were run through.
#[derive(Debug, Default)]
pub(super) struct Parts {
    rows: Vec<Part>,
    predictor: Option<Predictor>,
}

#[derive(Debug)]
struct Part {
    trajectory: usize,
    /// `nis_distribution`: the four polynomials. `whiteness`: the standardised innovations by component, NaN where missing.
    /// `prediction`: for each distance the squared error, then the number of components.
    values: Vec<f64>,
}

/// Numerators and denominators of the ratios in one row.
type Terms = Vec<(f64, f64)>;

impl Parts {
    pub(super) fn new(problem: &Problem, candidate: &[f64], objective: &Objective) -> Self {
        let ahead = objective.horizons();
        let predictor = (objective.kind == Kind::Prediction).then(|| Predictor::new(problem, candidate, ahead));
        Self { rows: Vec::new(), predictor }
    }

    /// Every row passes; those that score are kept.
    pub(super) fn add(
        &mut self,
        objective: &Objective,
        (index, trajectory): (usize, &Trajectory),
        step: &Step,
        scores: bool,
    ) {
        let place = (trajectory, step.row);
        let errors = self.predictor.as_mut().map(|p| p.row(index, place, &step.prior.x, step.update.as_ref()));
        let Some(update) = step.update.as_ref().filter(|_| scores) else { return };
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
            _ => match errors {
                Some(errors) => errors.into_iter().flat_map(|(square, count)| [square, count as f64]).collect(),
                None => return,
            },
        };
        self.rows.push(Part { trajectory: index, values });
    }

    /// Trajectory, value and weight of each row: values whose mean is the objective, and each of which differs from it by what the
    /// row moves it by, times the number of rows (the delta method).
    pub(super) fn linearised(&self, objective: &Objective) -> Vec<(usize, f64, f64)> {
        let square = |ratio: f64| (ratio * ratio, 2.0 * ratio);
        match objective.kind {
            Kind::NisDistribution => {
                self.by_ratios(|k| self.rows[k].values.iter().map(|phi| (*phi, 1.0)).collect(), square)
            }
            Kind::Whiteness => {
                let series = self.series();
                self.by_ratios(|k| series.iter().flat_map(|series| series.terms(k, objective.lags)).collect(), square)
            }
            _ => {
                let share = 1.0 / objective.horizons().len() as f64;
                let terms = |k: usize| self.rows[k].values.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
                self.by_ratios(terms, |ratio| (share * ratio, share))
            }
        }
    }

    /// The components that have values.
    fn series(&self) -> Vec<Series> {
        let components = self.rows.iter().map(|part| part.values.len()).max().unwrap_or(0);
        let of = |i: usize| {
            let mut series = Series { values: Vec::new(), place: Vec::with_capacity(self.rows.len()) };
            for part in &self.rows {
                let value = part.values.get(i).copied().filter(|value| !value.is_nan());
                series.place.push(value.map(|_| series.values.len()));
                series.values.extend(value.map(|value| (part.trajectory, value)));
            }
            series
        };
        (0..components).map(of).filter(|series| !series.values.is_empty()).collect()
    }

    /// Of the sum of f(A_j / B_j), A_j and B_j being sums over rows of the terms (a_j, b_j); `f` gives value and slope.
    fn by_ratios(&self, terms: impl Fn(usize) -> Terms, f: impl Fn(f64) -> (f64, f64)) -> Vec<(usize, f64, f64)> {
        let mut sums = Terms::new();
        for k in 0..self.rows.len() {
            let terms = terms(k);
            sums.resize(terms.len(), (0.0, 0.0));
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum = (sum.0 + term.0, sum.1 + term.1));
        }
        let ratios: Vec<f64> = sums.iter().map(|(a, b)| a / b).collect();
        let value: f64 = ratios.iter().map(|ratio| f(*ratio).0).sum();
        let n = self.rows.len() as f64;
        let moved = |k: usize| {
            let each = terms(k).into_iter().zip(&sums).zip(&ratios);
            each.map(|(((a, b), (_, whole)), ratio)| f(*ratio).1 * (a - ratio * b) / whole).sum::<f64>()
        };
        self.rows.iter().enumerate().map(|(k, part)| (part.trajectory, value + n * moved(k), 1.0)).collect()
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
