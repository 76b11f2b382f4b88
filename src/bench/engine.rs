//! What is measured: the CPU with some threads, or an adapter.

use std::num::NonZero;
use std::time::Duration;

use super::BenchError;
use crate::data::Log;
use crate::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Population, Precision};
use crate::filter::Program;
use crate::model::Problem;

#[cfg(feature = "gpu")]
use crate::evaluate::gpu::{GpuEvaluator, GpuOptions};

/// Where to measure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// The processor.
    Cpu {
        /// Threads, at least 1.
        threads: usize,
    },
    /// An adapter.
    Gpu {
        /// Part of its name; `None` = the best real one, never a software adapter.
        adapter: Option<String>,
    },
}

/// An adapter that could be measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// Its name.
    pub name: String,
    /// Whether it is a program on the CPU that acts as a GPU.
    pub software: bool,
    /// Whether it computes in f64.
    pub f64: bool,
}

/// Every adapter of this machine, real hardware first; none without the feature `gpu`. One that several backends offer
/// under one name counts once.
#[must_use]
pub fn adapters() -> Vec<Adapter> {
    #[cfg(feature = "gpu")]
    {
        let mut found: Vec<Adapter> = Vec::new();
        for info in crate::evaluate::gpu::adapters() {
            if found.iter().all(|known| known.name != info.name) {
                found.push(Adapter { software: info.is_software(), f64: info.f64, name: info.name });
            }
        }
        found
    }
    #[cfg(not(feature = "gpu"))]
    Vec::new()
}

/// An evaluator that tells how long its kernels took.
#[derive(Debug)]
pub(super) enum Engine {
    Cpu(Box<CpuEvaluator>),
    #[cfg(feature = "gpu")]
    Gpu(Box<GpuEvaluator>),
}

/// What a report says of an engine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Description {
    /// `cpu`, `gpu` or `software adapter`.
    pub(super) device: &'static str,
    /// Processor and instruction set, or adapter and driver.
    pub(super) name: String,
    /// Time to make the kernel.
    pub(super) kernel_build: Option<Duration>,
}

impl Engine {
    pub(super) fn new(problem: &Problem, log: &Log, target: &Target, precision: Precision) -> Result<Self, BenchError> {
        match target {
            Target::Cpu { threads } => {
                let options = CpuOptions { precision, threads: NonZero::new(*threads) };
                Ok(Self::Cpu(Box::new(CpuEvaluator::new(problem, log, options)?)))
            }
            #[cfg(feature = "gpu")]
            Target::Gpu { adapter } => {
                let options = GpuOptions { precision, adapter: adapter.clone(), timed: true, ..GpuOptions::default() };
                Ok(Self::Gpu(Box::new(GpuEvaluator::new(problem, log, &options)?)))
            }
            #[cfg(not(feature = "gpu"))]
            Target::Gpu { .. } => Err(BenchError::NoGpuSupport),
        }
    }

    /// Costs, and the time in kernels where the adapter can tell.
    pub(super) fn evaluate(&mut self, population: &Population) -> Result<(Evaluation, Option<Duration>), BenchError> {
        match self {
            Self::Cpu(cpu) => Ok((cpu.evaluate(population), None)),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let evaluation = gpu.evaluate(population);
                match gpu.failure() {
                    None => Ok((evaluation, gpu.kernel_time())),
                    Some(failure) => {
                        Err(BenchError::Failed { adapter: gpu.adapter().name.clone(), reason: failure.to_string() })
                    }
                }
            }
        }
    }

    pub(super) fn program(&self) -> &Program {
        match self {
            Self::Cpu(cpu) => cpu.program(),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.program(),
        }
    }

    pub(super) fn description(&self) -> Description {
        match self {
            Self::Cpu(cpu) => Description { device: "cpu", name: cpu.device().adapter.to_string(), kernel_build: None },
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => Description {
                device: if gpu.adapter().is_software() { "software adapter" } else { "gpu" },
                name: gpu.device().adapter.to_string(),
                kernel_build: Some(gpu.kernel_build_time()),
            },
        }
    }
}
