//! Contact between objects: each object that has matter on the grid has a layer of it to itself, and where two
//! of them meet they exchange momentum (`shaders/solver/encounter.wgsl`). Up to [`MOST_LAYERS`] objects; of
//! more, some share a layer and stick where they touch.

use super::constants::{DEALT, MOST_LAYERS};
use super::core::{Params, Solver};
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

/// Which layer of the grid each object is on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layers {
    pub count: u32,
    /// By object, those beyond [`DEALT`] as the ones so many before them; none of what has no part in the grid.
    of: Vec<Option<u32>>,
    /// Bits of the layers that hold what clings to walls.
    wet: u32,
}

impl Layers {
    /// One for each object with matter on the grid. Rigid bodies, and liquids beside the grid, meet others without it.
    pub fn deal(settings: &Settings, states: &[ParticleState], substances: &[Substance]) -> Layers {
        let (mut on_grid, mut wet) = ([false; DEALT as usize], [false; DEALT as usize]);
        for state in states.iter().filter(|s| !s.is_rigid()) {
            let (object, substance) = ((state.object() % DEALT) as usize, substances.get(state.substance()));
            on_grid[object] |= !substance.is_some_and(Substance::is_sph);
            wet[object] |= substance.is_some_and(|s| s.clings_pa_s().is_some());
        }
        let objects = on_grid.iter().filter(|&&on| on).count() as u32;
        let count = if settings.glued { 1 } else { objects.clamp(1, MOST_LAYERS) };
        let mut next = 0;
        let of: Vec<Option<u32>> = on_grid
            .iter()
            .map(|&on| {
                next += u32::from(on);
                on.then(|| (next - 1) % count)
            })
            .collect();
        let wet = of.iter().zip(wet).filter(|(_, wet)| *wet).filter_map(|(layer, _)| *layer).fold(0, |bits, layer| bits | 1 << layer);
        Layers { count, of, wet }
    }

    /// Tells the passes.
    pub fn note(&self, params: &mut Params) {
        (params.layers, params.wet_layers, params.layer_of) = (self.count, self.wet, Default::default());
        for (object, layer) in self.of.iter().enumerate() {
            params.layer_of[object / 8] |= layer.unwrap_or(0) << (4 * (object % 8));
        }
    }

    /// Which one an object is on; none that there is, where it has no part in the grid.
    pub fn layer_of(&self, object: u32) -> u32 {
        self.of[(object % DEALT) as usize].unwrap_or(u32::MAX)
    }

    /// Of each layer: the largest Coulomb coefficient of its objects, and their volume, m^3.
    pub fn surfaces(&self, settings: &Settings, states: &[ParticleState], substances: &[Substance], object_count: u32) -> Vec<[f32; 2]> {
        // Of each object: volume, and volume times friction.
        let mut sums = vec![[0.0f64; 2]; object_count as usize];
        for state in states {
            let (volume, friction) = (f64::from(state.volume_m3), substances.get(state.substance()).map_or(0.0, Substance::friction));
            let [total, rough] = &mut sums[state.object() as usize];
            (*total, *rough) = (*total + volume, *rough + volume * f64::from(friction));
        }
        let of = |object: usize| settings.frictions.get(object).copied().unwrap_or((sums[object][1] / sums[object][0].max(1e-30)) as f32);
        let members = |layer: u32| (0..object_count as usize).filter(move |o| self.of[o % DEALT as usize] == Some(layer));
        (0..self.count).map(|layer| [members(layer).map(of).fold(0.0, f32::max), members(layer).map(|o| sums[o][0]).sum::<f64>() as f32]).collect()
    }
}

impl Solver {
    /// Takes note of what has a part in the grid, after that changed: what meets what there follows from it.
    pub(super) fn set_layers(&mut self, states: &[ParticleState]) -> Result<(), SolverError> {
        let layers = Layers::deal(&self.settings, states, &self.laws.substances);
        // What turns to water slips from then on.
        self.encounter = Encounter::new(&self.gpu, &self.settings, states, &self.laws.substances, self.object_count)?;
        layers.note(&mut self.params);
        self.layers = layers;
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
        let layers = Layers::deal(settings, states, substances);
        if layers.count == 1 {
            return Ok(None);
        }
        let surfaces = gpu.storage_from("solver.surfaces", &layers.surfaces(settings, states, substances, object_count))?;
        Ok(Some(Encounter { passes: EncounterPasses::new(gpu), surfaces }))
    }

    pub fn bind(&self, solver: &Solver, grid: &GridBuffers) -> wgpu::BindGroup {
        solver.gpu.bind(&self.passes.encounter, &[&solver.params_buffer, &grid.active_blocks, &self.surfaces, &grid.masses, &grid.velocity])
    }
}
