//! A compiled kernel with its buffers: dispatches chunks, side by side where they fit, and reads totals back.

use super::clock::Clock;
use super::device::{Gpu, GpuFailure};
use super::layout::{Header, Layout, Round};
use super::totals::{Sums, Totals};
use super::upload::{self, word};
use super::{GpuError, GpuOptions, prologue, shader};
use crate::evaluate::{Evaluation, Population, Precision, Status, scored};
use crate::filter::Program;
use std::time::Duration;
use wgpu::{BufferUsages as Usage, Limits};

/// Invocations a workgroup, as in the shader.
const WORKGROUP: usize = 64;
/// Dispatches a submission: short enough for a driver's watchdog.
const DISPATCHES_A_SUBMISSION: usize = 16;

/// The compiled kernel of a program.
pub(super) struct Kernel {
    layout: Layout,
    precision: Precision,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroupLayout,
    record: wgpu::Buffer,
    /// Byte offset of each dispatch in `record`.
    offsets: Vec<u32>,
    /// An [`Entry`] with its starts for every chunk.
    entries: wgpu::Buffer,
    largest_part: usize,
    buffers: Option<Buffers>,
    clock: Option<Clock>,
}

/// Buffers for parts of up to `stride` candidates.
struct Buffers {
    stride: usize,
    headers: wgpu::Buffer,
    header_stride: usize,
    prologue: wgpu::Buffer,
    totals: wgpu::Buffer,
    staging: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Kernel {
    /// Assembles, validates and compiles the kernel, and uploads the record.
    pub(super) fn new(gpu: &Gpu, program: &Program, options: &GpuOptions, baseline: &[f64]) -> Result<Self, GpuError> {
        let layout = Layout::grouped(program, options.largest_group.unwrap_or(usize::MAX));
        Self::of(gpu, program, options, baseline, layout)
    }

    /// The kernel of a program that lies in memory like this.
    pub(super) fn of(
        gpu: &Gpu,
        program: &Program,
        options: &GpuOptions,
        baseline: &[f64],
        layout: Layout,
    ) -> Result<Self, GpuError> {
        let precision = program.precision();
        let source = shader::print(program, &layout)?;
        let (record_bytes, limit) =
            (upload::record_bytes(gpu, &layout), gpu.limits.max_buffer_size.min(u32::MAX.into()));
        if record_bytes > limit {
            return Err(GpuError::TooLong { bytes: record_bytes, limit });
        }
        let largest_part = largest_part(gpu, program, &layout, options)?;
        let refused = |f: GpuFailure| GpuError::Refused { adapter: gpu.info.name.clone(), reason: f.0 };
        let (pipeline, bindings) = gpu.guarded(|| compile(gpu, source)).map_err(refused)?;
        let (record, offsets) = gpu.guarded(|| upload::record(gpu, program, &layout)).map_err(refused)?;
        let entries = gpu.guarded(|| upload::entries(gpu, program, &layout, baseline)).map_err(refused)?;
        let clock = (options.timed && gpu.info.timestamps).then(|| Clock::new(gpu));
        Ok(Self { largest_part, entries, layout, precision, pipeline, bindings, record, offsets, buffers: None, clock })
    }

    /// Scores a population in parts that fit the adapter.
    pub(super) fn evaluate(
        &mut self,
        gpu: &Gpu,
        program: &Program,
        population: &Population,
    ) -> Result<(Evaluation, Option<Duration>), GpuFailure> {
        let values = population.values();
        let d = program.parameters().max(1);
        let mut parts = Vec::new();
        let mut time = self.clock.as_ref().map(|_| Duration::ZERO);
        for part in values.chunks(self.largest_part * d) {
            let n = part.len() / d;
            self.prepare(gpu, program, n)?;
            let Some(buffers) = &self.buffers else { continue };
            let mut sums = Sums::new(program, &self.layout, n);
            for round in &self.layout.rounds {
                gpu.guarded(|| self.dispatch(gpu, program, round, buffers, part))?;
                let bytes = self.totals_bytes(round.chunks.len() * self.layout.totals_a_chunk, buffers.stride);
                gpu.read(&buffers.staging, bytes, |bytes| {
                    sums.add(round, &Totals { bytes, stride: buffers.stride, precision: self.precision });
                })?;
                if let (Some(time), Some(clock)) = (&mut time, &self.clock) {
                    *time += clock.read(gpu)?;
                }
            }
            let (costs, mut status) = sums.finish();
            for i in program.positivity().refused(part) {
                status[i] = status[i].union(Status::NOT_POSITIVE);
            }
            parts.push((costs, status));
        }
        Ok((scored(program, parts), time))
    }

    /// What the kernel of a [traced](Layout::traced) layout stores of one candidate: what is carried into the last row, then the
    /// values of its step.
    pub(super) fn trace(&mut self, gpu: &Gpu, program: &Program, candidate: &[f64]) -> Result<Vec<f64>, GpuFailure> {
        self.prepare(gpu, program, 1)?;
        let mut traced = Vec::new();
        for (round, buffers) in self.layout.rounds.iter().zip(self.buffers.iter().cycle()) {
            gpu.guarded(|| self.dispatch(gpu, program, round, buffers, candidate))?;
            let first = round.chunks.len() * self.layout.totals_a_chunk;
            let bytes = self.totals_bytes(first + self.layout.traced, buffers.stride);
            gpu.read(&buffers.staging, bytes, |bytes| {
                let totals = Totals { bytes, stride: buffers.stride, precision: self.precision };
                traced = (0..self.layout.traced).map(|row| totals.at(first + row, 0)).collect();
            })?;
        }
        Ok(traced)
    }

    fn totals_bytes(&self, rows: usize, stride: usize) -> u64 {
        (rows * stride * size(self.precision)) as u64
    }

    /// Makes buffers for `n` candidates unless those at hand fit.
    fn prepare(&mut self, gpu: &Gpu, program: &Program, n: usize) -> Result<(), GpuFailure> {
        let stride = n.next_multiple_of(WORKGROUP);
        if self.buffers.as_ref().is_some_and(|b| b.stride == stride) {
            return Ok(());
        }
        self.buffers = None;
        self.buffers = Some(gpu.guarded(|| self.make_buffers(gpu, program, stride))?);
        Ok(())
    }

    fn make_buffers(&self, gpu: &Gpu, program: &Program, stride: usize) -> Buffers {
        let row = (stride * size(self.precision)) as u64;
        let alignment = gpu.limits.min_uniform_buffer_offset_alignment.max(16) as usize;
        let header_stride = size_of::<Header>().next_multiple_of(alignment);
        let headers_bytes = (header_stride * self.layout.dispatches.len()) as u64;
        let headers = gpu.buffer("headers", headers_bytes, Usage::UNIFORM | Usage::COPY_DST);
        let rows = prologue::rows(program, &self.layout) as u64;
        let prologue = gpu.buffer("prologue", rows * row, Usage::STORAGE | Usage::COPY_DST);
        let carried = gpu.buffer("carried", program.carried().len() as u64 * row, Usage::STORAGE);
        let bytes = self.totals_bytes(self.layout.totals_rows(), stride);
        let totals = gpu.buffer("totals", bytes, Usage::STORAGE | Usage::COPY_SRC);
        let staging = gpu.buffer("totals, read back", bytes, Usage::MAP_READ | Usage::COPY_DST);
        let window = |buffer, size: usize| {
            let size = std::num::NonZeroU64::new(size as u64);
            wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
        };
        let resources = [
            window(&self.record, 16 * Layout::RECORD),
            window(&headers, size_of::<Header>()),
            prologue.as_entire_binding(),
            carried.as_entire_binding(),
            totals.as_entire_binding(),
            self.entries.as_entire_binding(),
        ];
        let entries: Vec<wgpu::BindGroupEntry<'_>> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &self.bindings, entries: &entries };
        let group = gpu.device.create_bind_group(&descriptor);
        Buffers { stride, headers, header_stride, prologue, totals, staging, group }
    }

    /// Uploads a part, runs every dispatch of a round over it and copies the totals out.
    fn dispatch(&self, gpu: &Gpu, program: &Program, round: &Round, buffers: &Buffers, part: &[f64]) {
        let n = part.len() / program.parameters().max(1);
        if round.dispatches.start == 0 {
            gpu.queue.write_buffer(&buffers.headers, 0, &self.headers(buffers, n));
        }
        if round.dispatches.start == 0 || self.layout.varying > 0 {
            prologue::with_buffer(program, round, part, buffers.stride, |bytes| {
                gpu.queue.write_buffer(&buffers.prologue, 0, bytes);
            });
        }
        let rows = round.chunks.len() * self.layout.totals_a_chunk + self.layout.traced;
        let dispatches: Vec<usize> = round.dispatches.clone().collect();
        let submissions = dispatches.chunks(DISPATCHES_A_SUBMISSION);
        let last = submissions.len().saturating_sub(1);
        for (s, dispatches) in submissions.enumerate() {
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let timestamps = self.clock.as_ref().and_then(|clock| clock.writes(s == 0, s == last));
            let descriptor = wgpu::ComputePassDescriptor { label: None, timestamp_writes: timestamps };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            pass.set_pipeline(&self.pipeline);
            for &dispatch in dispatches {
                let trajectories = self.layout.dispatches[dispatch].len();
                pass.set_bind_group(
                    0,
                    &buffers.group,
                    &[self.offsets[dispatch], word(dispatch * buffers.header_stride)],
                );
                pass.dispatch_workgroups(word(n.div_ceil(WORKGROUP)), word(trajectories), 1);
            }
            drop(pass);
            if s == last {
                encoder.copy_buffer_to_buffer(
                    &buffers.totals,
                    0,
                    &buffers.staging,
                    0,
                    self.totals_bytes(rows, buffers.stride),
                );
                if let Some(clock) = &self.clock {
                    clock.resolve(&mut encoder);
                }
            }
            gpu.queue.submit([encoder.finish()]);
        }
    }

    /// The header of every dispatch, each at its offset.
    fn headers(&self, buffers: &Buffers, n: usize) -> Vec<u8> {
        let mut data = vec![0; buffers.header_stride * self.layout.dispatches.len()];
        for (dispatch, slot) in self.layout.dispatches.iter().zip(data.chunks_mut(buffers.header_stride)) {
            let (candidates, stride) = (word(n), word(buffers.stride));
            let header = Header { candidates, stride, chunk: word(dispatch.start), reserved: 0 };
            slot[..size_of::<Header>()].copy_from_slice(bytemuck::bytes_of(&header));
        }
        data
    }

    /// Dispatches that score one part of a population.
    pub(super) const fn dispatches(&self) -> usize {
        self.layout.dispatches.len()
    }
}

const fn size(precision: Precision) -> usize {
    match precision {
        Precision::F32 => 4,
        Precision::F64 => 8,
    }
}

/// Bytes of one part's largest buffer: more would not be faster, and every part also takes memory on the host.
const LARGEST_BUFFER: u64 = 512 << 20;

/// Candidates that one part may have: by storage bindings, buffers and the number of workgroups.
fn largest_part(gpu: &Gpu, program: &Program, layout: &Layout, options: &GpuOptions) -> Result<usize, GpuError> {
    let rows = prologue::rows(program, layout).max(program.carried().len()).max(layout.totals_rows());
    let Limits { max_buffer_size, max_storage_buffer_binding_size, .. } = gpu.limits;
    let limit = max_buffer_size.min(max_storage_buffer_binding_size);
    let entries = (layout.entry_bytes() * layout.chunks.len()) as u64;
    if entries > limit {
        return Err(GpuError::TooLong { bytes: entries, limit });
    }
    let candidate = (rows.max(1) * size(options.precision)) as u64;
    let by_memory = usize::try_from(limit.min(LARGEST_BUFFER) / candidate).unwrap_or(usize::MAX);
    if by_memory < WORKGROUP {
        return Err(GpuError::TooLong { bytes: WORKGROUP as u64 * candidate, limit });
    }
    let by_groups = (gpu.limits.max_compute_workgroups_per_dimension as usize).saturating_mul(WORKGROUP);
    let part = by_memory.min(by_groups).min(options.largest_part.unwrap_or(usize::MAX));
    Ok((part / WORKGROUP * WORKGROUP).max(WORKGROUP))
}

fn compile(gpu: &Gpu, source: String) -> (wgpu::ComputePipeline, wgpu::BindGroupLayout) {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("filter"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let uniform = |size: usize| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: true,
        min_binding_size: std::num::NonZeroU64::new(size as u64),
    };
    let storage = |read_only| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let types = [
        uniform(16 * Layout::RECORD),
        uniform(size_of::<Header>()),
        storage(true),
        storage(false),
        storage(false),
        storage(true),
    ];
    let visibility = wgpu::ShaderStages::COMPUTE;
    let entries: Vec<wgpu::BindGroupLayoutEntry> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
        .collect();
    let bindings =
        gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&bindings)],
        immediate_size: 0,
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("filter"),
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    (pipeline, bindings)
}
