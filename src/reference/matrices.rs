//! F, H, Q, R of a candidate as dense matrices.

use nalgebra::{DMatrix, DVector};

use super::Cause;
use super::evaluate::Scope;
use super::square_root::root;
use crate::model::{Angles, Duals, Expr, Formula, Model, Problem, Start, is_covariance, must_be_definite};

/// The matrices of a model for one candidate and one interval, inputs at zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrices {
    /// Transition, n x n; of an f that is not affine its Jacobian at x0.
    pub f: DMatrix<f64>,
    /// Measurement, m x n; of an h that is not affine its Jacobian at x0.
    pub h: DMatrix<f64>,
    /// Process noise covariance of one step, n x n.
    pub q: DMatrix<f64>,
    /// Measurement noise covariance, m x m.
    pub r: DMatrix<f64>,
}

impl Matrices {
    /// Evaluates the model of `problem` for a candidate over an interval of `dt` \[s\].
    ///
    /// # Panics
    /// If `candidate` does not have one value per searched parameter.
    #[must_use]
    pub fn of(problem: &Problem, candidate: &[f64], dt: f64) -> Self {
        let mut formulas = Formulas::new(&problem.model, problem.parameters.resolve(candidate));
        let inputs = vec![0.0; problem.model.inputs.len()];
        let (mut f, mut h) = (Affine::zeros(formulas.n, formulas.n), Affine::zeros(formulas.m, formulas.n));
        if problem.filter.is_linear() {
            formulas.transition(dt, &inputs, &mut f);
            formulas.measurement(&inputs, &mut h);
        } else {
            let mut x0 = DVector::zeros(formulas.n);
            formulas.initial_state(&mut x0);
            formulas.transition_at(&x0, dt, &inputs, &mut f);
            formulas.measurement_at(&x0, &inputs, &mut h);
        }
        let (mut q, mut r) = (DMatrix::zeros(formulas.n, formulas.n), DMatrix::zeros(formulas.m, formulas.m));
        formulas.process_noise(dt, &mut q);
        formulas.measurement_noise(&mut r);
        Self { f: f.matrix, h: h.matrix, q, r }
    }
}

/// y = A (x - o) + b about an origin o: 0 where y is affine, the point where it was linearised otherwise.
#[derive(Debug, Clone)]
pub(crate) struct Affine {
    pub(crate) matrix: DMatrix<f64>,
    pub(crate) transpose: DMatrix<f64>,
    pub(crate) offset: DVector<f64>,
}

impl Affine {
    pub(crate) fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(rows, columns),
            transpose: DMatrix::zeros(columns, rows),
            offset: DVector::zeros(rows),
        }
    }
}

/// The formulas of a model with a candidate's parameters filled in.
#[derive(Debug)]
pub(crate) struct Formulas {
    pub(crate) n: usize,
    pub(crate) m: usize,
    pub(crate) f_uses_inputs: bool,
    pub(crate) h_uses_inputs: bool,
    pub(crate) angles: Angles,
    parameters: Vec<f64>,
    f: Vec<Formula>,
    h: Vec<Formula>,
    q: Vec<Formula>,
    r: Vec<Formula>,
    p0: Vec<Formula>,
    x0: Option<Vec<Formula>>,
    /// Whether R and P0 may not be singular.
    definite: [bool; 2],
    stack: Vec<f64>,
    duals: Duals,
    states: Vec<f64>,
}

impl Formulas {
    pub(crate) fn new(model: &Model, parameters: Vec<f64>) -> Self {
        let compile = |list: &[Expr]| list.iter().map(Formula::of).collect::<Vec<_>>();
        let (f, h) = (compile(&model.f), compile(&model.h));
        Self {
            n: model.states.len(),
            m: model.measurements.len(),
            f_uses_inputs: f.iter().any(Formula::mentions_input),
            h_uses_inputs: h.iter().any(Formula::mentions_input),
            angles: model.angles.clone(),
            parameters,
            f,
            h,
            q: compile(&model.q),
            r: compile(&model.r),
            p0: compile(&model.p0),
            x0: match &model.x0 {
                Start::Values(list) => Some(compile(list)),
                Start::Measurement => None,
            },
            definite: [must_be_definite(&model.r), must_be_definite(&model.p0)],
            stack: Vec::new(),
            duals: Duals::default(),
            states: vec![0.0; model.states.len()],
        }
    }

    /// f as F x + f(0).
    pub(crate) fn transition(&mut self, dt: f64, inputs: &[f64], out: &mut Affine) {
        let scope = Scope { states: &[], parameters: &self.parameters, inputs, dt };
        linearise(&self.f, scope, &mut self.states, &mut self.stack, out);
    }

    /// h as H x + h(0).
    pub(crate) fn measurement(&mut self, inputs: &[f64], out: &mut Affine) {
        let scope = Scope { states: &[], parameters: &self.parameters, inputs, dt: f64::NAN };
        linearise(&self.h, scope, &mut self.states, &mut self.stack, out);
    }

    /// f(x).
    pub(crate) fn moved(&mut self, x: &[f64], dt: f64, inputs: &[f64]) -> DVector<f64> {
        let scope = Scope { states: x, parameters: &self.parameters, inputs, dt };
        DVector::from_iterator(self.n, self.f.iter().map(|f| scope.value(f, &mut self.stack)))
    }

    /// h(x).
    pub(crate) fn measured(&mut self, x: &[f64], inputs: &[f64]) -> DVector<f64> {
        let scope = Scope { states: x, parameters: &self.parameters, inputs, dt: f64::NAN };
        DVector::from_iterator(self.m, self.h.iter().map(|h| scope.value(h, &mut self.stack)))
    }

    /// f about x.
    pub(super) fn transition_at(&mut self, x: &DVector<f64>, dt: f64, inputs: &[f64], out: &mut Affine) {
        let scope = Scope { states: x.as_slice(), parameters: &self.parameters, inputs, dt };
        differentiate(&self.f, &scope, &mut self.duals, out);
    }

    /// h about x.
    pub(super) fn measurement_at(&mut self, x: &DVector<f64>, inputs: &[f64], out: &mut Affine) {
        let scope = Scope { states: x.as_slice(), parameters: &self.parameters, inputs, dt: f64::NAN };
        differentiate(&self.h, &scope, &mut self.duals, out);
    }

    pub(crate) fn process_noise(&mut self, dt: f64, out: &mut DMatrix<f64>) {
        let scope = Scope { parameters: &self.parameters, dt, ..Scope::default() };
        fill(&self.q, &scope, &mut self.stack, out);
    }

    pub(crate) fn measurement_noise(&mut self, out: &mut DMatrix<f64>) {
        let scope = Scope { parameters: &self.parameters, ..Scope::default() };
        fill(&self.r, &scope, &mut self.stack, out);
    }

    pub(crate) fn initial_covariance(&mut self, out: &mut DMatrix<f64>) {
        let scope = Scope { parameters: &self.parameters, ..Scope::default() };
        fill(&self.p0, &scope, &mut self.stack, out);
    }

    /// B with B' B = Q, where that is a covariance.
    pub(super) fn process_root(&self, q: &DMatrix<f64>) -> Result<DMatrix<f64>, Cause> {
        covariance_root(q, false, "Q")
    }

    /// The same of R.
    pub(super) fn measurement_root(&self, r: &DMatrix<f64>) -> Result<DMatrix<f64>, Cause> {
        covariance_root(r, self.definite[0], "R")
    }

    /// The same of P0.
    pub(super) fn initial_root(&self, p0: &DMatrix<f64>) -> Result<DMatrix<f64>, Cause> {
        covariance_root(p0, self.definite[1], "P0")
    }

    pub(crate) const fn starts_from_measurement(&self) -> bool {
        self.x0.is_none()
    }

    /// x0 where it is given by formulas; `out` is untouched when it comes from a measurement.
    pub(crate) fn initial_state(&mut self, out: &mut DVector<f64>) {
        let Some(x0) = &self.x0 else { return };
        let scope = Scope { parameters: &self.parameters, ..Scope::default() };
        for (entry, formula) in out.iter_mut().zip(x0) {
            *entry = scope.value(formula, &mut self.stack);
        }
    }
}

fn covariance_root(a: &DMatrix<f64>, definite: bool, matrix: &'static str) -> Result<DMatrix<f64>, Cause> {
    let judged = is_covariance(a, !definite).then(|| root(a)).flatten();
    judged.ok_or(Cause::NotCovariance { matrix })
}

/// Row-major formulas into a matrix.
fn fill(formulas: &[Formula], scope: &Scope, stack: &mut Vec<f64>, out: &mut DMatrix<f64>) {
    let columns = out.ncols();
    for (i, formula) in formulas.iter().enumerate() {
        out[(i / columns, i % columns)] = scope.value(formula, stack);
    }
}

/// Columns of an affine map by unit vectors: A e_j = (g(s e_j) - g(0)) / s. The step s is 1, or the power of two
/// above |g(0)|, so that a large offset (sea level, an epoch) takes no digits from A.
fn linearise(formulas: &[Formula], scope: Scope, states: &mut [f64], stack: &mut Vec<f64>, out: &mut Affine) {
    states.fill(0.0);
    for (i, formula) in formulas.iter().enumerate() {
        let offset = Scope { states, ..scope }.value(formula, stack);
        out.offset[i] = offset;
        let step = if offset.abs() > 1.0 { offset.abs().log2().ceil().exp2() } else { 1.0 };
        for j in 0..states.len() {
            states[j] = step;
            let value = Scope { states, ..scope }.value(formula, stack);
            states[j] = 0.0;
            out.matrix[(i, j)] = (value - offset) / step;
        }
    }
    out.matrix.transpose_to(&mut out.transpose);
}

/// Values and Jacobian at the states of `scope`, by dual numbers.
fn differentiate(formulas: &[Formula], scope: &Scope, duals: &mut Duals, out: &mut Affine) {
    for (i, formula) in formulas.iter().enumerate() {
        let (value, slopes) = scope.gradient(formula, duals);
        out.offset[i] = value;
        out.matrix.row_mut(i).iter_mut().zip(slopes).for_each(|(entry, slope)| *entry = slope);
    }
    out.matrix.transpose_to(&mut out.transpose);
}
