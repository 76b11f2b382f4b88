//! The GPU evaluator: the same tape as WGSL, one candidate an invocation.

mod adapter;
mod clock;
mod device;
mod functions;
mod kernel;
mod layout;
mod probe;
mod prologue;
mod shader;
mod totals;
mod upload;

pub use adapter::{AdapterError, AdapterInfo, adapters};
pub use device::GpuFailure;
pub use functions::{Functions, Values};
pub use probe::probe;
pub use shader::assemble;

use super::build::beside;
use super::cpu::CpuEvaluator;
use super::{Adapter, Backend, BuildError, Device, Evaluation, Evaluator, Population, Precision, single};
use crate::data::Log;
use crate::filter::{Program, trace};
use crate::model::Problem;
use crate::objective::{Constraint, Objective};
use crate::tape::wgsl::WgslError;
use device::Gpu;
use kernel::Kernel;
use std::num::NonZero;
use std::time::{Duration, Instant};

/// How the GPU evaluator runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GpuOptions {
    /// Number format of the filter.
    pub precision: Precision,
    /// Part of the adapter's name; `None` = the best real one, never a software renderer.
    pub adapter: Option<String>,
    /// Largest part of a population that is dispatched at once, below the adapter's own limit. It never changes a result.
    pub largest_part: Option<usize>,
    /// Largest number of trajectories that one dispatch scores side by side; `None` = as many as their records fit, 1 = one
    /// after the other. It never changes a result.
    pub largest_group: Option<usize>,
    /// Whether kernels are timed (where the adapter can).
    pub timed: bool,
    /// Threads of the CPU that goes on when the GPU fails; `None` = one a core. It never changes a result.
    pub threads: Option<NonZero<usize>>,
}

impl Default for GpuOptions {
    fn default() -> Self {
        Self {
            precision: Precision::F32,
            adapter: None,
            largest_part: None,
            largest_group: None,
            timed: false,
            threads: None,
        }
    }
}

/// Why a GPU evaluator cannot be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter.
    #[error(transparent)]
    Adapter(#[from] AdapterError),
    /// The filter cannot be traced.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The step has no WGSL.
    #[error(transparent)]
    Wgsl(#[from] WgslError),
    /// The problem is larger than a kernel can hold.
    #[error("a row of the record takes {columns} numbers, a kernel holds {limit}: use --device cpu")]
    TooWide {
        /// Columns of the record.
        columns: usize,
        /// What fits.
        limit: usize,
    },
    /// The log is longer than a buffer can hold.
    #[error("the log takes a buffer of {bytes} bytes, the adapter holds {limit}: use --device cpu")]
    TooLong {
        /// Bytes needed.
        bytes: u64,
        /// What fits.
        limit: u64,
    },
    /// The driver refuses the kernel.
    #[error(
        "adapter `{adapter}` refuses the kernel: {reason} (use --device cpu, and please report it with the output of `kfgpu shader`)"
    )]
    Refused {
        /// Its name.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
}

/// Who is told when the GPU fails.
type Notice = Box<dyn FnMut(&str) + Send>;

/// Scores populations on a GPU; when that fails in the middle of the work, on the CPU with the same tape and nominal.
pub struct GpuEvaluator {
    gpu: Gpu,
    kernel: Kernel,
    cpu: CpuEvaluator,
    precision: Precision,
    failure: Option<GpuFailure>,
    on_failure: Option<Notice>,
    kernel_time: Option<Duration>,
    kernel_build_time: Duration,
}

impl std::fmt::Debug for GpuEvaluator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GpuEvaluator")
            .field("adapter", &self.gpu.info)
            .field("failure", &self.failure)
            .finish_non_exhaustive()
    }
}

impl GpuEvaluator {
    /// An evaluator of the problem's own objectives and constraints.
    ///
    /// # Errors
    /// If there is no adapter, the filter cannot be traced, or the driver refuses the kernel.
    pub fn new(problem: &Problem, log: &Log, options: &GpuOptions) -> Result<Self, GpuError> {
        Self::build(problem, log, &problem.tune.scorers(), &problem.tune.constraints, options)
    }

    /// An evaluator of other objectives, without constraints.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_objectives(
        problem: &Problem,
        log: &Log,
        objectives: &[Objective],
        options: &GpuOptions,
    ) -> Result<Self, GpuError> {
        Self::build(problem, log, objectives, &[], options)
    }

    /// An evaluator of the problem's own objectives and constraints that shares what `double`, their program in f64, has
    /// found already: that program itself, or its nominal.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_double(problem: &Problem, log: &Log, double: &Program, options: &GpuOptions) -> Result<Self, GpuError> {
        let gpu = Gpu::open(options.adapter.as_deref(), options.precision)?;
        let program = beside(problem, log, double, options.precision).map_err(BuildError::from)?;
        Self::of_program(gpu, program, options, &problem.parameters.baseline())
    }

    /// Of scorers whose last ones are held against `constraints`.
    fn build(
        problem: &Problem,
        log: &Log,
        scorers: &[Objective],
        constraints: &[Constraint],
        options: &GpuOptions,
    ) -> Result<Self, GpuError> {
        let gpu = Gpu::open(options.adapter.as_deref(), options.precision)?;
        let program = match options.precision {
            Precision::F32 => single::program(problem, log, scorers, None),
            Precision::F64 => trace(problem, log, scorers, None),
        };
        let program = program.map_err(BuildError::from)?.constrained(constraints);
        Self::of_program(gpu, program, options, &problem.parameters.baseline())
    }

    fn of_program(gpu: Gpu, program: Program, options: &GpuOptions, baseline: &[f64]) -> Result<Self, GpuError> {
        let start = Instant::now();
        let kernel = Kernel::new(&gpu, &program, options, baseline)?;
        let kernel_build_time = start.elapsed();
        let precision = program.precision();
        let cpu = CpuEvaluator::of_program(program, options.threads);
        Ok(Self { gpu, kernel, cpu, precision, failure: None, on_failure: None, kernel_time: None, kernel_build_time })
    }

    /// Calls `notice` once, with a sentence, if the GPU fails and the CPU goes on.
    pub fn on_failure(&mut self, notice: impl FnMut(&str) + Send + 'static) {
        self.on_failure = Some(Box::new(notice));
    }

    /// The adapter.
    #[must_use]
    pub const fn adapter(&self) -> &AdapterInfo {
        &self.gpu.info
    }

    /// Time in kernels of the last evaluation, where it was asked for and the adapter can tell.
    #[must_use]
    pub const fn kernel_time(&self) -> Option<Duration> {
        self.kernel_time
    }

    /// Time to assemble the shader, create its pipeline and upload the record. A driver may compile only at the first
    /// dispatch, in the first evaluation's time.
    #[must_use]
    pub const fn kernel_build_time(&self) -> Duration {
        self.kernel_build_time
    }

    /// Dispatches of the kernel that score one part of a population: short trajectories share one.
    #[must_use]
    pub const fn dispatches(&self) -> usize {
        self.kernel.dispatches()
    }

    /// The program that the kernel runs.
    #[must_use]
    pub const fn program(&self) -> &Program {
        self.cpu.program()
    }

    /// Why the CPU has taken over, if it has.
    #[must_use]
    pub const fn failure(&self) -> Option<&GpuFailure> {
        self.failure.as_ref()
    }

    /// Takes the device away, as a driver reset would: for tests of what happens then.
    pub fn lose_device(&self) {
        self.gpu.device.destroy();
    }

    fn fail(&mut self, failure: GpuFailure) {
        let sentence =
            format!("the GPU `{}` failed ({failure}): going on with the CPU in {}", self.gpu.info.name, self.precision);
        if let Some(notice) = &mut self.on_failure {
            notice(&sentence);
        }
        self.failure = Some(failure);
    }
}

impl Evaluator for GpuEvaluator {
    fn objectives(&self) -> usize {
        self.cpu.objectives()
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        if self.failure.is_none() {
            match self.kernel.evaluate(&self.gpu, self.cpu.program(), population) {
                Ok((evaluation, time)) => {
                    self.kernel_time = time;
                    return evaluation;
                }
                Err(failure) => self.fail(failure),
            }
        }
        self.cpu.evaluate(population)
    }

    fn device(&self) -> Device {
        let AdapterInfo { name, backend, kind, driver, .. } = &self.gpu.info;
        let Some(failure) = &self.failure else {
            let adapter = Adapter { name: name.clone(), driver: format!("{kind}, {backend}, {driver}") };
            return Device { backend: Backend::Gpu, adapter, precision: self.precision };
        };
        let cpu = self.cpu.device();
        Device { adapter: format!("{}, after the GPU {name} failed: {failure}", cpu.adapter).into(), ..cpu }
    }

    fn rows(&self) -> usize {
        self.cpu.rows()
    }
}
