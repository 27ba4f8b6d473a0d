//! Every pass of every room parses and validates, and is in the list that its room gives out.

#![allow(clippy::unwrap_used, reason = "a test reads its own sources")]

use naga::valid::{Capabilities, ValidationFlags, Validator};
use phystalk::gpu::KernelSource;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn all() -> Vec<KernelSource> {
    [phystalk::gpu::kernels(), phystalk::solver::kernels(), phystalk::skin::kernels(), phystalk::render::kernels()].concat()
}

#[test]
fn every_kernel_validates() {
    for kernel in all() {
        let text = kernel.wgsl();
        let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}: {}", kernel.label, e.emit_to_string(&text)));
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
        validator.validate(&module).unwrap_or_else(|e| panic!("{}: {}", kernel.label, e.emit_to_string(&text)));
        assert!(module.entry_points.iter().any(|e| e.name == kernel.entry), "{} has no entry point {}", kernel.label, kernel.entry);
    }
}

#[test]
fn bindings_of_every_kernel_are_those_that_rust_declares() {
    for kernel in all() {
        let text = kernel.wgsl();
        let module = naga::front::wgsl::parse_str(&text).unwrap();
        for (_, variable) in module.global_variables.iter() {
            if let Some(binding) = &variable.binding {
                let known = (binding.binding as usize) < kernel.bindings.len();
                assert!(binding.group == 0 && known, "{}: binding {} is not declared in Rust", kernel.label, binding.binding);
            }
            if variable.space == naga::AddressSpace::Immediate {
                let size = module.types[variable.ty].inner.size(module.to_ctx());
                assert!(size <= kernel.immediate_bytes, "{}: immediates of {size} bytes, {} declared", kernel.label, kernel.immediate_bytes);
            }
        }
    }
}

#[test]
fn every_shader_file_is_part_of_a_kernel() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut files = Vec::new();
    wgsl_files(&root, &mut files);
    let used: BTreeSet<String> = all().iter().flat_map(|k| k.parts.iter().map(|(path, _)| (*path).to_owned())).collect();
    for file in files {
        let name = file.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
        assert!(used.contains(&name), "shaders/{name} is in no kernel's parts");
    }
}

fn wgsl_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            wgsl_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "wgsl") {
            out.push(path);
        }
    }
}
