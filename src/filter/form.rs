//! In which form the covariance is carried, and why.

use super::columns::{Columns, Rows};
use super::error::TraceError;
use super::formula::{self, Scope};
use super::probe::{Probe, Sight, range};
use super::tracer::Tracer;
use super::units::Units;
use crate::model::{FilterKind, Parameters, Problem};
use crate::tape::{Calculator, Graph, Id, Leaf};
use std::fmt::{self, Display, Formatter};

/// The form of the covariance that a filter carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Form {
    /// P itself, its upper triangle: the fewest operations.
    Full,
    /// The factors of P = U D U' (Bierman 1977): what a diffuse P0 needs in single precision.
    Factored,
}

impl Display for Form {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full => "covariance P",
            Self::Factored => "factors P = U D U'",
        })
    }
}

impl Form {
    /// P0 over R above which single precision carries factors: f32 keeps 7 digits, and an update that takes P from P0 down
    /// to R loses as many as P0/R has, where nll per step is promised to 1e-5. The same holds for what an update takes P
    /// down by in the middle of a log.
    pub const DIFFUSE: f64 = 1e3;
    /// The same of double precision: 16 digits, of which costs are promised to 10.
    pub const DIFFUSE_F64: f64 = 1e6;
}

/// How a filter is carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Carrying {
    pub(super) form: Form,
    /// See [`super::kalman::Recursion::anchored`].
    pub(super) anchored: bool,
}

impl Carrying {
    /// By the problem and its log alone, unless the form is given.
    ///
    /// Single precision carries P for a P0 up to [`Form::DIFFUSE`] times R, and factors beyond. It carries factors too where
    /// Q is adapted (a step after a large correction is as diffuse as a start), and where an update after a gap takes P down
    /// by more. Double precision carries factors where a [`Probe`] finds that an update takes P down by more than
    /// [`Form::DIFFUSE_F64`]. After such a gap x is anchored to what is measured, and with it comes the track of the baseline
    /// after its updates, for a nominal.
    pub(super) fn choose(
        problem: &Problem,
        rows: &Rows<'_>,
        single: bool,
        form: Option<Form>,
    ) -> Result<(Self, Option<Vec<f64>>), TraceError> {
        let mut columns = Columns::default();
        let (g, units) = (Graph::default(), Units::own(problem.model.states.len(), problem.model.measurements.len()));
        let mut tracer =
            Tracer { g, columns: &mut columns, rows, problem, nominal: None, units: &units, anchored: false };
        let diffuseness = diffuseness(&mut tracer)?;
        let limit = if single { Form::DIFFUSE } else { Form::DIFFUSE_F64 };
        let sight = Sight::new(&mut tracer)?;
        let probe = Probe::run(problem, rows, &sight, !single && diffuseness > limit)?;
        let lost = |loss: fn(&Probe) -> f64| probe.as_ref().is_some_and(|probe| loss(probe) > limit);
        let (start, anchored) = (lost(|probe| probe.start), lost(|probe| probe.after));
        let adapts_q = matches!(problem.filter, FilterKind::SageHusa { .. });
        let diffuse = if single { adapts_q || diffuseness > limit } else { start };
        let chosen = if diffuse || anchored { Form::Factored } else { Form::Full };
        let track = probe.filter(|_| anchored).map(|probe| probe.track);
        Ok((Self { form: form.unwrap_or(chosen), anchored }, track))
    }
}

/// The largest P0_ii, times the largest H_ji^2 (which brings it to the unit of the measurements), over the smallest R_jj
/// (or what an adaptive filter may make of it).
///
/// Each over the whole log and over three candidates: every searched parameter at its lower bound, at its start, and at
/// its upper bound (the range of the first population where there is no bound). That covers formulas that rise or fall in
/// all of their parameters.
fn diffuseness(tracer: &mut Tracer<'_>) -> Result<f64, TraceError> {
    let (mut p0, mut h, mut r) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for candidate in corners(&tracer.problem.parameters) {
        let (jacobian, _) = tracer.measurement_map(&candidate)?;
        let (initial, noise) = variances(tracer, &candidate);
        over_rows(tracer, &initial, |value| p0 = p0.max(value));
        let least = least_share(tracer.problem, &candidate);
        over_rows(tracer, &noise, |value| r = r.min(least * value));
        let entries: Vec<Id> = jacobian.into_iter().flatten().collect();
        over_rows(tracer, &entries, |value| h = h.max(value * value));
    }
    Ok(p0 * h / r.max(0.0))
}

/// The share of the model's R down to which a candidate's filter may adapt it, where it has a floor.
fn least_share(problem: &Problem, candidate: &[f64]) -> f64 {
    let floor = problem.filter.settings().into_iter().find(|setting| setting.key == "floor");
    floor.map_or(1.0, |setting| setting.value(&problem.parameters.resolve(candidate)))
}

/// The candidates that the rule looks at.
pub(super) fn corners(parameters: &Parameters) -> [Vec<f64>; 3] {
    let at = |end: usize| parameters.searched().map(|(_, search)| range(search)[end]).collect();
    [at(0), parameters.baseline(), at(1)]
}

/// Diagonals of P0 and R of a candidate.
fn variances(tracer: &mut Tracer<'_>, candidate: &[f64]) -> (Vec<Id>, Vec<Id>) {
    let model = &tracer.problem.model;
    let parameters = formula::parameters(&mut tracer.g, &tracer.problem.parameters, Some(candidate));
    let (inputs, dt) = tracer.inputs();
    let scope = Scope { states: &[], parameters: &parameters, inputs: &inputs, dt };
    let p0 = tracer.covariance(&model.p0, scope, &vec![0; model.states.len()]);
    let r = tracer.covariance(&model.r, scope, &vec![0; model.measurements.len()]);
    let diagonal = |s: &super::symmetric::Symmetric| (0..s.n()).map(|i| s.at(i, i)).collect();
    (diagonal(&p0), diagonal(&r))
}

/// Every value that some nodes take over the rows of the log.
pub(super) fn over_rows(tracer: &Tracer<'_>, ids: &[Id], mut take: impl FnMut(f64)) {
    let constant = ids.iter().all(|id| tracer.g.depends(*id).is_constant());
    let rows = if constant { 1 } else { tracer.rows.spans().last().map_or(0, |s| s.end) };
    let mut calculator = Calculator::new(&tracer.g, ids);
    for row in 0..rows {
        let leaf = |leaf| match leaf {
            Leaf::Column(c) => tracer.columns.value(c, row),
            _ => f64::NAN,
        };
        calculator.evaluate(leaf).for_each(&mut take);
    }
}
