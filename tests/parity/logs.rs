//! Logs drawn from a problem's own baseline: any intervals, inputs, gaps and number of trajectories.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::model::{Expr, Problem, Start, Symbol};
use kfgpu::random::{Purpose, Stream};
use kfgpu::reference::{Matrices, Scope, evaluate};
use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

/// Times of the rows.
#[derive(Clone, Copy)]
pub(crate) enum Interval {
    /// k dt.
    Regular(f64),
    /// k dt after a time so large that f64 rounds it visibly: 100 Hz in Unix time.
    Unix(f64),
    /// Intervals between 0.2 and 1.8 times this.
    Irregular(f64),
}

/// Seconds since 1970, in 2023.
const UNIX: f64 = 1.7e9;

/// What is left out.
#[derive(Clone, Copy)]
pub(crate) enum Gap {
    /// Each component with this probability.
    Components(f64),
    /// Each whole row with this probability.
    Rows(f64),
    /// The first rows of every trajectory.
    Leading(usize),
    /// One component in the whole of one trajectory.
    Component { component: usize, trajectory: usize },
    /// These rows of a component, or whole where it is `None`.
    Away { component: Option<usize>, rows: (usize, usize) },
    /// Each true state with this probability.
    Truth(f64),
}

/// The form of a log.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    pub(crate) lengths: &'static [usize],
    pub(crate) interval: Interval,
    pub(crate) gaps: &'static [Gap],
    /// Where the measured states of trajectories start if x0 is a measurement.
    pub(crate) start: f64,
}

impl Shape {
    pub(crate) const fn regular(lengths: &'static [usize]) -> Self {
        Self { lengths, interval: Interval::Regular(1.0), gaps: &[], start: 0.0 }
    }

    pub(crate) const fn every(self, interval: Interval) -> Self {
        Self { interval, ..self }
    }

    pub(crate) const fn without(self, gaps: &'static [Gap]) -> Self {
        Self { gaps, ..self }
    }

    pub(crate) const fn from(self, start: f64) -> Self {
        Self { start, ..self }
    }
}

/// Draws a log of the baseline.
pub(crate) fn draw(problem: &Problem, shape: Shape, seed: u64) -> Log {
    let mut source = Source {
        problem,
        candidate: problem.parameters.baseline(),
        stream: Stream::new(seed, Purpose::Workload, 1, 0),
        line: 1,
    };
    let trajectories = (0..shape.lengths.len()).map(|t| source.trajectory(shape, t)).collect();
    Log {
        source: "<drawn>".to_owned(),
        measurements: problem.model.measurements.clone(),
        inputs: problem.model.inputs.clone(),
        truth: problem.data.truth.iter().map(|(state, _)| state.clone()).collect(),
        trajectories,
        ..Log::default()
    }
}

struct Source<'a> {
    problem: &'a Problem,
    candidate: Vec<f64>,
    stream: Stream,
    line: u64,
}

impl Source<'_> {
    fn trajectory(&mut self, shape: Shape, index: usize) -> Trajectory {
        let model = &self.problem.model;
        let states: Vec<usize> =
            self.problem.data.truth.iter().filter_map(|(s, _)| model.states.iter().position(|n| n == s)).collect();
        let mut trajectory = Trajectory {
            id: index.to_string(),
            time: vec![],
            z: Table::new(model.measurements.len()),
            u: Table::new(model.inputs.len()),
            truth: Table::new(states.len()),
            line: vec![],
        };
        let mut x = self.start(shape.start);
        let mut time = match shape.interval {
            Interval::Unix(_) => UNIX,
            _ => 0.0,
        };
        for k in 0..shape.lengths[index] {
            let dt = match shape.interval {
                Interval::Regular(dt) | Interval::Unix(dt) => dt,
                Interval::Irregular(dt) => dt * (0.2 + 1.6 * self.stream.uniform()),
            };
            let u: Vec<f64> = model.inputs.iter().map(|_| 2.0 * self.stream.uniform() - 1.0).collect();
            let matrices = Matrices::of(self.problem, &self.candidate, dt);
            let z = self.values(&model.h, &x, &u, dt) + self.noise(&matrices.r);
            trajectory.z.push(&self.with_gaps(&z, shape.gaps, (index, k)));
            trajectory.u.push(&u);
            let truth: Vec<f64> = states.iter().map(|i| x[*i]).collect();
            trajectory.truth.push(&self.truth_with_gaps(truth, shape.gaps));
            self.line += 1;
            trajectory.line.push(self.line);
            trajectory.time.push(time);
            time = match shape.interval {
                Interval::Regular(dt) => (k + 1) as f64 * dt,
                Interval::Unix(dt) => UNIX + (k + 1) as f64 * dt,
                Interval::Irregular(_) => time + dt,
            };
            x = self.values(&model.f, &x, &u, dt) + self.noise(&matrices.q);
        }
        trajectory
    }

    /// x0 with noise of the order of 1, so that a diffuse P0 does not send the truth away.
    fn start(&mut self, start: f64) -> DVector<f64> {
        let model = &self.problem.model;
        let n = model.states.len();
        let x = match &model.x0 {
            Start::Values(values) => self.values(values, &DVector::zeros(n), &[], f64::NAN),
            Start::Measurement => {
                let measured = |i| model.h.iter().any(|h| h.mentions(|symbol| symbol == Symbol::State(i)));
                DVector::from_fn(n, |i, _| if measured(i) { start } else { 0.0 })
            }
        };
        x + self.noise(&DMatrix::identity(n, n))
    }

    fn values(&self, formulas: &[Expr], x: &DVector<f64>, u: &[f64], dt: f64) -> DVector<f64> {
        let parameters = self.problem.parameters.resolve(&self.candidate);
        let scope = Scope { states: x.as_slice(), parameters: &parameters, inputs: u, dt };
        DVector::from_iterator(formulas.len(), formulas.iter().map(|f| evaluate(f, &scope)))
    }

    fn noise(&mut self, covariance: &DMatrix<f64>) -> DVector<f64> {
        let eigen = covariance.clone().symmetric_eigen();
        let root = eigen.eigenvalues.map(|v| v.max(0.0).sqrt());
        let draws = root.map(|s| s * Distribution::<f64>::sample(&StandardNormal, &mut self.stream));
        eigen.eigenvectors * draws
    }

    fn with_gaps(&mut self, z: &DVector<f64>, gaps: &[Gap], (trajectory, k): (usize, usize)) -> Vec<f64> {
        let mut z = z.as_slice().to_vec();
        for gap in gaps {
            let row = self.stream.uniform();
            for (i, z) in z.iter_mut().enumerate() {
                let missing = match *gap {
                    Gap::Components(share) => self.stream.uniform() < share,
                    Gap::Rows(share) => row < share,
                    Gap::Leading(rows) => k < rows,
                    Gap::Component { component, trajectory: t } => i == component && trajectory == t,
                    Gap::Away { component, rows: (from, to) } => {
                        component.is_none_or(|c| c == i) && (from..to).contains(&k)
                    }
                    Gap::Truth(_) => false,
                };
                *z = if missing { f64::NAN } else { *z };
            }
        }
        z
    }

    fn truth_with_gaps(&mut self, mut truth: Vec<f64>, gaps: &[Gap]) -> Vec<f64> {
        for gap in gaps {
            let Gap::Truth(share) = gap else { continue };
            truth.iter_mut().for_each(|x| *x = if self.stream.uniform() < *share { f64::NAN } else { *x });
        }
        truth
    }
}
