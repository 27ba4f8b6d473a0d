//! Contact between objects: each object has a layer of the grid to itself, and where two of them meet
//! they exchange momentum (`shaders/solver/encounter.wgsl`). Up to [`MOST_LAYERS`] objects; of more, some
//! share a layer and stick where they touch.

use super::constants::MOST_LAYERS;
use super::core::Solver;
use super::grid::GridBuffers;
use super::passes::SUBSTEP;
use super::state::ParticleState;
use super::substance::Substance;
use super::types::{Settings, SolverError};
use crate::gpu::Gpu;

passes! {
    /// The pass between objects, compiled where a scene has several.
    EncounterPasses;
    encounter: ["substep", "node", "encounter"] [Read, Read, Read, Read, Write] SUBSTEP;
}

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
pub(super) fn surfaces(settings: &Settings, states: &[ParticleState], substances: &[Substance], object_count: u32) -> Vec<[f32; 2]> {
    let layers = layers(settings, states, object_count) as usize;
    // Of each object: volume, and volume times friction.
    let mut sums = vec![[0.0f64; 2]; object_count as usize];
    for state in states {
        let (volume, friction) = (f64::from(state.volume_m3), substances.get(state.substance()).map_or(0.0, Substance::friction));
        let [total, rough] = &mut sums[state.object() as usize];
        (*total, *rough) = (*total + volume, *rough + volume * f64::from(friction));
    }
    let of = |object: usize| settings.frictions.get(object).copied().unwrap_or((sums[object][1] / sums[object][0].max(1e-30)) as f32);
    let members = |layer: usize| (layer..object_count as usize).step_by(layers);
    (0..layers).map(|layer| [members(layer).map(of).fold(0.0, f32::max), members(layer).map(|o| sums[o][0]).sum::<f64>() as f32]).collect()
}

impl Solver {
    /// Takes note of which objects are soft, after that changed: what meets what on the grid follows from it.
    pub(super) fn set_layers(&mut self, states: &[ParticleState]) -> Result<(), SolverError> {
        let layers = layers(&self.settings, states, self.object_count);
        if layers != self.params.layers {
            self.encounter = Encounter::new(&self.gpu, &self.settings, states, &self.laws.substances, self.object_count)?;
            self.params.layers = layers;
        } else if let Some(encounter) = &self.encounter {
            // What turns to water slips from then on.
            self.gpu.upload(&encounter.surfaces, &surfaces(&self.settings, states, &self.laws.substances, self.object_count));
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
    pub fn new(
        gpu: &Gpu,
        settings: &Settings,
        states: &[ParticleState],
        substances: &[Substance],
        object_count: u32,
    ) -> Result<Option<Encounter>, SolverError> {
        if layers(settings, states, object_count) == 1 {
            return Ok(None);
        }
        let surfaces = gpu.storage_from("solver.surfaces", &surfaces(settings, states, substances, object_count))?;
        Ok(Some(Encounter { passes: EncounterPasses::new(gpu), surfaces }))
    }

    pub fn bind(&self, solver: &Solver, grid: &GridBuffers) -> wgpu::BindGroup {
        solver.gpu.bind(&self.passes.encounter, &[&solver.params_buffer, &grid.active_blocks, &self.surfaces, &grid.masses, &grid.velocity])
    }
}
