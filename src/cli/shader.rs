//! `kfgpu shader`: the kernel that a GPU runs.

use std::path::PathBuf;

use clap::Args;

use super::console::Console;
use super::options::PrecisionChoice;
use super::{Ending, files, load};
use crate::evaluate::{CpuEvaluator, CpuOptions};

/// Print the WGSL of the kernel that a GPU runs for this problem; it needs no GPU.
#[derive(Debug, Args)]
pub(super) struct Shader {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Log to trace for in place of the problem file's (default: the file's `data.file`).
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Number format of the kernel; `auto` is f32.
    #[arg(long, value_enum, default_value_t = PrecisionChoice::Auto, value_name = "FORMAT")]
    precision: PrecisionChoice,
}

impl Shader {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let precision = self.precision.on_gpu();
        let options = CpuOptions { precision, ..CpuOptions::default() };
        let (problem, log) = (&loaded.problem, &loaded.log);
        let evaluator = CpuEvaluator::new(problem, log, options)?;
        files::print(&crate::evaluate::gpu::assemble(evaluator.program())?)?;
        Ok(Ending::Done)
    }
}
