//! What liquids need beside their law: their density, and their surface tension, on the grid. Every few
//! substeps they are poured onto the nodes; J is brought back to the density found there, and the pull of
//! the surface is worked out that the grid's pass applies until the next sort.
//!
//! Pastes are poured too: they cling to walls as liquids do, and yield inside.

use super::advance::Substep;
use super::budget;
use super::constants::{FILL_UNITS, WALL_GRIP, WALL_SOON_S};
use super::core::Solver;
use super::grid::GridBuffers;
use super::passes::SUBSTEP;
use super::state::{ParticleState, StateBuffers};
use super::substance::{self, Substance};
use super::types::SolverError;
use crate::gpu::{Gpu, Recording};

passes! {
    /// Passes that only scenes with something wet have; `grid_wet` takes the place of `grid`.
    LiquidPasses;
    grid_wet: ["control", "substep", "contact", "node", "pin", "grid_wet", "grid"] [Read, Read, Read, Read, Write, Write, Write, Write, Write, Read, Read] SUBSTEP;
    liquid_wall: ["contact", "node", "wall", "liquid_wall"] [Read, Read, Read, Write] 0;
    liquid_fill: ["substance", "particle", "liquid_fill"] [Read, Read, Read, Read, Write] 0;
    liquid_share: ["contact", "node", "room", "liquid_share"] [Read, Read, Read, Write, Write, Write] 0;
    liquid_film: ["contact", "node", "wall", "room", "liquid_film"] [Read, Read, Read, Read, Write] 0;
    liquid_density: ["substep", "substance", "material", "particle", "cube_root", "liquid_density"] [Read, Read, Write, Read, Read] SUBSTEP;
    liquid_slope: ["node", "liquid_slope"] [Read, Read, Read, Write] 0;
    liquid_tension: ["node", "liquid_tension"] [Read, Read, Read, Read, Write] 0;
}

/// Fields of the liquids over the grid's nodes; `shaders/solver/liquid_*.wgsl` say what they hold.
#[derive(Clone, Debug)]
pub(super) struct LiquidFields {
    pub fill: wgpu::Buffer,
    pub share: wgpu::Buffer,
    pub slopes: wgpu::Buffer,
    pub pull: wgpu::Buffer,
    pub film: wgpu::Buffer,
}

impl LiquidFields {
    /// Bytes of all of them for one node.
    pub const NODE_BYTES: u64 = 68;

    pub fn new(gpu: &Gpu, nodes: usize) -> Result<LiquidFields, SolverError> {
        Ok(LiquidFields {
            fill: gpu.storage::<[i32; 3]>("solver.fill", nodes)?,
            share: gpu.storage::<[f32; 4]>("solver.share", nodes)?,
            slopes: gpu.storage::<[f32; 4]>("solver.slopes", nodes)?,
            pull: gpu.storage::<[f32; 4]>("solver.pull", nodes)?,
            film: gpu.storage::<[f32; 2]>("solver.film", nodes)?,
        })
    }
}

/// The bind groups of the passes over one of the two state buffers.
pub(super) struct LiquidBound {
    pub fill: wgpu::BindGroup,
    pub share: wgpu::BindGroup,
    pub film: wgpu::BindGroup,
    pub density: wgpu::BindGroup,
    pub slope: wgpu::BindGroup,
    pub tension: wgpu::BindGroup,
    pub wall: wgpu::BindGroup,
}

impl Solver {
    /// Makes the passes where the table has something wet for the first time.
    pub(super) fn wet(&mut self, substances: &[Substance]) {
        if self.liquid.is_some() || !substances.iter().any(|s| s.clings_pa_s().is_some()) {
            return;
        }
        let passes = LiquidPasses::new(&self.gpu);
        self.passes.grid = passes.grid_wet.clone();
        self.liquid = Some(passes);
        // The next one has the fields.
        (self.grid, self.window) = (None, None);
    }

    /// No more surface tension and hardening than the time step affords.
    pub(super) fn afford_substances(&mut self, states: &[ParticleState]) {
        let slackened = budget::slacken(&mut self.laws.substances, states, &self.settings, self.time_s);
        let (stiffenings, capped) = budget::stiffenings(&self.laws.substances, states, &self.settings, &self.laws.stiffenings, self.time_s);
        if stiffenings != self.laws.stiffenings || !slackened.is_empty() {
            self.gpu.upload(&self.laws.table, &substance::records(&self.laws.substances, &stiffenings));
        }
        self.softened.extend(slackened);
        self.softened.extend(capped);
        self.laws.stiffenings = stiffenings;
        self.scale_liquids(states);
    }

    /// The fixed-point units of the liquids' properties, from the particles that have most of them.
    fn scale_liquids(&mut self, states: &[ParticleState]) {
        let (mut tension, mut viscosity) = (0f32, 0f32);
        for state in states {
            let substance = self.laws.substances.get(state.substance());
            if let Some((substance, viscosity_pa_s)) = substance.and_then(|s| Some((s, s.clings_pa_s()?))) {
                let per_density = state.volume_m3 / state.mass_kg;
                tension = tension.max(substance.tension_n_m() * per_density);
                viscosity = viscosity.max(viscosity_pa_s * per_density);
            }
        }
        let units = |most: f32| if most > 0.0 { FILL_UNITS / most } else { 0.0 };
        (self.params.tension_units, self.params.viscosity_units) = (units(tension), units(viscosity));
    }

    pub(super) fn bind_liquid(&self, grid: &GridBuffers, state: &StateBuffers) -> Option<LiquidBound> {
        let (p, fields) = (self.liquid.as_ref()?, grid.liquid.as_ref()?);
        let (gpu, params, blocks, table) = (&self.gpu, &self.params_buffer, &grid.active_blocks, &self.laws.table);
        let (kinematics, matter) = (&state.kinematics, &state.matter);
        Some(LiquidBound {
            fill: gpu.bind(&p.liquid_fill, &[params, kinematics, matter, table, &fields.fill]),
            share: gpu.bind(&p.liquid_share, &[params, blocks, &self.colliders_buffer, &fields.fill, &fields.share, &fields.pull]),
            film: gpu.bind(&p.liquid_film, &[params, blocks, &self.colliders_buffer, &fields.share, &fields.film]),
            density: gpu.bind(&p.liquid_density, &[params, kinematics, matter, table, &fields.share]),
            wall: gpu.bind(&p.liquid_wall, &[params, blocks, &self.colliders_buffer, &grid.velocity]),
            slope: gpu.bind(&p.liquid_slope, &[params, blocks, &fields.share, &fields.slopes]),
            tension: gpu.bind(&p.liquid_tension, &[params, blocks, &fields.share, &fields.slopes, &fields.pull]),
        })
    }

    /// Pours the liquids, `span_s` before the next time.
    pub(super) fn record_liquid(&self, b: &LiquidBound, active_groups: &wgpu::Buffer, span_s: f32, recording: &mut Recording) {
        let Some(p) = &self.liquid else { return };
        let groups = self.particle_groups();
        recording.dispatch(&p.liquid_fill, &b.fill, groups);
        recording.indirect(&p.liquid_share, &b.share, active_groups, 0);
        if self.params.collider_count > 0 {
            recording.indirect(&p.liquid_film, &b.film, active_groups, 0);
        }
        let span = Substep { dt_s: span_s, dt_next_s: 0.0, index: self.substep, job: 0, since_s: 0.0, lag: 0 };
        recording.dispatch_with(&p.liquid_density, &b.density, &span, groups);
        if self.params.tension_units > 0.0 {
            recording.indirect(&p.liquid_slope, &b.slope, active_groups, 0);
            recording.indirect(&p.liquid_tension, &b.tension, active_groups, 0);
        }
    }
    /// Whether any liquid is so thick that walls hold it within a frame.
    fn sticks(&self) -> bool {
        let most_m2_s = if self.params.viscosity_units > 0.0 { FILL_UNITS / self.params.viscosity_units } else { 0.0 };
        let rate = most_m2_s * self.params.per_m * self.params.per_m;
        f64::from(WALL_GRIP * rate * (1.0 + rate * WALL_SOON_S)) * self.settings.frame_s > 0.1
    }

    /// Adds what follows the grid's pass.
    pub(super) fn record_walls(&self, b: &LiquidBound, active_groups: &wgpu::Buffer, recording: &mut Recording) {
        if let Some(p) = self.liquid.as_ref().filter(|_| self.params.collider_count > 0 && self.sticks()) {
            recording.indirect(&p.liquid_wall, &b.wall, active_groups, 0);
        }
    }
}
