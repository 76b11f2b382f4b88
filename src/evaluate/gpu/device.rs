//! An opened adapter: buffers, pipelines and submissions, every error a value.

use super::adapter::{AdapterError, AdapterInfo, choose};
use super::layout::Layout;
use crate::precision::Precision;
use std::sync::mpsc;
use std::time::Duration;

/// A device with its queue.
#[derive(Debug)]
pub(super) struct Gpu {
    pub(super) info: AdapterInfo,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) limits: wgpu::Limits,
}

/// What the driver said when something failed in the middle of the work.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct GpuFailure(pub String);

impl Gpu {
    /// Opens an adapter with its own limits, not the small default ones.
    pub(super) fn open(wanted: Option<&str>, precision: Precision) -> Result<Self, AdapterError> {
        let (info, adapter) = choose(wanted)?;
        if precision == Precision::F64 && !info.f64 {
            return Err(AdapterError::NoF64 { name: info.name });
        }
        let limits = adapter.limits();
        let uniform = limits.max_uniform_buffer_binding_size;
        if uniform < 16 * Layout::RECORD as u64 {
            let reason = format!("it binds uniforms of {uniform} bytes, a kernel needs {}", 16 * Layout::RECORD);
            return Err(AdapterError::Refused { name: info.name, reason });
        }
        let wished = wgpu::Features::SHADER_F64 | wgpu::Features::TIMESTAMP_QUERY;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("kfgpu"),
            required_features: adapter.features() & wished,
            required_limits: limits.clone(),
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) =
            opened.map_err(|e| AdapterError::Refused { name: info.name.clone(), reason: e.to_string() })?;
        // A lost device reports through its submissions, and errors outside a scope must not panic.
        device.on_uncaptured_error(std::sync::Arc::new(|_| {}));
        Ok(Self { info, device, queue, limits })
    }

    /// Runs `work` and turns whatever the driver reports of it into an error.
    pub(super) fn guarded<T>(&self, work: impl FnOnce() -> T) -> Result<T, GpuFailure> {
        let filters = [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let result = work();
        let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
        match errors.last() {
            None => Ok(result),
            Some(error) => Err(GpuFailure(sentence(&error.to_string()))),
        }
    }

    /// A buffer of at least 16 bytes.
    pub(super) fn buffer(&self, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let size = bytes.max(16).next_multiple_of(16);
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// Waits for the work and hands over what a mappable buffer holds.
    pub(super) fn read<T>(
        &self,
        buffer: &wgpu::Buffer,
        bytes: u64,
        take: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuFailure> {
        if bytes == 0 {
            return Ok(take(&[]));
        }
        let (sender, receiver) = mpsc::channel();
        let slice = buffer.slice(0..bytes);
        slice.map_async(wgpu::MapMode::Read, move |result| {
            let _ = sender.send(result);
        });
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(Duration::from_secs(600)) };
        self.device.poll(wait).map_err(|e| GpuFailure(e.to_string()))?;
        let mapped = receiver.try_recv().map_err(|_| GpuFailure("the device gave no answer".to_owned()))?;
        mapped.map_err(|e| GpuFailure(e.to_string()))?;
        let view = slice.get_mapped_range().map_err(|e| GpuFailure(e.to_string()))?;
        let result = take(&view);
        drop(view);
        buffer.unmap();
        Ok(result)
    }
}

/// What wgpu says, which is several lines with a frame around the place in the shader, as one.
fn sentence(text: &str) -> String {
    let says_something = |line: &&str| line.starts_with(char::is_alphanumeric) && *line != "Caused by:";
    let lines = text.lines().map(str::trim).filter(says_something).take(4);
    lines.map(|line| line.trim_end_matches(':')).collect::<Vec<_>>().join(": ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::gpu::adapters;

    /// The first adapter, opened; by `KFGPU_TEST_GPU` as in tests/gpu.
    fn gpu() -> Option<Gpu> {
        let policy = std::env::var("KFGPU_TEST_GPU").unwrap_or_default();
        let found = if policy == "off" { None } else { adapters().into_iter().next() };
        assert!(found.is_some() || policy != "require", "KFGPU_TEST_GPU=require and there is no adapter");
        found.map(|adapter| Gpu::open(Some(&adapter.name), Precision::F32).unwrap())
    }

    #[test]
    fn what_the_driver_refuses_is_an_error_and_no_panic() {
        let Some(gpu) = gpu() else { return };
        let refused = gpu.guarded(|| {
            gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: None,
                source: wgpu::ShaderSource::Wgsl("@compute fn main() { let a = ; }".into()),
            })
        });
        let message = refused.err().unwrap().to_string();
        assert!(message.contains("expected expression") && !message.contains('\n'), "{message}");
        let huge = gpu.guarded(|| gpu.buffer("huge", 1 << 60, wgpu::BufferUsages::STORAGE));
        assert!(huge.is_err(), "larger than any limit");
        assert_eq!(gpu.guarded(|| 7), Ok(7), "nothing is left over for the work after it");
    }

    #[test]
    fn a_lost_device_hands_nothing_over() {
        let Some(gpu) = gpu() else { return };
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let before = gpu.guarded(|| gpu.buffer("read", 64, usage)).unwrap();
        assert_eq!(gpu.read(&before, 64, <[u8]>::len), Ok(64), "it works before");
        gpu.device.destroy();
        // Error scopes say nothing of a loss: whoever reads finds out.
        let after = gpu.guarded(|| gpu.buffer("read", 64, usage)).unwrap_or(before.clone());
        assert!(gpu.read(&before, 64, <[u8]>::len).is_err(), "a buffer from before");
        assert!(gpu.read(&after, 64, <[u8]>::len).is_err(), "and one from after");
    }
}
