//! One compute pass: its WGSL, its constants, what it binds.

use super::Gpu;
use std::fmt::Write;

/// How a pass uses one of its bindings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// `var<storage, read>`
    Read,
    /// `var<storage, read_write>`
    Write,
}

/// A constant that reaches WGSL from Rust, where it is documented.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Constant {
    /// `u32`
    U32(u32),
    /// `i32`
    I32(i32),
    /// `f32`
    F32(f32),
    /// `bool`
    Bool(bool),
}

/// A pass before it is compiled. `parts` are (path under `shaders/`, text) pairs, joined in order
/// after the constants; bindings are `@group(0) @binding(i)` in the order of `bindings`.
#[derive(Clone, Debug)]
pub struct KernelSource {
    /// What timing and error messages call the pass: "room.pass".
    pub label: &'static str,
    /// Name of the entry point.
    pub entry: &'static str,
    /// Shared snippets first, the pass itself last.
    pub parts: Vec<(&'static str, &'static str)>,
    /// Written before the parts as WGSL `const` items.
    pub constants: Vec<(&'static str, Constant)>,
    /// Binding i of group 0.
    pub bindings: Vec<Access>,
    /// Bytes of `var<immediate>`, at most 128.
    pub immediate_bytes: u32,
}

impl KernelSource {
    /// The whole WGSL text that the device compiles.
    pub fn wgsl(&self) -> String {
        let mut text = String::new();
        for (name, value) in &self.constants {
            // Writing to a String cannot fail.
            let _ = match value {
                Constant::U32(v) => writeln!(text, "const {name}: u32 = {v}u;"),
                Constant::I32(v) => writeln!(text, "const {name}: i32 = i32({v});"),
                Constant::F32(v) => writeln!(text, "const {name}: f32 = f32({v:?});"),
                Constant::Bool(v) => writeln!(text, "const {name}: bool = {v};"),
            };
        }
        for (path, part) in &self.parts {
            let _ = writeln!(text, "// ---- {path}");
            text.push_str(part);
            text.push('\n');
        }
        text
    }
}

/// A compiled pass.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// What timing and error messages call the pass.
    pub label: &'static str,
    /// The pipeline itself.
    pub pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl Gpu {
    /// Compiles a pass. Shader text is ours alone and is validated by the tests, so this cannot fail
    /// for any input of a user.
    pub fn kernel(&self, source: &KernelSource) -> Kernel {
        self.kernel_with(source, "")
    }

    /// As [`Gpu::kernel`], with further functions that were written by the program.
    pub fn kernel_with(&self, source: &KernelSource, functions: &str) -> Kernel {
        let text = source.wgsl() + functions;
        let module = self
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(source.label), source: wgpu::ShaderSource::Wgsl(text.into()) });
        let entries: Vec<_> = source.bindings.iter().enumerate().map(|(i, access)| layout_entry(i as u32, *access)).collect();
        let layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(source.label), entries: &entries });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(source.label),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: source.immediate_bytes,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(source.label),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(source.entry),
            compilation_options: Default::default(),
            cache: None,
        });
        Kernel { label: source.label, pipeline, layout }
    }

    /// Binds whole buffers, in the order of the source's `bindings`.
    pub fn bind(&self, kernel: &Kernel, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> =
            buffers.iter().enumerate().map(|(i, b)| wgpu::BindGroupEntry { binding: i as u32, resource: b.as_entire_binding() }).collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(kernel.label), layout: &kernel.layout, entries: &entries })
    }
}

fn layout_entry(binding: u32, access: Access) -> wgpu::BindGroupLayoutEntry {
    let ty = match access {
        Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
        Access::Write => wgpu::BufferBindingType::Storage { read_only: false },
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
