//! One row of one candidate's run as an adapter has it.

use super::device::{Gpu, GpuFailure};
use super::kernel::Kernel;
use super::layout::Layout;
use super::{AdapterInfo, GpuError, GpuOptions};
use crate::evaluate::probe::{Probe, Seen};

/// What an adapter (`None` = the best real one) has in the row, where `lanes` is what the CPU's lanes have. The kernel is the
/// one that scores candidates, but that it stores what its last row begins with and every value of that row's step.
///
/// # Errors
/// If there is no adapter, or the driver refuses the kernel or fails.
pub fn probe(probe: &Probe, lanes: &Seen, adapter: Option<&str>) -> Result<(AdapterInfo, Seen), GpuError> {
    let (program, candidate) = (probe.program(), probe.candidate());
    let precision = program.precision();
    let gpu = Gpu::open(adapter, precision)?;
    let options = GpuOptions { precision, ..GpuOptions::default() };
    let mut kernel = Kernel::of(&gpu, program, &options, candidate, Layout::traced(program))?;
    let failed = |GpuFailure(reason)| GpuError::Refused { adapter: gpu.info.name.clone(), reason };
    let mut before = kernel.trace(&gpu, program, candidate).map_err(failed)?;
    let values = before.split_off(program.carried().len());
    let operations = probe.step().0.tape().operations.len();
    // Invariants come from the host, the same for the lanes.
    before.extend(&lanes.before[program.carried().len()..]);
    Ok((gpu.info, Seen { before, values: values[..operations].to_vec() }))
}
