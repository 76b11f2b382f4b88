//! The filter that a problem asks for: one line a family.

use super::Cause;
use super::adapt::{Fuzzy, SageHusa, SageHusaR};
use super::filter::Filter;
use super::imm::Imm;
use super::kalman::Kalman;
use super::matrices::Formulas;
use super::robust::Withstanding;
use super::sigma::SigmaPoints;
use crate::data::Log;
use crate::model::{FilterKind, Problem, Setting};

/// The filter of a problem for a candidate, over a log: `parameters` are all values.
///
/// # Errors
/// If a setting is outside its range.
pub(super) fn of(problem: &Problem, log: &Log, parameters: Vec<f64>) -> Result<Box<dyn Filter>, Cause> {
    let inner = plain(problem, parameters.clone())?;
    let Some(robust) = &problem.robust else { return Ok(inner) };
    let values = settings(&robust.settings(), &parameters)?;
    let linearisations = match &problem.filter {
        FilterKind::Extended(_) => 1,
        FilterKind::Iterated(iterated) => iterated.iterations,
        _ => 0,
    };
    let (formulas, ranges) = (Formulas::new(&problem.model, parameters), log.ranges());
    let known = (&problem.model.angles, ranges.as_slice());
    Ok(Box::new(Withstanding::new(inner, robust, &values, formulas, known, linearisations)))
}

/// The same with updates that count in full.
fn plain(problem: &Problem, parameters: Vec<f64>) -> Result<Box<dyn Filter>, Cause> {
    let Problem { filter, model, .. } = problem;
    let values = settings(&filter.settings(), &parameters)?;
    if let FilterKind::Imm(imm) = filter {
        let modes = problem.modes.iter().map(|mode| plain(&problem.of_mode(mode), parameters.clone()));
        return Ok(Box::new(Imm::new(problem, imm, modes.collect::<Result<_, _>>()?, parameters)));
    }
    let formulas = Formulas::new(model, parameters);
    let m = formulas.m;
    Ok(match filter {
        // It has returned above.
        FilterKind::Imm(_) => Box::new(Kalman::new(formulas, None)),
        FilterKind::Kalman(_) => Box::new(Kalman::new(formulas, None)),
        FilterKind::SageHusa(_) => Box::new(Kalman::new(formulas, Some(Box::new(SageHusa::new(&values))))),
        FilterKind::SageHusaR(_) => Box::new(Kalman::new(formulas, Some(Box::new(SageHusaR::new(&values, m))))),
        FilterKind::Fuzzy(fuzzy) => {
            Box::new(Kalman::new(formulas, Some(Box::new(Fuzzy::new(&values, fuzzy.window, m)))))
        }
        FilterKind::Extended(_) => Box::new(Kalman::local(formulas, 1)),
        FilterKind::Iterated(iterated) => Box::new(Kalman::local(formulas, iterated.iterations)),
        FilterKind::Unscented(_) => Box::new(SigmaPoints::new(formulas, [values[0], values[1], values[2]])),
        FilterKind::Cubature(_) => Box::new(SigmaPoints::new(formulas, [1.0, 0.0, 0.0])),
    })
}

/// The values of settings, each in its range.
fn settings(all: &[Setting<'_>], parameters: &[f64]) -> Result<Vec<f64>, Cause> {
    let of = |setting: &Setting<'_>| {
        let value = setting.value(parameters);
        if setting.range.contains(value) { Ok(value) } else { Err(Cause::Setting { key: setting.key }) }
    };
    all.iter().map(of).collect()
}
