//! On a GPU, or why not.

use super::Notices;
use crate::cli::options::{Compute, PrecisionChoice};
use crate::cli::stderr;
use crate::data::Log;
use crate::evaluate::gpu::{AdapterError, GpuError, GpuEvaluator, GpuOptions, adapters};
use crate::evaluate::{BuildError, Evaluator, Precision};
use crate::filter::Program;
use crate::model::Problem;

/// The evaluator on a GPU of a problem, its log, and their program in f64; `None` where the CPU is to compute, which has then been said if it needs saying.
///
/// # Errors
/// If a GPU was `asked` for and there is none, or the problem cannot be traced.
pub(super) fn build(
    problem: &Problem,
    log: &Log,
    double: &Program,
    compute: &Compute,
    asked: bool,
    notices: &Notices,
) -> anyhow::Result<Option<Box<dyn Evaluator>>> {
    // Most GPUs do f64 at a small fraction of their f32 rate: it is for whoever asks for both.
    if !asked && compute.precision == PrecisionChoice::F64 {
        return Ok(None);
    }
    match stderr::without_desktop(|| open(problem, log, double, compute)) {
        Ok(mut evaluator) => {
            let later = notices.clone();
            evaluator.on_failure(move |sentence| later.warn(sentence));
            Ok(Some(Box::new(evaluator)))
        }
        Err(GpuError::Adapter(AdapterError::None | AdapterError::OnlySoftware { .. })) if !asked => Ok(None),
        Err(
            error @ (GpuError::Adapter(AdapterError::NoF64 { .. } | AdapterError::Refused { .. })
            | GpuError::Wgsl(_)
            | GpuError::TooWide { .. }
            | GpuError::TooLong { .. }
            | GpuError::Refused { .. }),
        ) => {
            let format = Precision::from(compute.precision);
            notices.warn(&format!("{}: computing on the CPU in {format}", reason(&error)));
            Ok(None)
        }
        Err(error) => Err(error.into()),
    }
}

/// Whether an adapter of this name is here.
pub(in crate::cli) fn has_adapter(name: &str) -> bool {
    stderr::without_desktop(adapters).iter().any(|adapter| adapter.name == name)
}

/// In f32 unless f64 is asked for, or the problem needs it and the choice is free.
fn open(problem: &Problem, log: &Log, double: &Program, compute: &Compute) -> Result<GpuEvaluator, GpuError> {
    let options = |precision| GpuOptions {
        precision,
        adapter: compute.adapter.clone(),
        threads: compute.cpu().threads,
        ..GpuOptions::default()
    };
    match GpuEvaluator::with_double(problem, log, double, &options(compute.precision.on_gpu())) {
        Err(error) if compute.precision == PrecisionChoice::Auto && needs_f64(&error) => {
            GpuEvaluator::with_double(problem, log, double, &options(Precision::F64))
        }
        result => result,
    }
}

const fn needs_f64(error: &GpuError) -> bool {
    matches!(error, GpuError::Build(BuildError::Trace(error)) if error.needs_f64())
}

/// The error without its advice, where the program follows it by itself.
fn reason(error: &GpuError) -> String {
    match error {
        GpuError::Adapter(AdapterError::NoF64 { name }) => format!("adapter `{name}` has no f64"),
        GpuError::Adapter(AdapterError::Refused { name, reason }) => {
            format!("adapter `{name}` cannot be opened ({reason})")
        }
        GpuError::Refused { adapter, reason } => format!("adapter `{adapter}` refuses the kernel ({reason})"),
        other => other.to_string(),
    }
}
