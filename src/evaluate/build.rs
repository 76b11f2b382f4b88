//! From a problem and its log to an evaluator on the CPU.

use super::{CpuEvaluator, CpuOptions, Precision, single};
use crate::data::Log;
use crate::filter::{Form, Program, TraceError, trace_as};
use crate::model::Problem;
use crate::objective::Objective;

/// Why an evaluator cannot be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The filter cannot be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

impl CpuEvaluator {
    /// An evaluator of the problem's own objectives and constraints.
    ///
    /// # Errors
    /// If the filter cannot be traced.
    pub fn new(problem: &Problem, log: &Log, options: CpuOptions) -> Result<Self, BuildError> {
        let program = Self::trace(problem, log, &problem.tune.scorers(), options.precision, None)?;
        Ok(Self::of_program(program.constrained(&problem.tune.constraints), options.threads))
    }

    /// An evaluator of other objectives, without constraints.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_objectives(
        problem: &Problem,
        log: &Log,
        objectives: &[Objective],
        options: CpuOptions,
    ) -> Result<Self, BuildError> {
        Self::with_form(problem, log, objectives, options, None)
    }

    /// An evaluator that carries the covariance in a given form, to compare forms.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_form(
        problem: &Problem,
        log: &Log,
        objectives: &[Objective],
        options: CpuOptions,
        form: Option<Form>,
    ) -> Result<Self, BuildError> {
        Ok(Self::of_program(Self::trace(problem, log, objectives, options.precision, form)?, options.threads))
    }

    /// An evaluator of the problem's own objectives and constraints that shares what `double`, their program in f64, has
    /// found already: that program itself, or its nominal.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_double(
        problem: &Problem,
        log: &Log,
        double: &Program,
        options: CpuOptions,
    ) -> Result<Self, BuildError> {
        Ok(Self::of_program(beside(problem, log, double, options.precision)?, options.threads))
    }

    fn trace(
        problem: &Problem,
        log: &Log,
        objectives: &[Objective],
        precision: Precision,
        form: Option<Form>,
    ) -> Result<Program, TraceError> {
        match (precision, form) {
            (Precision::F64, form) => trace_as(problem, log, objectives, None, form),
            (Precision::F32, None) => single::program(problem, log, objectives, None),
            (Precision::F32, form) => {
                trace_as(problem, log, objectives, Some(single::nominal(problem, log, None)?), form)
            }
        }
    }
}

/// The program of the problem's own scorers in a precision, from that in f64.
pub(super) fn beside(
    problem: &Problem,
    log: &Log,
    double: &Program,
    precision: Precision,
) -> Result<Program, TraceError> {
    match precision {
        Precision::F64 => Ok(double.clone()),
        Precision::F32 => {
            let program = single::program(problem, log, &problem.tune.scorers(), Some(double))?;
            Ok(program.constrained(&problem.tune.constraints))
        }
    }
}
