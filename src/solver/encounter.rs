//! Contact between objects: each object has a layer of the grid to itself, and where two of them meet
//! they exchange momentum (`shaders/solver/encounter.wgsl`). Up to [`MOST_LAYERS`] objects; of more, some
//! share a layer and stick where they touch.

use super::constants::MOST_LAYERS;
use super::core::Solver;
use super::grid::GridBuffers;
use super::passes::SUBSTEP;
use super::state::ParticleState;
use super::types::{Settings, SolverError};
use crate::gpu::Gpu;

passes! {
    /// The pass between objects, compiled where a scene has several.
    EncounterPasses;
    encounter: ["substep", "node", "encounter"] [Read, Read, Read, Read, Write] SUBSTEP;
}

/// Coulomb coefficient between objects where the settings name none.
const FRICTION: f32 = 0.3;

/// What a scene of several objects has beside others.
#[derive(Debug)]
pub(super) struct Encounter {
    pub passes: EncounterPasses,
    surfaces: wgpu::Buffer,
}

/// Layers of the grid: one for each object, where several have soft matter. Rigid bodies meet others without it.
pub(super) fn layers(settings: &Settings, states: &[ParticleState], object_count: u32) -> u32 {
    let mut soft = states.iter().filter(|s| !s.is_rigid()).map(ParticleState::object);
    let first = soft.next();
    let several = soft.any(|object| Some(object) != first);
    if settings.glued || !several { 1 } else { object_count.clamp(1, MOST_LAYERS) }
}

/// Of each layer: the largest Coulomb coefficient of its objects, and their volume, m^3.
pub(super) fn surfaces(settings: &Settings, states: &[ParticleState], object_count: u32) -> Vec<[f32; 2]> {
    let layers = layers(settings, states, object_count) as usize;
    let mut volume_m3 = vec![0.0f64; layers];
    states.iter().for_each(|s| volume_m3[s.object() as usize % layers] += f64::from(s.volume_m3));
    let of = |object: usize| settings.frictions.get(object).copied().unwrap_or(FRICTION);
    let largest = |layer: usize| (layer..object_count as usize).step_by(layers).map(of).fold(0.0, f32::max);
    volume_m3.iter().enumerate().map(|(layer, &volume)| [largest(layer), volume as f32]).collect()
}

impl Solver {
    /// Takes note of which objects are soft, after that changed: what meets what on the grid follows from it.
    pub(super) fn set_layers(&mut self, states: &[ParticleState]) -> Result<(), SolverError> {
        let layers = layers(&self.settings, states, self.object_count);
        if layers != self.params.layers {
            self.encounter = Encounter::new(&self.gpu, &self.settings, states, self.object_count)?;
            self.params.layers = layers;
        }
        self.soft = states.iter().any(|s| !s.is_rigid());
        if self.grid.as_ref().is_some_and(|g| g.kind != self.grid_kind()) {
            // The next one has what is asked for now.
            (self.grid, self.window) = (None, None);
        }
        Ok(())
    }
}

impl Encounter {
    /// None where there is one layer.
    pub fn new(gpu: &Gpu, settings: &Settings, states: &[ParticleState], object_count: u32) -> Result<Option<Encounter>, SolverError> {
        if layers(settings, states, object_count) == 1 {
            return Ok(None);
        }
        let surfaces = gpu.storage_from("solver.surfaces", &surfaces(settings, states, object_count))?;
        Ok(Some(Encounter { passes: EncounterPasses::new(gpu), surfaces }))
    }

    pub fn bind(&self, solver: &Solver, grid: &GridBuffers) -> wgpu::BindGroup {
        solver.gpu.bind(&self.passes.encounter, &[&solver.params_buffer, &grid.active_blocks, &self.surfaces, &grid.masses, &grid.velocity])
    }
}
