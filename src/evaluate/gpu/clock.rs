//! Time spent in kernels, by the adapter's own clock.

use super::device::{Gpu, GpuFailure};
use std::time::Duration;
use wgpu::BufferUsages as Usage;

/// Two timestamps around the kernels.
#[derive(Debug)]
pub(super) struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl Clock {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let resolved = gpu.buffer("timestamps", 16, Usage::QUERY_RESOLVE | Usage::COPY_SRC);
        let staging = gpu.buffer("timestamps, read back", 16, Usage::MAP_READ | Usage::COPY_DST);
        Self { queries, resolved, staging }
    }

    /// What the pass of a submission writes: the first its beginning, the last its end, those between nothing.
    pub(super) fn writes(&self, first: bool, last: bool) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        (first || last).then(|| wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: first.then_some(0),
            end_of_pass_write_index: last.then_some(1),
        })
    }

    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, 16);
    }

    pub(super) fn read(&self, gpu: &Gpu) -> Result<Duration, GpuFailure> {
        let [begin, end] = gpu.read(&self.staging, 16, |bytes| {
            let tick = |i: usize| u64::from_ne_bytes(bytes[8 * i..8 * i + 8].try_into().unwrap_or_default());
            [tick(0), tick(1)]
        })?;
        #[expect(clippy::cast_precision_loss, reason = "a kernel takes far fewer than 2^53 ticks")]
        let nanoseconds = end.saturating_sub(begin) as f64 * f64::from(gpu.queue.get_timestamp_period());
        Ok(Duration::from_secs_f64(nanoseconds * 1e-9))
    }
}
