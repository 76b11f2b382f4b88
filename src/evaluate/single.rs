//! The program in single precision, tried where a log may be beyond it.

use super::{CpuEvaluator, Evaluation, Evaluator, Population, Precision};
use crate::data::Log;
use crate::filter::{Nominal, Program, TraceError, probed, scattered, trace};
use crate::model::Problem;
use crate::objective::{Kind, Objective};

/// The deviation form around the baseline's run by `double`, the program of the same objectives in f64 (traced here where there
/// is none).
///
/// Where P grows over long stretches without measurements, the costs of the baseline and of candidates at and between the
/// bounds are held against f64: no other rule knows how many digits so long a prediction leaves.
///
/// # Errors
/// If the filter cannot be traced, or those candidates miss the promise.
pub(super) fn program(
    problem: &Problem,
    log: &Log,
    objectives: &[Objective],
    double: Option<&Program>,
) -> Result<Program, TraceError> {
    let single = trace(problem, log, objectives, Some(nominal(problem, log, double)?))?;
    if single.anchored() && problem.parameters.dimension() > 0 {
        let double = match double {
            Some(double) => double.clone().constrained(&[]),
            None => trace(problem, log, objectives, None)?,
        };
        hold(problem, objectives, &single, double)?;
    }
    Ok(single)
}

/// The baseline's run by `double`, or by a program that scores nothing. Where f or h is not affine the deviation form is good to
/// 1e-5 up to some 200 standard deviations from the nominal, and a start may have lost the track: then it is the run of the likeliest
/// of the baseline and [`TRIED`] candidates all over the ranges.
///
/// # Errors
/// If the filter cannot be traced, or none of those candidates has a run.
pub(super) fn nominal(problem: &Problem, log: &Log, double: Option<&Program>) -> Result<Nominal, TraceError> {
    let baseline = problem.parameters.baseline();
    if !problem.filter.is_linear() {
        return likeliest(problem, log, baseline);
    }
    Ok(match double {
        Some(double) => double.nominal(&baseline),
        None => trace(problem, log, &[], None)?.nominal(&baseline),
    })
}

/// Candidates besides the baseline whose run may be the nominal.
const TRIED: usize = 63;

fn likeliest(problem: &Problem, log: &Log, baseline: Vec<f64>) -> Result<Nominal, TraceError> {
    let program = trace(problem, log, &[Objective::new(Kind::Nll)], None)?;
    let dimension = problem.parameters.dimension();
    let mut candidates = vec![baseline];
    if dimension > 0 {
        candidates.extend(scattered(&problem.parameters, TRIED));
    }
    let best = match dimension {
        0 => 0,
        _ => {
            let population = Population::from_rows(dimension, candidates.concat());
            let found = CpuEvaluator::of_program(program.clone(), None).evaluate(&population);
            let sound = (0..population.len()).filter(|i| found.status(*i).is_ok());
            sound.min_by(|a, b| found.costs(*a)[0].total_cmp(&found.costs(*b)[0])).ok_or(TraceError::NoNominal)?
        }
    };
    let nominal = program.nominal(&candidates[best]);
    if nominal.is_finite() { Ok(nominal) } else { Err(TraceError::NoNominal) }
}

/// Candidates between the bounds.
const SCATTERED: usize = 256;

/// Share of the promise that these may use up, since errors elsewhere scatter: 0.9 among 261 candidates went with 2.2 among 65
/// others.
const MARGIN: f64 = 0.5;

/// An error where a candidate has a cost in both precisions and they are about as far apart as f32 promises or farther.
fn hold(problem: &Problem, objectives: &[Objective], single: &Program, double: Program) -> Result<(), TraceError> {
    let (rows, mut candidates) = (double.rows(), probed(&problem.parameters));
    candidates.extend(scattered(&problem.parameters, SCATTERED));
    let population = Population::from_rows(problem.parameters.dimension(), candidates.concat());
    let costs = |program: Program| -> Evaluation { CpuEvaluator::of_program(program, None).evaluate(&population) };
    let (single, double) = (costs(single.clone()), costs(double));
    for i in (0..population.len()).filter(|i| single.status(*i).is_ok() && double.status(*i).is_ok()) {
        for ((objective, found), expected) in objectives.iter().zip(single.costs(i)).zip(double.costs(i)) {
            let promised = objective.kind.resolution(Precision::F32, *expected, rows);
            if (found - expected).abs() > MARGIN * promised {
                return Err(TraceError::LostInSingle {
                    objective: objective.name().to_owned(),
                    single: digits(*found),
                    double: digits(*expected),
                });
            }
        }
    }
    Ok(())
}

/// A number to nine digits, where two precisions part.
fn digits(value: f64) -> String {
    format!("{value:.8e}").parse().map_or_else(|_| value.to_string(), |rounded: f64| rounded.to_string())
}
