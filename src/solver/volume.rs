//! Solids near incompressibility: at each sort what they gained in volume is evened over each cell, so that
//! they bend and bulge as freely as they should (`shaders/solver/volume.wgsl`). Others pay nothing.

use super::constants::EVEN_FROM;
use super::core::Solver;
use super::grid::GridBuffers;
use super::state::{ParticleState, StateBuffers};
use crate::gpu::Recording;

passes! {
    /// Compiled where anything is that stiff against a change of its volume.
    VolumePasses;
    volume_sum: ["substance", "material", "particle", "volume", "volume_sum"] [Read, Read, Read, Read, Write] 0;
    volume_even: ["substance", "material", "particle", "volume", "volume_even"] [Read, Read, Write, Read, Read] 0;
}

/// Their bind groups over one of the two state buffers.
pub(super) struct VolumeBound {
    sum: wgpu::BindGroup,
    even: wgpu::BindGroup,
    gains: wgpu::Buffer,
}

impl Solver {
    /// Makes the passes where some particle needs them, and drops them where none does any more.
    pub(super) fn watch_volumes(&mut self, states: &[ParticleState]) {
        let evened = |s: &ParticleState| {
            let keeps = self.laws.substances.get(s.substance()).is_some_and(|law| law.remembers_volume());
            keeps && !s.is_rigid() && s.mu_pa > 0.0 && s.lambda_pa > EVEN_FROM * s.mu_pa
        };
        let asked = states.iter().any(evened);
        if asked != self.volume.is_some() {
            self.volume = asked.then(|| VolumePasses::new(&self.gpu));
            // The next one has room for what is asked for now.
            (self.grid, self.window) = (None, None);
        }
    }

    pub(super) fn bind_volume(&self, grid: &GridBuffers, state: &StateBuffers) -> Option<VolumeBound> {
        let (p, gains) = (self.volume.as_ref()?, grid.gains.as_ref()?);
        let of = |kernel| self.gpu.bind(kernel, &[&self.params_buffer, &state.kinematics, &state.matter, &self.laws.table, gains]);
        Some(VolumeBound { sum: of(&p.volume_sum), even: of(&p.volume_even), gains: gains.clone() })
    }

    /// Adds what follows a sort.
    pub(super) fn record_volume(&self, b: &VolumeBound, recording: &mut Recording) {
        let Some(p) = &self.volume else { return };
        recording.clear(&b.gains);
        recording.dispatch(&p.volume_sum, &b.sum, self.particle_groups());
        recording.dispatch(&p.volume_even, &b.even, self.particle_groups());
    }
}
