//! A closed-form evaluator: tests optimisers and the study without any filter.

mod landscape;
mod multi_objective;

pub use landscape::Landscape;
pub use multi_objective::MultiObjective;

use rayon::prelude::*;

use super::{Backend, Device, Evaluation, Evaluator, Population, Precision, Status};
use landscape::HALF_WIDTH;

/// What a [`Mock`] computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// One objective with a known minimum.
    One(Landscape),
    /// Several objectives with a known Pareto front.
    Several(MultiObjective),
}

impl Function {
    const fn objectives(self) -> usize {
        match self {
            Self::One(_) => 1,
            Self::Several(function) => function.objectives(),
        }
    }

    fn name(self) -> String {
        match self {
            Self::One(landscape) => format!("{landscape:?}"),
            Self::Several(function) => format!("{function:?}"),
        }
    }

    fn values(self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::One(landscape) => vec![landscape.value(x)],
            Self::Several(function) => function.values(x),
        }
    }
}

impl From<Landscape> for Function {
    fn from(landscape: Landscape) -> Self {
        Self::One(landscape)
    }
}

impl From<MultiObjective> for Function {
    fn from(function: MultiObjective) -> Self {
        Self::Several(function)
    }
}

type Predicate = dyn Fn(&[f64]) -> bool + Send + Sync;
type Measure = dyn Fn(&[f64]) -> f64 + Send + Sync;

/// Scores candidates by a closed form, counts calls and candidates, and fails those it is told to fail.
pub struct Mock {
    function: Function,
    fails: Box<Predicate>,
    violation: Option<Box<Measure>>,
    chunk: usize,
    /// Number of calls of [`Evaluator::evaluate`].
    pub calls: u64,
    /// Number of candidates scored.
    pub candidates: u64,
}

impl Mock {
    /// An evaluator that fails nothing.
    #[must_use]
    pub fn new(function: impl Into<Function>) -> Self {
        Self {
            function: function.into(),
            fails: Box::new(|_| false),
            violation: None,
            chunk: usize::MAX,
            calls: 0,
            candidates: 0,
        }
    }

    /// Gives [`Status::NOT_POSITIVE`] to every candidate that `fails` holds for.
    #[must_use]
    pub fn failing(mut self, fails: impl Fn(&[f64]) -> bool + Send + Sync + 'static) -> Self {
        self.fails = Box::new(fails);
        self
    }

    /// Says how far each candidate is from satisfying some constraint: 0 or less = it does.
    #[must_use]
    pub fn violating(mut self, violation: impl Fn(&[f64]) -> f64 + Send + Sync + 'static) -> Self {
        self.violation = Some(Box::new(violation));
        self
    }

    /// Scores `chunk` candidates at a time, chunks on rayon's threads.
    #[must_use]
    pub fn chunked(mut self, chunk: usize) -> Self {
        self.chunk = chunk.max(1);
        self
    }

    /// A box of `n` coordinates around the origin that holds the optimum of any [`Landscape`].
    #[must_use]
    pub fn bounds(n: usize) -> Vec<[f64; 2]> {
        vec![[-HALF_WIDTH, HALF_WIDTH]; n]
    }
}

impl Evaluator for Mock {
    fn objectives(&self) -> usize {
        self.function.objectives()
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        self.calls += 1;
        self.candidates += population.len() as u64;
        let rows: Vec<&[f64]> = population.rows().collect();
        let score = |x: &&[f64]| {
            let status = if (self.fails)(x) { Status::NOT_POSITIVE } else { Status::OK };
            (self.function.values(x), status)
        };
        let chunks = rows.par_chunks(self.chunk.min(rows.len().max(1)));
        let (costs, status): (Vec<_>, _) = chunks.flat_map_iter(|chunk| chunk.iter().map(score)).unzip();
        let evaluation = Evaluation::new(self.function.objectives(), costs.concat(), status);
        match &self.violation {
            None => evaluation,
            Some(violation) => evaluation.with_violation(rows.iter().map(|x| violation(x).max(0.0)).collect()),
        }
    }

    fn device(&self) -> Device {
        Device { backend: Backend::Mock, adapter: self.function.name().into(), precision: Precision::F64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permuted_and_chunked_candidates_keep_their_costs() {
        let rows: Vec<f64> = (0..60).map(|i| f64::from(i) * 0.31 - 4.0).collect();
        let population = Population::from_rows(3, rows);
        let reversed = {
            let mut reversed = Population::new(3);
            (0..20).rev().for_each(|i| reversed.push(population.row(i)));
            reversed
        };
        let plain = Mock::new(Landscape::Rastrigin).evaluate(&population);
        let backwards = Mock::new(Landscape::Rastrigin).chunked(7).evaluate(&reversed);
        for i in 0..20 {
            assert_eq!(plain.costs(i), backwards.costs(19 - i), "candidate {i}");
        }
    }

    #[test]
    fn failures_and_counts() {
        let mut mock = Mock::new(Landscape::Sphere).failing(|x| x[0] > 0.0);
        let costs = mock.evaluate(&Population::from_rows(1, vec![-1.0, 1.0]));
        assert_eq!((costs.status(0), costs.status(1)), (Status::OK, Status::NOT_POSITIVE));
        assert_eq!(costs.costs(1), [Evaluation::FAILED]);
        assert_eq!((mock.calls, mock.candidates), (1, 2));
    }

    #[test]
    fn several_objectives_and_a_constraint() {
        let mut mock = Mock::new(MultiObjective::Zdt2).violating(|x| x[0] - 0.5);
        let costs = mock.evaluate(&Population::from_rows(2, vec![0.25, 0.0, 0.75, 0.0]));
        assert_eq!((costs.costs(0), costs.costs(1)), (&[0.25, 0.9375][..], &[0.75, 0.4375][..]));
        assert!(costs.violation(0) <= 0.0 && (costs.violation(1) - 0.25).abs() < 1e-15);
        assert_eq!((mock.objectives(), mock.device().adapter.name.as_str()), (2, "Zdt2"));
    }
}
