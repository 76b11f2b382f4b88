//! Why nothing was measured.

use crate::data::LogError;
use crate::evaluate::BuildError;
#[cfg(feature = "gpu")]
use crate::evaluate::gpu::GpuError;
use crate::model::ProblemError;

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The problem is not one.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The log is not one.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The filter cannot be traced.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The adapter cannot run it.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The adapter failed while it was measured; what the CPU then did is no figure of the adapter.
    #[error("adapter `{adapter}` failed while it was measured: {reason} (use fewer candidates, or --device cpu)")]
    Failed {
        /// Its name.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The library was built without its feature `gpu`.
    #[error("this kfgpu was built without GPU support: use --device cpu, or build it with the feature `gpu`")]
    NoGpuSupport,
    /// Without a searched parameter there is no candidate.
    #[error("{0}: no parameter is searched, expected at least one (give one a range: r = {{ min = 0.1, max = 10 }})")]
    NothingSearched(String),
    /// An option that must be positive is 0.
    #[error("bench: {0} is 0, expected at least 1")]
    Zero(&'static str),
}

impl BenchError {
    /// Whether another device or number format could still be measured.
    pub(super) const fn is_of_one_device(&self) -> bool {
        match self {
            Self::Build(_) | Self::Failed { .. } | Self::NoGpuSupport => true,
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => true,
            Self::Problem(_) | Self::Log(_) | Self::NothingSearched(_) | Self::Zero(_) => false,
        }
    }
}
