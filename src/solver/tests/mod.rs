//! Tests of the whole solver on a device, and of each kernel against its twin.

mod by_block;
mod change;
mod contact;
mod encounter;
mod fields;
pub(super) mod laws;
mod leave;
mod library;
mod liquid;
mod motion;
mod prestress;
mod shown;
mod sph;
mod trouble;
pub(super) mod twins;
mod validation;
mod volume;

use super::validate::block;
use super::{Particles, Settings, Solver};
use crate::gpu::Gpu;
use glam::Vec3;

pub(super) fn solver(settings: Settings, particles: &Particles) -> Solver {
    let gpu = Gpu::shared_for_tests().expect("a device");
    Solver::new(&gpu, settings, particles).expect("a solver")
}

pub(super) fn centre_m(solver: &Solver) -> Vec3 {
    let states = solver.states().expect("states");
    let mass: f32 = states.iter().map(|s| s.mass_kg).sum();
    states.iter().map(|s| s.position_m * s.mass_kg).sum::<Vec3>() / mass
}

#[test]
fn shaders_are_valid_and_bind_what_they_declare() {
    for source in super::kernels() {
        let module = naga::front::wgsl::parse_str(&source.wgsl()).unwrap_or_else(|e| panic!("{}: {e}", source.label));
        let bound = module.global_variables.iter().filter(|(_, v)| v.binding.is_some()).count();
        assert_eq!(bound, source.bindings.len(), "{}", source.label);
    }
}

/// Bytes of a structure of a kernel's WGSL.
pub(super) fn size_in_shader(label: &str, name: &str) -> usize {
    let source = super::kernels().into_iter().find(|k| k.label == label).expect("a kernel");
    let module = naga::front::wgsl::parse_str(&source.wgsl()).expect("valid WGSL");
    let (handle, _) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).expect("a struct");
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).expect("a layout");
    layouter[handle].size as usize
}

#[test]
fn host_structs_have_the_layout_of_the_shaders() {
    let size = size_in_shader;
    // With one entry of the map behind them, to the next multiple of 16 bytes.
    assert_eq!(size("solver.bin", "Params"), (size_of::<super::core::Params>() + 4).next_multiple_of(16));
    assert_eq!(size("solver.bin", "Control"), size_of::<super::watch::Control>());
    assert_eq!(size("solver.grid", "Collider"), size_of::<super::obstacles::ColliderRecord>());
    assert_eq!(size("solver.grid", "Pin"), size_of::<super::obstacles::PinRecord>());
    assert_eq!(size("solver.p2g", "Substep"), size_of::<super::advance::Substep>());
    assert_eq!(size("solver.kick", "Kick"), size_of::<super::core::Kick>());
    assert_eq!(size("solver.stress", "Substance"), size_of::<super::substance::SubstanceRecord>());
    assert_eq!(size("solver.fields", "Field"), size_of::<super::fields::FieldRecord>());
    assert_eq!(size("solver.prestress_control", "Search"), size_of::<super::prestress::Search>());
    assert_eq!(size("solver.sph_near", "Solve"), size_of::<super::sph::Solve>());
    assert_eq!(size("solver.rigid_touch", "Near"), size_of::<super::grid::Near>());
    assert_eq!(size("solver.rigid_touch", "Meeting"), size_of::<super::grid::Meeting>());
}
