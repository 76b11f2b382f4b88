//! The tuned filter as matrices: numbers where they are the same in every row, formulas where they are not.

mod formula;
mod print;
#[cfg(test)]
mod tests;

use nalgebra::DMatrix;
use serde::{Serialize, Serializer};

use crate::data::Log;
use crate::model::{Adapts, Expr, Problem, Symbol};
use crate::number::{exact, short};
use crate::reference::{self, Steady};
use formula::Writer;

/// Significant digits of an entry: more than any tuned variance has.
const DIGITS: usize = 8;

/// A matrix as nested lists. Where all entries are numbers it is what JSON and NumPy read; a formula is a string.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Matrix {
    rows: Vec<Vec<Entry>>,
}

/// One entry.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// The same in every row.
    Value(f64),
    /// A formula of inputs and dt, with the tuned parameters as numbers.
    Formula {
        /// With numbers that read back as the same bits.
        exact: String,
        /// As a person reads it.
        short: String,
    },
}

impl Serialize for Entry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Value(value) => serializer.serialize_f64(*value),
            Self::Formula { exact, .. } => serializer.serialize_str(exact),
        }
    }
}

impl Entry {
    fn of(expr: &Expr, problem: &Problem) -> Self {
        let model = &problem.model;
        match formula::number(expr) {
            Some(value) => Self::Value(value),
            None => Self::Formula {
                exact: Writer { model, number: &exact }.text(expr),
                short: Writer { model, number: &|value| short(value, DIGITS) }.text(expr),
            },
        }
    }

    fn is_zero(&self) -> bool {
        matches!(self, Self::Value(value) if value.abs() <= 0.0)
    }
}

impl From<&DMatrix<f64>> for Matrix {
    fn from(matrix: &DMatrix<f64>) -> Self {
        Self { rows: matrix.row_iter().map(|row| row.iter().map(|value| Entry::Value(*value)).collect()).collect() }
    }
}

impl Matrix {
    fn of(entries: &[Expr], columns: usize, problem: &Problem) -> Self {
        let row = |row: &[Expr]| row.iter().map(|entry| Entry::of(entry, problem)).collect();
        Self { rows: entries.chunks(columns.max(1)).map(row).collect() }
    }

    /// Whether any entry changes from row to row of the log.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.rows.iter().flatten().any(|entry| matches!(entry, Entry::Formula { .. }))
    }
}

/// The model's matrices for one candidate: x' = F x + f0 + w, z = H x + h0 + v. Where f or h is not affine it stands there as
/// formulas of the states: x' = f + w, z = h + v.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, K")]
pub struct Matrices {
    /// The log's interval \[s\], which F, Q and K are for; `None` where it differs from row to row, and `dt` stands in
    /// formulas.
    pub dt: Option<f64>,
    /// Transition, n x n; `None` where f is not affine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub F: Option<Matrix>,
    /// What the transition adds that no state is part of, n x 1; `None` where it is 0.
    pub f0: Option<Matrix>,
    /// The transition itself where it is not affine, n x 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub f: Option<Matrix>,
    /// Measurement, m x n; `None` where h is not affine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub H: Option<Matrix>,
    /// What a measurement holds that no state is part of, m x 1; `None` where it is 0.
    pub h0: Option<Matrix>,
    /// The measurement itself where it is not affine, m x 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub h: Option<Matrix>,
    /// Process noise covariance of one step, n x n; where it is adapted, of the first.
    pub Q: Matrix,
    /// Measurement noise covariance, m x m; where it is adapted, of the first row.
    pub R: Matrix,
    /// Names of those of F, f0, f, H, h0, h, Q and R that change from row to row: they have formulas for entries.
    pub varies: Vec<&'static str>,
    /// The gain that the filter settles to, n x m; `None` where there is none.
    pub K: Option<Matrix>,
    /// Whether there is one.
    pub gain: Gain,
    /// What an adaptive filter does with Q or R; `None` for one that keeps both.
    pub note: Option<&'static str>,
    /// Whether they are those of one of several models.
    #[serde(skip)]
    of_modes: bool,
    #[serde(skip)]
    states: Vec<String>,
    #[serde(skip)]
    measurements: Vec<String>,
}

/// Whether the filter has one gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Gain {
    /// It settles to one, with every measurement present.
    Steady,
    /// F, H, Q or R change from row to row, or what a filter makes of several models, and with them the gain.
    Varies,
    /// F, H, Q and R stay, and the gain does not settle: a state that nothing drives, or an unstable one that is not seen.
    Unsettled,
}

impl Matrices {
    /// The matrices of `candidate` for `log`.
    ///
    /// # Panics
    /// If `candidate` does not have one value per searched parameter.
    #[must_use]
    pub fn of(problem: &Problem, log: &Log, candidate: &[f64]) -> Self {
        let (model, dt) = (&problem.model, log.regular_dt());
        let parameters = problem.parameters.resolve(candidate);
        let filled = |list: &[Expr]| list.iter().map(|e| formula::filled(e, &parameters, dt)).collect::<Vec<Expr>>();
        let [f, h, q, r] = [&model.f, &model.h, &model.q, &model.r].map(|list| filled(list));
        let (n, m) = (model.states.len(), model.measurements.len());
        let affine = |list: &[Expr]| list.iter().all(Expr::is_affine);
        let linear = |list: &[Expr]| {
            let entries = list.iter().flat_map(|e| (0..n).map(move |state| formula::coefficient(e, state)));
            affine(list).then(|| Matrix::of(&entries.collect::<Vec<_>>(), n, problem))
        };
        let whole = |list: &[Expr]| (!affine(list)).then(|| Matrix::of(list, 1, problem));
        let constant = |list: &[Expr]| {
            let matrix = Matrix::of(&list.iter().map(formula::offset).collect::<Vec<_>>(), 1, problem);
            (affine(list) && !matrix.rows.iter().flatten().all(Entry::is_zero)).then_some(matrix)
        };
        let mut found = Self {
            dt,
            F: linear(&f),
            f0: constant(&f),
            f: whole(&f),
            H: linear(&h),
            h0: constant(&h),
            h: whole(&h),
            Q: Matrix::of(&q, n, problem),
            R: Matrix::of(&r, m, problem),
            varies: Vec::new(),
            K: None,
            gain: Gain::Varies,
            note: adapted(problem),
            of_modes: !problem.modes.is_empty(),
            states: model.states.clone(),
            measurements: model.measurements.clone(),
        };
        found.varies = found.all().filter(|(_, matrix)| matrix.varies()).map(|(name, _)| name).collect();
        found.settle(problem, candidate);
        found
    }

    /// Gives the gain where matrices that stay as they are lead to one.
    fn settle(&mut self, problem: &Problem, candidate: &[f64]) {
        let offset = |name: &str| name == "f0" || name == "h0";
        let varies = self.all().any(|(name, matrix)| !offset(name) && matrix.varies());
        let affine = self.f.is_none() && self.h.is_none();
        let stays = problem.robust.is_none() && problem.filter.facts().adapts == Adapts::Nothing;
        // Of several models no one gain is the filter's.
        let stays = stays && problem.modes.is_empty();
        if varies || !affine || !stays {
            return;
        }
        // Without an interval nothing depends on it, or an entry would vary.
        let steady = reference::steady_gain(problem, candidate, self.dt.unwrap_or(1.0));
        self.gain = if steady.is_some() { Gain::Steady } else { Gain::Unsettled };
        self.K = steady.map(|Steady { k, .. }| (&k).into());
    }

    /// Every matrix but the gain, with its name.
    fn all(&self) -> impl Iterator<Item = (&'static str, &Matrix)> {
        let Self { F, f0, f, H, h0, h, Q, R, .. } = self;
        let model = [("F", F), ("f0", f0), ("f", f), ("H", H), ("h0", h0), ("h", h)];
        let noise = [("Q", Some(Q)), ("R", Some(R))];
        let model = model.into_iter().map(|(name, matrix)| (name, matrix.as_ref()));
        model.chain(noise).filter_map(|(name, matrix)| Some((name, matrix?)))
    }
}

/// Whether a formula for the next value of one state takes another one times dt, so that their units differ.
pub(super) fn differ_in_unit(problem: &Problem, states: &[usize]) -> bool {
    let by_dt = |i: usize, j: usize| {
        let formula = problem.model.f.get(i).map(|f| formula::coefficient(f, j));
        i != j && formula.is_some_and(|f| f.mentions(|symbol| symbol == Symbol::Dt))
    };
    states.iter().any(|i| states.iter().any(|j| by_dt(*i, *j)))
}

/// Which of the matrices printed is a start only.
fn adapted(problem: &Problem) -> Option<&'static str> {
    if !problem.modes.is_empty() {
        return Some("these are those of [model], or of the first mode where it has none; each mode has its own");
    }
    match problem.filter.facts().adapts {
        Adapts::Nothing => None,
        Adapts::ProcessNoise => Some("Q is where each trajectory starts; the filter adapts it"),
        Adapts::MeasurementNoise => Some("R is where each trajectory starts; the filter adapts it"),
    }
}
