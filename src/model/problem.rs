//! A problem: data, model, parameters, filter, and how to tune.

use super::evaluate::wrap;
use super::{Expr, FilterKind, Parameters, Robust, Setting, Span};
use crate::data::DataSpec;
use crate::objective::{Constraint, Objective};

/// A whole problem file, checked: names resolved, dimensions consistent, formulas linear where the filter needs it.
#[derive(Debug, Clone)]
pub struct Problem {
    /// File name, for messages and reports.
    pub source: String,
    /// The text of the file, for messages and for writing `tuned.toml`.
    pub text: String,
    /// Where the log is and what its columns mean.
    pub data: DataSpec,
    /// The model.
    pub model: Model,
    /// Its parameters.
    pub parameters: Parameters,
    /// Which filter runs.
    pub filter: FilterKind,
    /// What it switches between; empty for filters of one model.
    pub modes: Vec<Mode>,
    /// How its updates withstand outliers, where they do.
    pub robust: Option<Robust>,
    /// What is minimised and how.
    pub tune: TuneSpec,
    /// How to draw a log from the model, where the file says.
    pub simulate: Option<SimulateSpec>,
}

impl Problem {
    /// Settings that are formulas: those of the filter, then those of its robust updates.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting<'_>> {
        self.filter.settings().into_iter().chain(self.robust.iter().flat_map(Robust::settings)).collect()
    }
}

/// A state-space model: x' = f(x, u, dt) + w, z = h(x, u) + v, w ~ N(0, Q), v ~ N(0, R).
///
/// Formulas may use parameters everywhere, states in f and h only, inputs in f and h, dt in f and Q.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Built-in kind, for reports; `None` for formulas.
    pub kind: Option<&'static str>,
    /// State names, n.
    pub states: Vec<String>,
    /// Measurement names, m.
    pub measurements: Vec<String>,
    /// Input names.
    pub inputs: Vec<String>,
    /// Which of them are angles in radians, equal modulo 2 pi.
    pub angles: Angles,
    /// Transition, n formulas.
    pub f: Vec<Expr>,
    /// Measurement, m formulas.
    pub h: Vec<Expr>,
    /// Process noise covariance of one step, n x n row-major, symmetric; structural zeros are the number 0.
    pub q: Vec<Expr>,
    /// Measurement noise covariance, m x m row-major, symmetric.
    pub r: Vec<Expr>,
    /// Initial state.
    pub x0: Start,
    /// Initial covariance, n x n row-major, symmetric.
    pub p0: Vec<Expr>,
    /// When `x0` and `p0` hold.
    pub first: First,
}

/// One of the models between which an interacting multiple model filter switches.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Its name in reports and columns.
    pub name: String,
    /// Its model, over the states of the problem's: those that it lacks are held where they are.
    pub model: Model,
    /// The filter that runs on it.
    pub filter: FilterKind,
    /// A formula of inputs and parameters: in rows where it is not above 0 the mode is ruled out. `None` for one that never is.
    pub allowed: Option<Expr>,
}

/// Which states and measurements are angles in radians: their innovations and errors are wrapped to [-pi, pi).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Angles {
    /// Indices of states, ascending.
    pub states: Vec<usize>,
    /// Indices of measurements, ascending.
    pub measurements: Vec<usize>,
}

impl Angles {
    /// Whether state `i` is one.
    #[must_use]
    pub fn state(&self, i: usize) -> bool {
        self.states.contains(&i)
    }

    /// Whether measurement `i` is one.
    #[must_use]
    pub fn measurement(&self, i: usize) -> bool {
        self.measurements.contains(&i)
    }

    /// A difference of two values of state `i`, in [-pi, pi) where it is an angle.
    #[must_use]
    pub fn between_states(&self, i: usize, difference: f64) -> f64 {
        if self.state(i) { wrap(difference) } else { difference }
    }

    /// A difference of two values of measurement `i`, in [-pi, pi) where it is an angle.
    #[must_use]
    pub fn between_measurements(&self, i: usize, difference: f64) -> f64 {
        if self.measurement(i) { wrap(difference) } else { difference }
    }
}

/// Initial state.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// n formulas of parameters.
    Values(Vec<Expr>),
    /// From the first complete measurement of each trajectory: x = pinv(H) (z - h(0)).
    Measurement,
}

/// When x0 and P0 hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum First {
    /// At the first row of each trajectory, which then updates.
    Update,
    /// One step of `dt` before it; `None` = the log's regular interval.
    Predict {
        /// `first_dt` in seconds.
        dt: Option<f64>,
    },
}

/// The `[tune]` table, with defaults filled in.
#[derive(Debug, Clone, PartialEq)]
pub struct TuneSpec {
    /// Name in the optimiser registry.
    pub algorithm: String,
    /// What is minimised, at least one.
    pub objectives: Vec<Objective>,
    /// What every candidate should keep; feasible candidates win over others.
    pub constraints: Vec<Constraint>,
    /// Which member of a front is recommended, with several objectives.
    pub pick: Pick,
    /// Candidates a generation.
    pub population: usize,
    /// Generations after the initial one.
    pub generations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Stop after this many evaluations.
    pub evaluations: Option<u64>,
    /// Stop after this long in seconds.
    pub wall_time: Option<f64>,
    /// Stop after this many generations without a relative gain of 1e-9.
    pub stall: Option<usize>,
    /// Stop when the (first) objective reaches this.
    pub target: Option<f64>,
    /// Whether the user's starts join generation 0.
    pub include_start: bool,
    /// Whether the winner, or ends and knee of a front, are polished in f64.
    pub polish: bool,
}

impl TuneSpec {
    /// Everything that is scored: the objectives, then what the constraints bound.
    #[must_use]
    pub fn scorers(&self) -> Vec<Objective> {
        self.objectives.iter().chain(self.constraints.iter().map(|c| &c.measure)).cloned().collect()
    }
}

/// Which member of a front is recommended.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Pick {
    /// The knee.
    #[default]
    Knee,
    /// The best in this objective.
    Best(usize),
    /// The smallest weighted sum of objectives scaled to the front's range; one weight per objective.
    Weights(Vec<f64>),
}

/// The `[simulate]` table.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulateSpec {
    /// Rows after row 0.
    pub steps: usize,
    /// Interval in seconds.
    pub dt: f64,
    /// Values of the searched parameters that differ from the baseline: (name, value).
    pub parameters: Vec<(String, f64)>,
    /// True initial state, n; `None` = drawn from N(x0, P0).
    pub x0: Option<Vec<f64>>,
    /// Q of the truth, n x n formulas; `None` = the model's.
    pub q: Option<Vec<Expr>>,
    /// Share of measurement components left out, 0 to 1.
    pub missing: f64,
    /// Whether row 0 has no measurement.
    pub skip_first: bool,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Seed.
    pub seed: u64,
}

impl Problem {
    /// The models that a filter works on: those of the modes, or the one.
    pub fn models(&self) -> impl Iterator<Item = &Model> {
        let one = self.modes.is_empty().then_some(&self.model);
        one.into_iter().chain(self.modes.iter().map(|mode| &mode.model))
    }

    /// The same problem with the model and the filter of one mode alone.
    #[must_use]
    pub fn of_mode(&self, mode: &Mode) -> Self {
        Self { model: mode.model.clone(), filter: mode.filter.clone(), robust: None, modes: vec![], ..self.clone() }
    }
}

impl Model {
    /// Whether f and h are affine in the states, by their form.
    #[must_use]
    pub fn is_affine(&self) -> bool {
        self.f.iter().chain(&self.h).all(Expr::is_affine)
    }

    /// The same model, wherever its formulas stand in the file: what two files have to agree in to mean the same.
    #[must_use]
    pub fn without_spans(&self) -> Self {
        let mut model = self.clone();
        let start = match &mut model.x0 {
            Start::Values(formulas) => formulas.as_mut_slice(),
            Start::Measurement => &mut [],
        };
        let lists = [&mut model.f, &mut model.h, &mut model.q, &mut model.r, &mut model.p0];
        for formula in lists.into_iter().flatten().chain(start) {
            formula.map_spans(&|_| Span::default());
        }
        model
    }
}
