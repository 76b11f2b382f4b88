//! How a filter is carried, and why.

use super::probe::Probe;
use super::{Survey, corners};
use crate::filter::error::TraceError;
use crate::filter::form::{Carrying, Form};
use crate::model::{Adapts, Problem};
use crate::precision::Precision;

/// By the problem and its log alone, unless the form is given.
///
/// Single precision carries P for a P0 up to [`Form::DIFFUSE`] times R, and factors beyond. It carries factors too where
/// Q is adapted (a step after a large correction is as diffuse as a start), and where an update after a gap takes P down
/// by more. Double precision carries factors where a [`Probe`] finds that an update takes P down by more than
/// [`Form::DIFFUSE_F64`]. After such a gap x is anchored to what is measured, and with it comes the track of the baseline
/// after its updates, for a nominal.
pub(in crate::filter) fn choose(
    survey: &Survey<'_>,
    precision: Precision,
    form: Option<Form>,
) -> Result<(Carrying, Option<Vec<f64>>), TraceError> {
    let problem = survey.t.problem;
    if !problem.filter.is_linear() {
        return Ok((curved(problem, precision, form), None));
    }
    let diffuseness = diffuseness(survey);
    let single = precision == Precision::F32;
    let limit = if single { Form::DIFFUSE } else { Form::DIFFUSE_F64 };
    let probe = Probe::run(survey, !single && diffuseness > limit)?;
    let lost = |loss: fn(&Probe) -> f64| probe.as_ref().is_some_and(|probe| loss(probe) > limit);
    let (start, anchored) = (lost(|probe| probe.start), lost(|probe| probe.after));
    let adapts_q = problem.filter.facts().adapts == Adapts::ProcessNoise;
    let diffuse = if single { adapts_q || diffuseness > limit } else { start };
    let chosen = if diffuse || anchored { Form::Factored } else { Form::Full };
    let track = probe.filter(|_| anchored).map(|probe| probe.track);
    // An angle is known but for whole turns: x cannot be held against it once more.
    let anchored = anchored && problem.model.angles.measurements.is_empty();
    Ok((Carrying { form: form.unwrap_or(chosen), anchored, affine: true }, track))
}

/// Filters of any f and h: single precision carries factors (P lost up to two digits more in the median over ten problems), from
/// the end at which their points are drawn; double precision carries P.
fn curved(problem: &Problem, precision: Precision, form: Option<Form>) -> Carrying {
    if !problem.modes.is_empty() {
        // Gaussians that are mixed are added up.
        return Carrying { form: Form::Full, anchored: false, affine: true };
    }
    let factors = if problem.filter.facts().ordered { Form::Lower } else { Form::Factored };
    let chosen = if precision == Precision::F32 { factors } else { Form::Full };
    Carrying { form: form.unwrap_or(chosen), anchored: false, affine: true }
}

/// The largest P0_ii, times the largest H_ji^2 (which brings it to the unit of the measurements), over the smallest R_jj
/// (or what an adaptive filter may make of it), each over the whole log and over the corners.
fn diffuseness(survey: &Survey<'_>) -> f64 {
    let (mut p0, mut h, mut r) = (0.0_f64, 0.0_f64, f64::INFINITY);
    let (t, problem) = (&survey.t, survey.t.problem);
    for (model, candidate) in survey.corners.iter().zip(corners(&problem.parameters)) {
        t.over_rows(&model.P0.diagonal(), |value| p0 = p0.max(value));
        let floor = problem.filter.facts().noise_floor;
        let least = floor.map_or(1.0, |floor| floor.value(&problem.parameters.resolve(&candidate)));
        t.over_rows(&model.R.diagonal(), |value| r = r.min(least * value));
        t.over_rows(&model.h.jacobian.concat(), |value| h = h.max(value * value));
    }
    p0 * h / r.max(0.0)
}
