//! Functions of formulas on an adapter, ours and its own, so that their errors can be measured on the card at hand.

use super::device::Gpu;
use super::{AdapterError, AdapterInfo, BuildError, GpuError, GpuFailure};
use crate::filter::TraceError;
use crate::precision::Precision;
use crate::tape::wgsl::{Printer, functions, literal};
use crate::tape::{Function, Graph, Id, Leaf, Output, Tape};
use wgpu::BufferUsages as Usage;

/// An adapter that evaluates functions in f32.
#[derive(Debug)]
pub struct Functions {
    gpu: Gpu,
}

/// Values of a function, one for each pair of operands.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// As kernels compute them.
    pub ours: Vec<f32>,
    /// By the function of WGSL, which is the adapter's; none where there is no such.
    pub own: Option<Vec<f32>>,
}

/// What WGSL calls it.
const fn built_in(function: Function) -> Option<&'static str> {
    Some(match function {
        Function::Sqrt => "sqrt",
        Function::Exp => "exp",
        Function::Ln => "log",
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Tan => "tan",
        Function::Asin => "asin",
        Function::Acos => "acos",
        Function::Atan => "atan",
        Function::Atan2 => "atan2",
        Function::Tanh => "tanh",
        Function::Floor => "floor",
        Function::Round => "round",
        Function::Sign => "sign",
        Function::Abs => "abs",
        Function::Min => "min",
        Function::Max => "max",
        _ => return None,
    })
}

impl Functions {
    /// Opens an adapter by part of its name; `None` = the best real one.
    ///
    /// # Errors
    /// If there is none, or its driver refuses.
    pub fn open(adapter: Option<&str>) -> Result<Self, AdapterError> {
        Ok(Self { gpu: Gpu::open(adapter, Precision::F32)? })
    }

    /// What it is.
    #[must_use]
    pub const fn adapter(&self) -> &AdapterInfo {
        &self.gpu.info
    }

    /// Values of a function at pairs of operands (the second of which few use).
    ///
    /// # Errors
    /// If the adapter refuses the kernel, or fails.
    pub fn values(&self, function: Function, operands: &[[f32; 2]]) -> Result<Values, GpuError> {
        let arguments = function.arity();
        let call = |g: &mut Graph, leaves: [Id; 2]| g.call(function, &leaves[..arguments]);
        let own = built_in(function).map(|name| format!("{name}({})", ["a", "a, b"][arguments - 1]));
        self.compare(call, own, operands)
    }

    /// Values of a^b.
    ///
    /// # Errors
    /// As [`Self::values`].
    pub fn powers(&self, operands: &[[f32; 2]]) -> Result<Values, GpuError> {
        self.compare(|g, [a, b]| g.pow(a, b), Some("pow(a, b)".to_owned()), operands)
    }

    fn compare(
        &self,
        call: impl Fn(&mut Graph, [Id; 2]) -> Id,
        own: Option<String>,
        operands: &[[f32; 2]],
    ) -> Result<Values, GpuError> {
        let source = source(call, own.as_deref())?;
        let refused = |f: GpuFailure| GpuError::Refused { adapter: self.gpu.info.name.clone(), reason: f.0 };
        let pairs = self.run(&source, operands).map_err(refused)?;
        let part = |i: usize| pairs.iter().map(|pair| pair[i]).collect();
        Ok(Values { ours: part(0), own: own.map(|_| part(1)) })
    }

    fn run(&self, source: &str, operands: &[[f32; 2]]) -> Result<Vec<[f32; 2]>, GpuFailure> {
        let bytes: &[u8] = bytemuck::cast_slice(operands);
        let size = bytes.len() as u64;
        let staging = self.gpu.guarded(|| {
            let descriptor =
                wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(source.into()) };
            let module = self.gpu.device.create_shader_module(descriptor);
            let pipeline = self.gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("functions"),
                layout: None,
                module: &module,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            let input = self.gpu.buffer("operands", size, Usage::STORAGE | Usage::COPY_DST);
            let output = self.gpu.buffer("values", size, Usage::STORAGE | Usage::COPY_SRC);
            let staging = self.gpu.buffer("values, read back", size, Usage::MAP_READ | Usage::COPY_DST);
            self.gpu.queue.write_buffer(&input, 0, bytes);
            let entries = [&input, &output];
            let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
                .zip(entries)
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
                .collect();
            let layout = pipeline.get_bind_group_layout(0);
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
            let group = self.gpu.device.create_bind_group(&descriptor);
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(u32::try_from(operands.len().div_ceil(64)).unwrap_or(u32::MAX), 1, 1);
            }
            encoder.copy_buffer_to_buffer(&output, 0, &staging, 0, size);
            self.gpu.queue.submit([encoder.finish()]);
            staging
        })?;
        self.gpu.read(&staging, size, bytemuck::pod_collect_to_vec)
    }
}

/// A kernel that computes both.
fn source(call: impl Fn(&mut Graph, [Id; 2]) -> Id, own: Option<&str>) -> Result<String, GpuError> {
    let mut g = Graph::default();
    let leaves = [0, 1].map(|i| g.leaf(Leaf::Parameter(i)));
    let root = call(&mut g, leaves);
    let tape = Tape::new(&g, &leaves, &[Output { id: root, register: 2 }])
        .map_err(|e| BuildError::from(TraceError::from(e)))?;
    let scalars = tape.scalars.iter().map(|id| literal(g.value(*id).unwrap_or(f64::NAN), Precision::F32));
    let scalars: Vec<String> = scalars.collect::<Result<_, _>>()?;
    let registers = ["a", "b"].map(str::to_owned);
    let (step, names) = Printer { precision: Precision::F32, registers: &registers, scalars: &scalars }.print(&tape)?;
    let own = own.unwrap_or("0.0f");
    Ok(format!(
        "@group(0) @binding(0) var<storage, read> operands: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> values: array<vec2<f32>>;

{}{}
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
    if (id.x >= arrayLength(&operands)) {{
        return;
    }}
    let a = operands[id.x].x;
    let b = operands[id.x].y;
    {step}
    values[id.x] = vec2<f32>({}, {own});
}}
",
        include_str!("../../../shaders/lib/single.wgsl"),
        functions(&step),
        names[2]
    ))
}
