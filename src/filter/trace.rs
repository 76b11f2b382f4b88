//! From a problem and its log to a [`Program`].

use super::columns::Columns;
use super::error::TraceError;
use super::form::Form;
use super::nominal::Nominal;
use super::program::Program;
use super::rounds::trace_rows;
use super::rows::Rows;
use super::step::Request;
use super::survey::{self, Survey};
use super::units::Units;
use crate::data::Log;
use crate::model::Problem;
use crate::objective::Objective;
use crate::precision::Precision;

/// Traces the filter of `problem` over `log` for some objectives.
///
/// With `nominal` the deviation form is traced, which single precision needs; the covariance is then carried in the
/// [`Form`] that P0 and R call for, and without one in full.
///
/// # Errors
/// If the log has other columns than the problem, f or h is not affine in the states, `first = "predict"` has no interval,
/// the step has more values than operations can name, or the deviation form cannot express a searched parameter.
pub fn trace(
    problem: &Problem,
    log: &Log,
    objectives: &[Objective],
    nominal: Option<Nominal>,
) -> Result<Program, TraceError> {
    trace_as(problem, log, objectives, nominal, None)
}

/// [`trace`] with a given form of the covariance.
///
/// # Errors
/// As [`trace`].
pub fn trace_as(
    problem: &Problem,
    log: &Log,
    objectives: &[Objective],
    nominal: Option<Nominal>,
    form: Option<Form>,
) -> Result<Program, TraceError> {
    Ok(trace_around(problem, log, objectives, nominal, form)?.0)
}

/// [`trace_as`], and the nominal that the program deviates from: after a long gap not the one that was given.
///
/// # Errors
/// As [`trace`].
pub(crate) fn trace_around(
    problem: &Problem,
    log: &Log,
    objectives: &[Objective],
    nominal: Option<Nominal>,
    form: Option<Form>,
) -> Result<(Program, Option<Nominal>), TraceError> {
    check_columns(problem, log)?;
    let rows = Rows::new(problem, log);
    let mut columns = Columns::default();
    let precision = if nominal.is_some() { Precision::F32 } else { Precision::F64 };
    let own = Units::own(problem.model.states.len(), problem.model.measurements.len());
    let survey = Survey::new(problem, &rows, &mut columns, &own)?;
    let (carrying, track) = survey::carrying(&survey, precision, form)?;
    let units = survey::units(&survey, precision);
    // After a gap a predicted state is wherever the gap has led it, and nothing measured is near.
    let nominal = match track {
        Some(track) => nominal.map(|nominal| nominal.on(track)),
        None => nominal,
    };
    let request = Request { objectives, nominal: nominal.as_ref(), carrying, units: &units, watch: None };
    let program = trace_rows(problem, &rows, &mut columns, &request)?;
    Ok((program, nominal))
}

/// Values are found by their place: measurements and inputs of the log are those of the model, in its order.
fn check_columns(problem: &Problem, log: &Log) -> Result<(), TraceError> {
    let expected = [problem.model.measurements.len(), problem.model.inputs.len()];
    let found = [log.measurements.len(), log.inputs.len()];
    if found == expected { Ok(()) } else { Err(TraceError::WrongColumns { found, expected }) }
}
