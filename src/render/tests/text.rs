//! The shaders' text: valid, within portable limits, and laid out as Rust believes.

use crate::render::uniform::Uniform;
use crate::render::{kernels, shader_text};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::mem::offset_of;

#[test]
fn every_kernel_is_valid_and_portable() {
    for source in kernels() {
        let module = naga::front::wgsl::parse_str(&source.wgsl()).unwrap_or_else(|e| panic!("{}: {e}", source.label));
        let capabilities = Capabilities::SUBGROUP | Capabilities::IMMEDIATES;
        Validator::new(ValidationFlags::all(), capabilities)
            .subgroup_stages(naga::valid::ShaderStages::COMPUTE)
            .subgroup_operations(naga::valid::SubgroupOperationSet::all())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {e:?}", source.label));
        let storage = module.global_variables.iter().filter(|(_, v)| matches!(v.space, naga::AddressSpace::Storage { .. })).count();
        assert!(storage <= 8, "{} binds {storage} storage buffers", source.label);
    }
}

#[test]
fn the_frame_is_laid_out_as_in_the_shader() {
    let source = kernels().into_iter().find(|k| k.label == "render.project").unwrap();
    let module = naga::front::wgsl::parse_str(&source.wgsl()).unwrap();
    let (_, frame) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Frame")).unwrap();
    let naga::TypeInner::Struct { members, span } = &frame.inner else { panic!("Frame is a struct") };
    assert_eq!(*span as usize, size_of::<Uniform>());
    let at = |name: &str| members.iter().find(|m| m.name.as_deref() == Some(name)).unwrap().offset as usize;
    macro_rules! same { ($($field:ident)*) => { $(assert_eq!(at(stringify!($field)), offset_of!(Uniform, $field));)* } }
    same!(camera eye near focal centre tangent_low tangent_high background dilation size bins bin_shift count sh_degree capacity
        compensation_floor opacity_cap sigmas stop alpha_min_log2 alpha_min shaded colour_at depth_at id_at ground_m pad pool);
    assert_eq!(members.len(), 28, "no member without a field");
}

#[test]
fn cache_keys_see_every_shader() {
    let text = shader_text();
    for name in ["frame", "splat", "reach", "sh", "project", "compact", "gather", "emit", "ranges", "pixel", "raster", "raster_serial"] {
        assert!(text.contains(&format!("render/{name}.wgsl")), "{name}");
    }
}
