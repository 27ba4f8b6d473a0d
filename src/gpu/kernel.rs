//! One compute pass: its WGSL, its constants, what it binds.

use super::Gpu;
use rayon::prelude::*;
use std::collections::HashMap;
use std::fmt::Write;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

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

/// Passes that are kept compiled. Those that a program writes differ from scene to scene, so there may be ever more.
const KEPT: usize = 512;

/// The passes that a device has compiled, by what they were compiled from.
#[derive(Debug, Default)]
pub(super) struct Compiled(Mutex<HashMap<blake3::Hash, Arc<OnceLock<Kernel>>>>);

impl Compiled {
    /// The place of one pass: whoever comes first compiles it, others wait for that one alone.
    fn place(&self, key: blake3::Hash) -> Arc<OnceLock<Kernel>> {
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if places.len() >= KEPT && !places.contains_key(&key) {
            places.clear();
        }
        places.entry(key).or_default().clone()
    }
}

/// Everything that a pipeline is made of.
fn key(source: &KernelSource, text: &str) -> blake3::Hash {
    let mut hash = blake3::Hasher::new();
    for part in [source.label, source.entry, text] {
        hash.update(&(part.len() as u64).to_le_bytes()).update(part.as_bytes());
    }
    let writes: Vec<u8> = source.bindings.iter().map(|access| u8::from(*access == Access::Write)).collect();
    hash.update(&source.immediate_bytes.to_le_bytes()).update(&writes);
    hash.finalize()
}

impl Gpu {
    /// Compiles a pass, once for each device. Shader text is ours alone and is validated by the tests, so this cannot
    /// fail for any input of a user.
    pub fn kernel(&self, source: &KernelSource) -> Kernel {
        self.kernel_with(source, "")
    }

    /// As [`Gpu::kernel`], with further functions that were written by the program.
    pub fn kernel_with(&self, source: &KernelSource, functions: &str) -> Kernel {
        let text = source.wgsl() + functions;
        let place = self.compiled.place(key(source, &text));
        place.get_or_init(|| self.compile(source, text)).clone()
    }

    /// Compiles passes side by side, so that those who ask for one later need not wait.
    pub fn prepare(&self, sources: &[KernelSource]) {
        sources.par_iter().for_each(|source| drop(self.kernel(source)));
    }

    fn compile(&self, source: &KernelSource, text: String) -> Kernel {
        let module = self.module(wgpu::ShaderModuleDescriptor { label: Some(source.label), source: wgpu::ShaderSource::Wgsl(text.into()) });
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

    /// A GPU is not made to count the rounds of each loop, nor, where it guards its buffers itself, to look at each index once
    /// more: a tenth of the time of passes that work in workgroup memory.
    #[allow(unsafe_code)]
    fn module(&self, text: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
        if self.info.device_type == wgpu::DeviceType::Cpu {
            return self.device.create_shader_module(text);
        }
        let mut checks = wgpu::ShaderRuntimeChecks::checked();
        checks.force_loop_bounding = false;
        checks.bounds_checks = self.info.backend != wgpu::Backend::Vulkan;
        // SAFETY: no text but ours is compiled (what expressions add is written from a tree, without loops or indices). Every loop
        // counts to a bound or empties a word of bits. Vulkan bounds what lies in buffers (robust access, which wgpu asks for);
        // indices into workgroup memory are lanes, masked digits, numbers of bodies, or places that were compared with
        // the tile. The tests run the same passes with all checks, against their twins.
        unsafe { self.device.create_shader_module_trusted(text, checks) }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_is_compiled_once_and_every_difference_counts() {
        let gpu = Gpu::shared_for_tests().unwrap();
        let gpu = Gpu { compiled: Arc::default(), ..gpu };
        let source = KernelSource {
            label: "test.kept",
            entry: "main",
            parts: vec![(
                "kept.wgsl",
                "@group(0) @binding(0) var<storage, read_write> a: array<u32>;\n@compute @workgroup_size(1) fn main() { a[0] = ONE; }",
            )],
            constants: vec![("ONE", Constant::U32(1))],
            bindings: vec![Access::Write],
            immediate_bytes: 0,
        };
        let kept = || gpu.compiled.0.lock().unwrap().len();
        let first = gpu.kernel(&source);
        gpu.prepare(&[source.clone(), source.clone()]);
        assert_eq!((first.pipeline, kept()), (gpu.clone().kernel(&source).pipeline, 1));
        gpu.kernel(&KernelSource { constants: vec![("ONE", Constant::U32(2))], ..source.clone() });
        gpu.kernel(&KernelSource { label: "test.other", ..source.clone() });
        gpu.kernel_with(&source, "fn two() -> u32 { return 2u; }");
        assert_eq!(kept(), 4);
    }
}
