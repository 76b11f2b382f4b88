//! Draws logs from a model: truth, measurements and gaps, from one seed.

use std::ops::Range;

use crate::data::{Log, Table, Times, Trajectory};
use crate::model::{First, Problem, SimulateSpec};
use crate::random::{Purpose, Stream};
use crate::reference::{Affine, Formulas};
use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};

/// Why no log can be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum SimulateError {
    #[error("{source_name}: there is no [simulate] table to draw a log from (add one with steps and dt)")]
    NoTable { source_name: String },
    #[error("[simulate] cannot make up {count} inputs (draw from a model without inputs)")]
    Inputs { count: usize },
    #[error("[simulate] parameters: \"{name}\" is not a searched parameter (expected one of: {expected})")]
    UnknownParameter { name: String, expected: String },
    #[error("[simulate] has no x0, and the model takes its own from a measurement (give x0 in [simulate])")]
    NoInitialState,
    #[error("[simulate] {what}: {found} entries, expected {expected}")]
    WrongSize { what: &'static str, found: usize, expected: usize },
    #[error("[simulate] missing = {found}, expected a share from 0 to 1")]
    Missing { found: f64 },
    #[error("{what} is not a covariance with the true parameters (an eigenvalue is negative or not a number)")]
    NotCovariance { what: &'static str },
    #[error("a trajectory of {rows} rows does not fit in memory (use fewer steps)")]
    TooLong { rows: usize },
    #[error(
        "the simulated truth or its measurement is no finite number at row {row} (use fewer steps, a stable model, or an x0 where f and h are defined)"
    )]
    NotFinite { row: usize },
}

/// Draws the log that `[simulate]` describes; `seed` replaces the table's own.
///
/// Row 0 has time 0. The true x0 is the one of `[simulate]`, or drawn from N(x0, P0); it holds where the model's x0
/// holds: at row 0, or with `first = "predict"` one step before it. Truth of all states is in the log.
///
/// Every draw has a stream of its own, keyed by (seed, purpose, trajectory, row): n normals for the initial state
/// (row 0), n for the process noise of the step that leads to the row, m for its measurement noise, m uniforms for its
/// gaps. So a longer log begins with the shorter one, and another share of gaps leaves the numbers as they are. Noise
/// is L w with L the lower Cholesky factor of the covariance, so component i uses draws 0 to i. Measured angles are in
/// [-pi, pi); those of the truth go on.
///
/// # Errors
/// Without `[simulate]`, with inputs, with an unknown parameter, when a covariance is none, or on overflow.
pub fn simulate(problem: &Problem, seed: Option<u64>) -> Result<Log, SimulateError> {
    let trajectories = problem.simulate.as_ref().map_or(0, |spec| spec.trajectories);
    realisations(problem, seed, 0..trajectories)
}

/// The realisations of this range, which need not end where `[simulate]` does: those after it are fresh ones.
pub(crate) fn realisations(problem: &Problem, seed: Option<u64>, range: Range<usize>) -> Result<Log, SimulateError> {
    let spec =
        problem.simulate.as_ref().ok_or_else(|| SimulateError::NoTable { source_name: problem.source.clone() })?;
    let mut system = System::new(problem, spec)?;
    let seed = seed.unwrap_or(spec.seed);
    let mut log = Log {
        source: "<simulated>".into(),
        measurements: problem.model.measurements.clone(),
        inputs: Vec::new(),
        truth: problem.model.states.clone(),
        trajectories: Vec::with_capacity(range.len()),
        times: Times::counting(problem.data.time_unit.unwrap_or_default()),
        ranges: None,
    };
    // Line 1 is the header of the CSV that the log may be written to.
    let mut line = 2 + (range.start * (spec.steps + 1)) as u64;
    let named = range.end > 1 || problem.data.trajectory.is_some();
    for index in range.start as u64..range.end as u64 {
        let id = if named { (index + 1).to_string() } else { String::new() };
        log.trajectories.push(system.trajectory(id, Draws { seed, trajectory: index }, &mut line)?);
    }
    Ok(log)
}

/// The true system, with its constants worked out.
struct System<'a> {
    spec: &'a SimulateSpec,
    formulas: Formulas,
    step: Step,
    /// h; `None` where it may not be affine.
    h: Option<Affine>,
    x0: DVector<f64>,
    /// Lower factors of R, and of P0 where x0 is drawn.
    r: DMatrix<f64>,
    p0: Option<DMatrix<f64>>,
    /// The step before row 0, for `first = "predict"`.
    before: Option<Step>,
}

/// One step of the true system.
struct Step {
    dt: f64,
    /// `None` where f may not be affine.
    f: Option<Affine>,
    /// Lower factor of Q.
    q: DMatrix<f64>,
}

/// Streams of one trajectory.
#[derive(Clone, Copy)]
struct Draws {
    seed: u64,
    trajectory: u64,
}

impl<'a> System<'a> {
    fn new(problem: &Problem, spec: &'a SimulateSpec) -> Result<Self, SimulateError> {
        let mut model = problem.model.clone();
        if !model.inputs.is_empty() {
            return Err(SimulateError::Inputs { count: model.inputs.len() });
        }
        if !(0.0..=1.0).contains(&spec.missing) {
            return Err(SimulateError::Missing { found: spec.missing });
        }
        if let Some(q) = &spec.q {
            check_size("q", q.len(), model.q.len())?;
            model.q.clone_from(q);
        }
        let mut formulas = Formulas::new(&model, true_parameters(problem, spec)?);
        let (n, m) = (formulas.n, formulas.m);
        let affine = problem.filter.is_linear();
        let h = affine.then(|| {
            let mut h = Affine::zeros(m, n);
            formulas.measurement(&[], &mut h);
            h
        });
        let mut r = DMatrix::zeros(m, m);
        formulas.measurement_noise(&mut r);
        let step = Step::new(&mut formulas, spec.dt, affine)?;
        let (x0, p0) = initial(&mut formulas, spec)?;
        let before = match model.first {
            First::Update => None,
            First::Predict { dt } => Some(Step::new(&mut formulas, dt.unwrap_or(spec.dt), affine)?),
        };
        Ok(Self { spec, formulas, step, h, x0, r: factor("R", &r)?, p0, before })
    }

    fn trajectory(&mut self, id: String, draws: Draws, line: &mut u64) -> Result<Trajectory, SimulateError> {
        let (n, m) = (self.formulas.n, self.formulas.m);
        let mut trajectory = Trajectory {
            id,
            time: Vec::new(),
            z: Table::new(m),
            u: Table::new(0),
            truth: Table::new(n),
            line: Vec::new(),
        };
        let rows = self.spec.steps + 1;
        trajectory.reserve(rows).map_err(|_| SimulateError::TooLong { rows })?;
        let mut x = self.x0.clone();
        if let Some(p0) = &self.p0 {
            x += p0 * draws.normals(Purpose::InitialState, 0, n);
        }
        for row in 0..=self.spec.steps {
            let into = if row == 0 { self.before.as_ref() } else { Some(&self.step) };
            if let Some(step) = into {
                x = step.moved(&mut self.formulas, x) + &step.q * draws.normals(Purpose::ProcessNoise, row, n);
            }
            let z = self.measured(&x, draws.normals(Purpose::MeasurementNoise, row, m));
            if !x.iter().chain(z.iter()).all(|v| v.is_finite()) {
                return Err(SimulateError::NotFinite { row });
            }
            trajectory.z.push(&self.with_gaps(z, draws, row));
            trajectory.u.push(&[]);
            trajectory.truth.push(x.as_slice());
            trajectory.time.push(time(row, self.spec.dt));
            trajectory.line.push(*line);
            *line += 1;
        }
        Ok(trajectory)
    }

    /// h(x) and its noise, angles in [-pi, pi).
    fn measured(&mut self, x: &DVector<f64>, normals: DVector<f64>) -> DVector<f64> {
        let exact = match &self.h {
            Some(h) => &h.matrix * x + &h.offset,
            None => self.formulas.measured(x.as_slice(), &[]),
        };
        let z = exact + &self.r * normals;
        z.map_with_location(|i, _, z| self.formulas.angles.between_measurements(i, z))
    }

    fn with_gaps(&self, z: DVector<f64>, draws: Draws, row: usize) -> Vec<f64> {
        let mut stream = draws.stream(Purpose::Missing, row);
        let whole_row = self.spec.skip_first && row == 0;
        z.iter().map(|z| if stream.uniform() < self.spec.missing || whole_row { f64::NAN } else { *z }).collect()
    }
}

impl Draws {
    fn stream(self, purpose: Purpose, row: usize) -> Stream {
        Stream::new(self.seed, purpose, self.trajectory, row as u64)
    }

    fn normals(self, purpose: Purpose, row: usize, length: usize) -> DVector<f64> {
        let mut stream = self.stream(purpose, row);
        DVector::from_fn(length, |_, _| StandardNormal.sample(&mut stream))
    }
}

#[expect(clippy::cast_precision_loss, reason = "no log has 2^53 rows")]
fn time(row: usize, dt: f64) -> f64 {
    row as f64 * dt
}

/// The values of all parameters: the baseline, with those of `[simulate]` over it.
fn true_parameters(problem: &Problem, spec: &SimulateSpec) -> Result<Vec<f64>, SimulateError> {
    let names = problem.parameters.names();
    let mut candidate = problem.parameters.baseline();
    for (name, value) in &spec.parameters {
        let i = names
            .iter()
            .position(|n| n == name)
            .ok_or_else(|| SimulateError::UnknownParameter { name: name.clone(), expected: names.join(", ") })?;
        candidate[i] = *value;
    }
    Ok(problem.parameters.resolve(&candidate))
}

/// The true x0, and the factor of P0 where it is to be drawn.
fn initial(
    formulas: &mut Formulas,
    spec: &SimulateSpec,
) -> Result<(DVector<f64>, Option<DMatrix<f64>>), SimulateError> {
    let n = formulas.n;
    if let Some(x0) = &spec.x0 {
        check_size("x0", x0.len(), n)?;
        return Ok((DVector::from_column_slice(x0), None));
    }
    if formulas.starts_from_measurement() {
        return Err(SimulateError::NoInitialState);
    }
    let (mut x0, mut p0) = (DVector::zeros(n), DMatrix::zeros(n, n));
    formulas.initial_state(&mut x0);
    formulas.initial_covariance(&mut p0);
    Ok((x0, Some(factor("P0", &p0)?)))
}

impl Step {
    fn new(formulas: &mut Formulas, dt: f64, affine: bool) -> Result<Self, SimulateError> {
        let n = formulas.n;
        let f = affine.then(|| {
            let mut f = Affine::zeros(n, n);
            formulas.transition(dt, &[], &mut f);
            f
        });
        let mut q = DMatrix::zeros(n, n);
        formulas.process_noise(dt, &mut q);
        Ok(Self { dt, f, q: factor("Q", &q)? })
    }

    /// f(x).
    fn moved(&self, formulas: &mut Formulas, x: DVector<f64>) -> DVector<f64> {
        match &self.f {
            Some(f) => &f.matrix * x + &f.offset,
            None => formulas.moved(x.as_slice(), self.dt, &[]),
        }
    }
}

fn check_size(what: &'static str, found: usize, expected: usize) -> Result<(), SimulateError> {
    if found == expected { Ok(()) } else { Err(SimulateError::WrongSize { what, found, expected }) }
}

/// Lower L with L L' = `covariance`, which may be semidefinite: where a pivot vanishes so does its column.
fn factor(what: &'static str, covariance: &DMatrix<f64>) -> Result<DMatrix<f64>, SimulateError> {
    let n = covariance.nrows();
    let mut l = DMatrix::<f64>::zeros(n, n);
    for j in 0..n {
        let rest = |i: usize, l: &DMatrix<f64>| covariance[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
        let pivot = rest(j, &l);
        // What rounding leaves of a pivot that is zero.
        let rounding = 1e-12 * covariance[(j, j)].abs();
        let positive = pivot > rounding;
        for i in j..n {
            let entry = rest(i, &l);
            let negligible = 1e-6 * (covariance[(i, i)] * covariance[(j, j)]).abs().sqrt();
            if positive {
                l[(i, j)] = entry / pivot.sqrt();
            } else if !(entry.abs() <= negligible && pivot >= -rounding) {
                return Err(SimulateError::NotCovariance { what });
            }
        }
    }
    Ok(l)
}
