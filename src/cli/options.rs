//! Flags that several verbs share.

use std::num::NonZeroUsize;

use clap::{Args, ValueEnum};

use crate::evaluate::{CpuOptions, Precision};

/// How candidates are computed.
#[derive(Debug, Clone, Args)]
pub(super) struct Compute {
    /// Where candidates are computed; `auto` takes a GPU only for a large job, and never a software renderer. `gpu` is
    /// an error where there is none.
    #[arg(long, value_enum, default_value_t = DeviceChoice::Auto, value_name = "DEVICE")]
    pub(super) device: DeviceChoice,

    /// GPU whose name contains this, which may be a software renderer (default: the best real one); `kfgpu devices`
    /// lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,

    /// Number format of the costs; `auto` is f64 on the CPU and f32 on a GPU. f32 is about twice as fast on a CPU, many
    /// times on a GPU, and less exact; `tune` re-scores its winner in f64.
    #[arg(long, value_enum, default_value_t = PrecisionChoice::Auto, value_name = "FORMAT")]
    pub(super) precision: PrecisionChoice,

    /// Threads that compute candidates (default: one per core). No result depends on it; give 1 to leave the other
    /// cores alone.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(super) threads: Option<NonZeroUsize>,
}

/// A number of threads that can be started in a moment: far more than cores gain nothing and take minutes.
pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    up_to(1024, text)
}

/// A number of candidates a run: as many as a problem's `tune.population` may have.
pub(super) fn candidates(text: &str) -> Result<NonZeroUsize, String> {
    up_to(16_777_216, text)
}

fn up_to(most: usize, text: &str) -> Result<NonZeroUsize, String> {
    let number = text.parse().ok().filter(|number: &NonZeroUsize| number.get() <= most);
    number.ok_or_else(|| format!("expected a whole number from 1 to {most}"))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DeviceChoice {
    Auto,
    Gpu,
    Cpu,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum PrecisionChoice {
    Auto,
    F64,
    F32,
}

impl From<PrecisionChoice> for Precision {
    fn from(choice: PrecisionChoice) -> Self {
        match choice {
            PrecisionChoice::Auto | PrecisionChoice::F64 => Self::F64,
            PrecisionChoice::F32 => Self::F32,
        }
    }
}

impl PrecisionChoice {
    /// What it means on a GPU.
    #[cfg(feature = "gpu")]
    pub(super) const fn on_gpu(self) -> Precision {
        match self {
            Self::Auto | Self::F32 => Precision::F32,
            Self::F64 => Precision::F64,
        }
    }
}

impl Compute {
    /// The CPU evaluator's options; what else runs in parallel then keeps to the same number of threads.
    pub(super) fn cpu(&self) -> CpuOptions {
        if let Some(threads) = self.threads {
            // Only a second call could fail, and its number would be the same.
            let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global();
        }
        CpuOptions { precision: self.precision.into(), threads: self.threads }
    }
}
