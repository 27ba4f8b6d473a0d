//! The solver itself: its particles, its surroundings, and what may be done to them between frames.

use super::budget;
use super::constants::{
    BLOCK_SLACK_CELLS, DEALT, FEW_PARTICLES, FIXED_BITS, LEAST_SPEED_M_S, PUSH_SHARE, REACH_CELLS, SLACK_CELLS, TILE_LANES, WORKGROUP,
};
use super::encounter::{Encounter, Layers};
use super::fields::Fields;
use super::grid::{GROUPS_MOST, GridBuffers, Window, params_buffer};
use super::grip::Grip;
use super::kept::Kept;
use super::laws::{Laws, rows};
use super::liquid::LiquidPasses;
use super::obstacles::{self, PinRecord};
use super::passes::Passes;
use super::rigid::{self, Rigid};
use super::sph::Sph;
use super::state::{self, ParticleState, StateBuffers};
use super::transfer::Transfers;
use super::types::{Particles, Placement, Settings, Softened, SolverError};
use super::volume::VolumePasses;
use super::wary::{self, Wary};
use super::watch::{Control, Watch};
use crate::gpu::{Gpu, Recording, Tier};
use crate::spec::limits;
use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};

/// `Params` of `shaders/solver/common.wgsl`, but for the map of blocks that follows it there. In a storage
/// buffer: lavapipe compiles a pass anew for each value of a uniform or an immediate that alone decides a
/// branch or a loop.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct Params {
    pub origin: [i32; 3],
    pub count: u32,
    pub blocks: [u32; 3],
    pub collider_count: u32,
    pub gravity_m_s2: [f32; 3],
    pub cell_m: f32,
    pub per_m: f32,
    pub mass_units: f32,
    pub reach_m: f32,
    pub has_ground: u32,
    pub pin_count: u32,
    pub slack: i32,
    pub seed: u32,
    pub momentum_floor: f32,
    pub momentum_bits: u32,
    pub first_substep: u32,
    pub tension_units: f32,
    pub viscosity_units: f32,
    pub has_liquid: u32,
    pub layers: u32,
    pub pools: u32,
    pub item_particles: u32,
    pub mixes: u32,
    pub rounder: f32,
    pub speed_most: f32,
    pub wet_layers: u32,
    pub push_m: f32,
    pub layer_of: [u32; DEALT as usize / 8],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Kick {
    add_m_s: [f32; 3],
    keep: f32,
    object: u32,
    padding: [u32; 3],
}

/// A world of particles on one device, soft, rigid and liquid. MLS-MPM (Hu et al. 2018) with quadratic splines and
/// APIC transfers (Jiang et al. 2015), on a sparse part of an endless lattice.
#[derive(Debug)]
pub struct Solver {
    pub(super) gpu: Gpu,
    pub(super) settings: Settings,
    pub(super) passes: Passes,
    pub(super) transfers: Transfers,
    pub(super) params: Params,
    pub(super) params_buffer: wgpu::Buffer,
    pub(super) colliders_buffer: wgpu::Buffer,
    pub(super) pins_buffer: wgpu::Buffer,
    pub(super) objects_buffer: wgpu::Buffer,
    pub(super) laws: Laws,
    /// Of liquids, where there are any.
    pub(super) liquid: Option<LiquidPasses>,
    /// Of what is nearly incompressible, where anything is.
    pub(super) volume: Option<VolumePasses>,
    pub(super) object_count: u32,
    /// What each pin holds.
    pub(super) grips: Vec<Grip>,
    /// Which layer of the grid each object is on.
    pub(super) layers: Layers,
    /// Contact between objects, where there are several.
    pub(super) encounter: Option<Encounter>,
    pub(super) control: wgpu::Buffer,
    /// The order of the particles is that of `buffers[current]`; a sort writes the other one.
    pub(super) buffers: [StateBuffers; 2],
    pub(super) current: usize,
    pub(super) backup: StateBuffers,
    /// What drives particles by expressions, where anything does.
    pub(super) fields: Option<Fields>,
    /// Of facilities beside the laws; [`Solver::kept`] has all.
    pub(super) kept: Vec<Kept>,
    /// Liquids beside the grid, where there are any.
    pub(super) sph: Option<Sph>,
    /// Rigid bodies, where there are any.
    pub(super) rigid: Option<Rigid>,
    /// Whether anything is soft: without it the grid is not used.
    pub(super) soft: bool,
    pub(super) slots: wgpu::Buffer,
    pub(super) number_in_block: wgpu::Buffer,
    /// Rows of F0^-1 in the original order.
    pub(super) unstressed: wgpu::Buffer,
    motion: wgpu::Buffer,
    velocity: wgpu::Buffer,
    pub(super) grid: Option<GridBuffers>,
    pub(super) window: Option<Window>,
    /// What the watch saw at the present time; none where something changed since.
    pub(super) seen: Option<Watch>,
    /// What had to be softened since the last report.
    pub(super) softened: Vec<Softened>,
    pub(super) time_s: f64,
    pub(super) substep: u32,
    /// What trouble taught.
    pub(super) wary: Wary,
    pub(super) heaviest_kg: f32,
}

impl Solver {
    /// Uploads the particles; the first window of the grid is made when time first moves.
    pub fn new(gpu: &Gpu, settings: Settings, particles: &Particles) -> Result<Solver, SolverError> {
        check(&settings)?;
        check_count(particles.len() as u64, WORKGROUP)?;
        let colliders = obstacles::colliders(&settings);
        let mut states = state::initial(particles, &colliders, settings.cell_m)?;
        let softened = budget::afford(&mut states, &settings, 0.0);
        let n = states.len();
        let heaviest_kg = states.iter().map(|s| s.mass_kg).fold(0.0, f32::max);
        let object_count = states.iter().map(ParticleState::object).max().unwrap_or(0) + 1;
        let mut params = Params {
            count: n as u32,
            collider_count: colliders.len() as u32,
            gravity_m_s2: settings.gravity_m_s2.into(),
            cell_m: settings.cell_m,
            per_m: 1.0 / settings.cell_m,
            mass_units: wary::mass_units(heaviest_kg, 0),
            momentum_bits: FIXED_BITS,
            reach_m: REACH_CELLS * settings.cell_m,
            has_ground: u32::from(settings.ground.is_some()),
            slack: match gpu.tier {
                Tier::Cpu => SLACK_CELLS,
                Tier::Gpu => BLOCK_SLACK_CELLS,
            },
            item_particles: if n < FEW_PARTICLES { TILE_LANES } else { 2 * TILE_LANES },
            rounder: 12_582_912.0,
            speed_most: budget::fastest_m_s(&settings),
            seed: (settings.seed ^ settings.seed >> 32) as u32,
            momentum_floor: heaviest_kg * LEAST_SPEED_M_S,
            ..Default::default()
        };
        params.push_m = PUSH_SHARE * params.slack as f32 * settings.cell_m;
        let layers = Layers::deal(&settings, &states, &particles.substances);
        layers.note(&mut params);
        let rigid = rigid::assemble(&states, &particles.substances, &colliders, settings.cell_m)?.map(|all| Rigid::new(gpu, &all)).transpose()?;
        let passes = Passes::new(gpu);
        let mut solver = Solver {
            transfers: Transfers::new(gpu),
            passes,
            params_buffer: params_buffer(gpu, &params, 0)?,
            colliders_buffer: gpu.storage_from("solver.colliders", &padded(&colliders, 1))?,
            pins_buffer: gpu.storage::<PinRecord>("solver.pins", settings.pins.len().max(1))?,
            objects_buffer: gpu.storage::<[f32; 4]>("solver.objects", object_count as usize)?,
            object_count,
            layers,
            grips: settings.pins.iter().map(|pin| Grip::new(pin, &states, settings.cell_m)).collect(),
            encounter: Encounter::new(gpu, &settings, &states, &particles.substances, object_count)?,
            laws: Laws::new(gpu)?,
            liquid: None,
            volume: None,
            control: gpu.storage::<Control>("solver.control", 1)?,
            buffers: [StateBuffers::new(gpu, "solver.even", n)?, StateBuffers::new(gpu, "solver.odd", n)?],
            current: 0,
            backup: StateBuffers::new(gpu, "solver.backup", n)?,
            fields: Fields::new(gpu, &settings, particles, params.seed)?,
            sph: None,
            kept: Vec::new(),
            rigid,
            soft: states.iter().any(|s| !s.is_rigid()),
            slots: gpu.storage::<[u32; 4]>("solver.slots", n)?,
            number_in_block: gpu.storage::<u32>("solver.number_in_block", n)?,
            unstressed: gpu.storage_from("solver.unstressed", &vec![rows(Mat3::IDENTITY); n])?,
            motion: gpu.storage::<[u32; 8]>("solver.motion", n)?,
            velocity: gpu.storage::<[f32; 4]>("solver.frame_velocity", n)?,
            grid: None,
            window: None,
            seen: None,
            softened,
            time_s: 0.0,
            substep: 0,
            wary: Wary::default(),
            heaviest_kg,
            gpu: gpu.clone(),
            settings,
            params,
        };
        solver.set_substances(&particles.substances)?;
        solver.afford_substances(&states);
        solver.survey(&states);
        solver.watch_volumes(&states);
        solver.buffers[0].upload(gpu, &states);
        Ok(solver)
    }

    /// Seconds since the start.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Particles of all objects.
    pub fn particle_count(&self) -> u32 {
        self.params.count
    }

    /// 8 u32 a particle in the original order: x, y, z as f32 bits; then nine f16 of G - I by rows; the
    /// last half is 0 where matter keeps its shape, else how it flows ([`super::Flow`]). G = F F0^-1, or for laws whose F forgets all that happened, within bounds. Written by [`Solver::record_frame`].
    pub fn motion(&self) -> &wgpu::Buffer {
        &self.motion
    }

    /// vec4 a particle in the original order: velocity in m/s, volume over that at rest. Written by [`Solver::record_frame`].
    pub fn velocity(&self) -> &wgpu::Buffer {
        &self.velocity
    }

    /// Adds the pass that writes [`Solver::motion`] and [`Solver::velocity`] for the present time.
    pub fn record_frame(&self, recording: &mut Recording) {
        let state = &self.buffers[self.current];
        let (seen, laws) = ([&self.motion, &self.velocity], &self.laws);
        let buffers = [&self.params_buffer, &state.kinematics, &state.matter, &self.unstressed, seen[0], seen[1], &laws.table, laws.shown()];
        recording.dispatch(&self.passes.frame, &self.gpu.bind(&self.passes.frame, &buffers), self.particle_groups());
    }

    /// Moves an object rigidly to where it starts and sets its velocity: F becomes R F.
    ///
    /// What would be moved mostly behind a surface is put in front of it, whole; how far that was.
    pub fn place(&mut self, object: u32, placement: &Placement) -> Result<Vec3, SolverError> {
        let turn = Mat3::from_quat(placement.rotation.normalize());
        let way_out = self.way_out(object, turn, placement)?;
        let placement = &Placement { offset_m: placement.offset_m + way_out, ..*placement };
        let centre = placement.centre_m + placement.offset_m;
        let spin = placement.spin_rad_s;
        // [spin] x, so that v = velocity + spin x (x - centre) has this gradient.
        let cross = Mat3::from_cols(Vec3::new(0.0, spin.z, -spin.y), Vec3::new(-spin.z, 0.0, spin.x), Vec3::new(spin.y, -spin.x, 0.0));
        let still = placement.is_captured();
        let mut moved = Vec::new();
        self.edit(|s| {
            moved.push(!still && s.object() == object);
            if s.object() != object {
                return;
            }
            if !still {
                s.position_m = turn * (s.position_m - placement.centre_m) + centre;
                s.set_f(turn * s.f());
            }
            s.velocity_m_s = placement.velocity_m_s + spin.cross(s.position_m - centre);
            s.set_affine(cross * s.mass_kg);
        })?;
        self.edit_shown(|i, g| if moved[i] { turn * g } else { g })?;
        self.let_go(object);
        self.rigid.iter().try_for_each(|r| r.place(&self.gpu, object, placement))?;
        Ok(way_out)
    }

    /// How much further an object has to go that is moved behind a surface.
    fn way_out(&self, object: u32, turn: Mat3, placement: &Placement) -> Result<Vec3, SolverError> {
        if placement.is_captured() {
            return Ok(Vec3::ZERO);
        }
        let goes_to = |s: &ParticleState| turn * (s.position_m - placement.centre_m) + placement.centre_m + placement.offset_m;
        let points: Vec<Vec3> = self.states()?.iter().filter(|s| s.object() == object).map(goes_to).collect();
        Ok(obstacles::way_out(&obstacles::colliders(&self.settings), &points))
    }

    /// Adds to the velocity of all of an object.
    pub fn kick(&mut self, object: u32, delta_v_m_s: Vec3) {
        self.change_velocity(object, delta_v_m_s, 1.0);
    }

    /// Replaces the velocity of all of an object; it neither spins nor stretches then.
    pub fn set_velocity(&mut self, object: u32, velocity_m_s: Vec3) {
        self.change_velocity(object, velocity_m_s, 0.0);
    }

    fn change_velocity(&mut self, object: u32, add: Vec3, keep: f32) {
        self.gpu.upload(&self.params_buffer, &[self.params]);
        let state = &self.buffers[self.current];
        let bindings = self.gpu.bind(&self.passes.kick, &[&self.params_buffer, &state.kinematics, &state.matter]);
        let mut recording = Recording::default();
        let kick = Kick { add_m_s: add.into(), keep, object, padding: [0; 3] };
        recording.dispatch_with(&self.passes.kick, &bindings, &kick, self.particle_groups());
        self.rigid.iter().for_each(|r| r.record_kick(self, &kick, &mut recording));
        self.gpu.submit(&recording);
        self.seen = None;
    }

    /// Where the rigid bodies are and how they move.
    pub(super) fn motions(&self) -> Result<Vec<rigid::Motion>, SolverError> {
        self.rigid.as_ref().map_or_else(|| Ok(Vec::new()), |r| r.motions(&self.gpu))
    }

    /// State beside the particles.
    pub(super) fn kept(&self) -> impl Iterator<Item = &Kept> {
        self.laws.kept().into_iter().chain(self.rigid.iter().flat_map(Rigid::kept)).chain(&self.kept)
    }

    /// All particles in their original order.
    pub(super) fn states(&self) -> Result<Vec<ParticleState>, SolverError> {
        Ok(self.buffers[self.current].download(&self.gpu, self.params.count as usize)?)
    }

    /// Changes particles on the host; they are back in their original order then, which the next
    /// segment's sort makes good.
    pub(super) fn edit(&mut self, change: impl FnMut(&mut ParticleState)) -> Result<(), SolverError> {
        let mut states = self.states()?;
        states.iter_mut().for_each(change);
        self.replace(states);
        Ok(())
    }

    /// Writes all particles, in their original order; none stiffer than the time step affords.
    pub(super) fn replace(&mut self, mut states: Vec<ParticleState>) {
        self.softened.extend(budget::afford(&mut states, &self.settings, self.time_s));
        self.afford_substances(&states);
        self.buffers[self.current].upload(&self.gpu, &states);
        self.survey(&states);
        self.watch_volumes(&states);
        self.seen = None;
    }

    pub(super) fn particle_groups(&self) -> [u32; 3] {
        [self.params.count.div_ceil(WORKGROUP), 1, 1]
    }
}

/// A list that can always be bound.
pub(super) fn padded<T: Pod>(values: &[T], least: usize) -> Vec<T> {
    let mut values = values.to_vec();
    values.resize(values.len().max(least), T::zeroed());
    values
}

/// Refuses more than the workgroups of a pass reach, where each takes so many.
pub(super) fn check_count(count: u64, workgroup: u32) -> Result<(), SolverError> {
    let allowed = GROUPS_MOST * u64::from(workgroup);
    if count > allowed { Err(SolverError::TooMany { count, allowed }) } else { Ok(()) }
}

fn check(settings: &Settings) -> Result<(), SolverError> {
    let refuse = |what: String, expected: &str| Err(SolverError::Input { what, expected: expected.to_owned() });
    if !(settings.cell_m > 0.0 && settings.cell_m.is_finite()) {
        return refuse(format!("a cell of {} m", settings.cell_m), "a positive, finite size");
    }
    if !settings.gravity_m_s2.is_finite() {
        return refuse(format!("gravity {}", settings.gravity_m_s2), "finite numbers");
    }
    if settings.colliders.len() > limits::COLLIDERS as usize {
        return refuse(format!("{} colliders", settings.colliders.len()), &format!("at most {}", limits::COLLIDERS));
    }
    if !(settings.cfl > 0.0 && settings.cfl <= 0.6) {
        return refuse(format!("a CFL number of {}", settings.cfl), "over 0, at most 0.6");
    }
    if !(settings.frame_s > 0.0 && settings.frame_s.is_finite()) {
        return refuse(format!("frames of {} s", settings.frame_s), "a positive length");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_that_no_dispatch_reaches_are_refused() {
        let reached = u64::from(wgpu::Limits::default().max_compute_workgroups_per_dimension) * u64::from(WORKGROUP);
        assert!(check_count(reached, WORKGROUP).is_ok());
        let refused = check_count(reached + 1, WORKGROUP).unwrap_err().to_string();
        assert!(refused.contains("8388481") && refused.contains("solver.cells_across"), "{refused}");
    }
}
