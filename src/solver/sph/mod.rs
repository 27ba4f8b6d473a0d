//! Liquids as smoothed particles: DFSPH (Bender and Koschier 2017) on the solver's own particles.
//!
//! Particles are half a cell apart and the kernel reaches a cell far, so that all neighbours of a
//! particle lie in the 27 cells around its own, in the order of the sort; such scenes sort before each
//! substep. The liquid does not touch the grid. Particles that do, solids, are neighbours with a volume
//! of their own, and what the liquid does to them goes into their velocity before the grid sees them.
//! A wall is felt as if the liquid went on behind it in layers, in closed form.
//!
//! A substep: lists of neighbours; velocities made free of divergence; weight, tension, viscosity;
//! velocities that keep the density; motion. Both corrections are relaxed Jacobi rounds over pressures
//! that are never negative. How many are made is decided on the device, by sums of integers.

mod passes;

use super::advance::Substep;
use super::constants::{VISCOUS, VISCOUS_RANGE};
use super::core::Solver;
use super::grid::GridBuffers;
use super::kept::Kept;
use super::state::ParticleState;
use super::substance::Substance;
use super::types::SolverError;
use crate::gpu::{Gpu, Recording};
use bytemuck::{Pod, Zeroable};
pub(super) use passes::{SphPasses, kernels};

/// Fours of a list of neighbours at first: at rest there are 32 neighbours, in overlapping bodies twice that.
const COLUMNS: u32 = 16;
/// Lists are never longer.
const COLUMNS_MOST: u32 = 256;
/// Rounds at most that keep the density, and that remove divergence.
const ROUNDS: [u32; 2] = [40, 16];
/// Mean relative errors that are small enough.
const TOLERANCE: [f32; 2] = [1e-4, 1e-3];
/// Rounds made in any case.
const LEAST_ROUNDS: [u32; 2] = [2, 1];
/// First counters of the errors.
const SLOTS: [u32; 2] = [0, 64];
/// A substep in free fall from rest moves a particle by half the square of this, in spacings.
const FALL_SHARE: f64 = 0.1;
/// Share of the period of the shortest capillary wave, times 1 / sqrt(2 pi): half of what a continuous surface
/// takes (Brackbill et al. 1992), for pairs of particles are stiffer.
const CAPILLARY: f64 = 0.2;
/// Most that pairs brake, over their common factor and viscosity / (density cell^2): Gershgorin's bound where particles are as dense as at rest.
const VISCOUS_BOUND: f64 = 24.0;
/// What is left of the stiffest viscous error after the implicit rounds.
const VISCOUS_LEFT: f64 = 1e-2;

/// `Solve` of `shaders/solver/sph_solve.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Solve {
    of_density: f32,
    tolerance: f32,
    least_rounds: u32,
    slot: u32,
    pressure: u32,
    liquids: u32,
    columns: u32,
}

/// The smoothed particles' part of a solver. Buffers are in the order of the sort and live within a
/// substep; only pressures are kept from one to the next.
#[derive(Debug)]
pub(super) struct Sph {
    pub passes: SphPasses,
    columns: u32,
    liquids: u32,
    /// Largest viscosity, least density, largest tension over density.
    viscosity_pa_s: f32,
    least_density_kg_m3: f32,
    tension_over_density: f32,
    solves: [wgpu::Buffer; 2],
    pub neighbours: wgpu::Buffer,
    pub near: wgpu::Buffer,
    pub place: wgpu::Buffer,
    pub motion: wgpu::Buffer,
    pub nature: wgpu::Buffer,
    pub density: wgpu::Buffer,
    pub answer: wgpu::Buffer,
    pub predicted: wgpu::Buffer,
    pub corrected: wgpu::Buffer,
    pub slowed: wgpu::Buffer,
    pub pressure: wgpu::Buffer,
    pub reached: wgpu::Buffer,
    pub errors: wgpu::Buffer,
    /// Pressures of both corrections, by the particles' original order.
    kept: wgpu::Buffer,
}

/// Everything bound, for one of the two state buffers.
pub(super) struct SphBound {
    pub place: wgpu::BindGroup,
    pub near: wgpu::BindGroup,
    /// Of divergence.
    pub press_divergence: wgpu::BindGroup,
    pub correct_divergence: wgpu::BindGroup,
    pub forces: wgpu::BindGroup,
    /// First, odd and even rounds.
    pub implicit: [wgpu::BindGroup; 3],
    pub settle: wgpu::BindGroup,
    pub press_density: wgpu::BindGroup,
    pub correct_density: wgpu::BindGroup,
    pub advance: wgpu::BindGroup,
}

impl Sph {
    /// For so many particles, of which [`Solver::survey`] tells what they are; and the pressures that are part
    /// of the state.
    pub fn new(gpu: &Gpu, n: usize) -> Result<(Sph, Kept), SolverError> {
        let vectors = |name: &str| gpu.storage::<[f32; 4]>(&format!("solver.sph_{name}"), n);
        let kept = Kept::new(gpu, "solver.sph_kept", &vec![[0f32; 2]; n])?;
        let sph = Sph {
            passes: SphPasses::new(gpu),
            columns: COLUMNS,
            liquids: 0,
            viscosity_pa_s: 0.0,
            least_density_kg_m3: f32::INFINITY,
            tension_over_density: 0.0,
            solves: [gpu.storage::<Solve>("solver.sph_solve", 1)?, gpu.storage::<Solve>("solver.sph_solve_divergence", 1)?],
            neighbours: gpu.storage::<[u32; 4]>("solver.sph_neighbours", COLUMNS as usize * n)?,
            near: gpu.storage::<u32>("solver.sph_near", n)?,
            place: vectors("place")?,
            motion: vectors("motion")?,
            nature: vectors("nature")?,
            density: gpu.storage::<[f32; 4]>("solver.sph_density", 2 * n)?,
            answer: gpu.storage::<f32>("solver.sph_answer", n)?,
            predicted: vectors("predicted")?,
            corrected: vectors("corrected")?,
            slowed: vectors("slowed")?,
            pressure: gpu.storage::<f32>("solver.sph_pressure", 2 * n)?,
            reached: gpu.storage::<f32>("solver.sph_reached", n)?,
            errors: gpu.storage::<u32>("solver.sph_errors", super::constants::SPH_SLOTS as usize)?,
            kept: kept.live.clone(),
        };
        Ok((sph, kept))
    }

    /// Sums up what the particles are.
    fn survey(&mut self, substances: &[Substance], states: &[ParticleState]) {
        (self.liquids, self.viscosity_pa_s, self.least_density_kg_m3, self.tension_over_density) = (0, 0.0, f32::INFINITY, 0.0);
        for state in states {
            if let Some(Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }) = substances.get(state.substance()) {
                let density = state.mass_kg / state.volume_m3;
                self.liquids += 1;
                self.viscosity_pa_s = self.viscosity_pa_s.max(*viscosity_pa_s);
                self.least_density_kg_m3 = self.least_density_kg_m3.min(density);
                self.tension_over_density = self.tension_over_density.max(surface_tension_n_m / density);
            }
        }
    }

    fn upload_solves(&self, gpu: &Gpu, count: usize) {
        for k in 0..2 {
            let solve = Solve {
                of_density: [1.0, 0.0][k],
                tolerance: TOLERANCE[k],
                least_rounds: LEAST_ROUNDS[k],
                slot: SLOTS[k],
                pressure: (k * count) as u32,
                liquids: self.liquids,
                columns: self.columns,
            };
            gpu.upload(&self.solves[k], &[solve]);
        }
    }

    /// Longest substep: cfl spacing / |v|, a share of the time that a spacing of free fall takes, and of
    /// the period of the shortest capillary wave.
    pub fn limit_s(&self, spacing_m: f64, cfl: f64, speed_m_s: f64, acceleration_m_s2: f64) -> f64 {
        let moving_s = cfl * spacing_m / speed_m_s.max(1e-9);
        let falling_s = FALL_SHARE * (spacing_m / acceleration_m_s2.max(1e-9)).sqrt();
        let waving_s = CAPILLARY * (spacing_m.powi(3) / (std::f64::consts::TAU * f64::from(self.tension_over_density).max(1e-12))).sqrt();
        moving_s.min(falling_s).min(waving_s)
    }

    /// Rounds of implicit viscosity that a substep takes, 0 where it is mild enough to be explicit.
    pub fn viscous_rounds(&self, cell_m: f64, dt_s: f64) -> u32 {
        let kinematic = f64::from(self.viscosity_pa_s) / f64::from(self.least_density_kg_m3);
        let stiff = VISCOUS_BOUND * f64::from(VISCOUS) * kinematic * dt_s / (cell_m * cell_m);
        if stiff <= 1.0 {
            return 0;
        }
        // Chebyshev's rate: the error falls by exp(-2 / sqrt(1 + stiff)) a round.
        let rounds = 0.5 * (1.0 + stiff).min(f64::from(VISCOUS_RANGE)).sqrt() * (2.0 / VISCOUS_LEFT).ln();
        // An even number ends where it began.
        2 * (0.5 * rounds).ceil() as u32
    }

    /// Everything bound, for particles in one of the two state buffers.
    pub fn bind(&self, solver: &Solver, grid: &GridBuffers, current: usize) -> SphBound {
        let (gpu, p, params) = (&solver.gpu, &self.passes, &solver.params_buffer);
        let (kinematics, matter) = (&solver.buffers[current].kinematics, &solver.buffers[current].matter);
        let (objects, colliders, control) = (&solver.objects_buffer, &solver.colliders_buffer, &solver.control);
        let [density_solve, divergence_solve] = &self.solves;
        let press = |solve, base| {
            let lists = [params, solve, &self.place, &self.nature, &self.neighbours, &self.near, &self.density, &self.pressure, base];
            gpu.bind(&p.sph_press, &[&lists[..], &[&self.errors, &self.corrected]].concat())
        };
        let correct = |solve| {
            let lists = [params, solve, &self.place, &self.neighbours, &self.near, &self.density, &self.answer, &self.corrected];
            gpu.bind(&p.sph_correct, &[&lists[..], &[&self.pressure, &self.errors, &self.reached]].concat())
        };
        let implicit = |present, next| {
            let lists = [params, density_solve, colliders, &self.place, &self.nature, &self.neighbours, &self.near, &self.corrected];
            gpu.bind(&p.sph_implicit, &[&lists[..], &[present, next, &self.errors]].concat())
        };
        let pushed = [params, density_solve, &self.place, &self.nature, &self.neighbours, &self.near, &self.density, &self.pressure, &self.predicted];
        let moved = [matter, objects, colliders, kinematics, &self.kept, control];
        let places = [params, kinematics, matter, &solver.laws.table, &self.kept];
        let placed = [&self.place, &self.motion, &self.nature, &self.pressure, &self.errors];
        let cells = [params, &self.place, &self.nature, &grid.cell_start, &grid.cell_end, colliders, density_solve];
        let found = [&self.neighbours, &self.near, &self.density, &self.answer, control, &self.errors];
        let around = [params, density_solve, matter, objects, colliders, &self.place, &self.nature, &self.neighbours, &self.near];
        let forced = [&self.density, &self.pressure, &self.motion, &self.predicted, &self.corrected];
        SphBound {
            place: gpu.bind(&p.sph_place, &[places, placed].concat()),
            near: gpu.bind(&p.sph_near, &[&cells[..], &found[..]].concat()),
            press_divergence: press(divergence_solve, &self.motion),
            correct_divergence: correct(divergence_solve),
            forces: gpu.bind(&p.sph_forces, &[&around[..], &forced[..]].concat()),
            implicit: [implicit(&self.corrected, &self.motion), implicit(&self.motion, &self.slowed), implicit(&self.slowed, &self.motion)],
            settle: gpu.bind(&p.sph_settle, &[params, &self.near, &self.slowed, &self.predicted, &self.corrected]),
            press_density: press(density_solve, &self.predicted),
            correct_density: correct(density_solve),
            advance: gpu.bind(&p.sph_advance, &[&pushed[..], &moved[..]].concat()),
        }
    }

    /// Adds one substep, from sorted particles to moved ones.
    pub fn record(&self, b: &SphBound, substep: &Substep, viscous_rounds: u32, groups: [u32; 3], recording: &mut Recording) {
        let p = &self.passes;
        let job = |job: u32| Substep { job, ..*substep };
        recording.dispatch(&p.sph_place, &b.place, groups);
        recording.dispatch(&p.sph_near, &b.near, groups);
        for round in 0..ROUNDS[1] {
            recording.dispatch_with(&p.sph_press, &b.press_divergence, &job(round), groups);
            recording.dispatch_with(&p.sph_correct, &b.correct_divergence, &job(round), groups);
        }
        let implicit = viscous_rounds > 0;
        recording.dispatch_with(&p.sph_forces, &b.forces, &job(u32::from(implicit)), groups);
        for round in 0..viscous_rounds {
            let bound = if round == 0 { &b.implicit[0] } else { &b.implicit[2 - (round % 2) as usize] };
            recording.dispatch_with(&p.sph_implicit, bound, &job(round), groups);
        }
        if implicit {
            recording.dispatch(&p.sph_settle, &b.settle, groups);
        }
        for round in 0..ROUNDS[0] {
            // The first half of the first round came with the forces.
            if round > 0 {
                recording.dispatch_with(&p.sph_press, &b.press_density, &job(round), groups);
            }
            recording.dispatch_with(&p.sph_correct, &b.correct_density, &job(round), groups);
        }
        recording.dispatch_with(&p.sph_advance, &b.advance, substep, groups);
    }
}

impl Solver {
    /// Takes note of what the particles are, after that was given or changed on the host.
    pub(super) fn survey(&mut self, states: &[ParticleState]) {
        if let Some(sph) = &mut self.sph {
            sph.survey(&self.laws.substances, states);
            sph.upload_solves(&self.gpu, states.len());
            self.params.has_liquid = u32::from(sph.liquids > 0);
        }
    }

    /// The smoothed particles' part, where there are any.
    pub(super) fn sph(&self) -> Option<&Sph> {
        self.sph.as_ref().filter(|s| s.liquids > 0)
    }

    /// Pressure of each particle of such a liquid, in the original order: what both corrections of the last
    /// substep took together. 0 of all others.
    pub(super) fn liquid_pressures_pa(&self) -> Result<Vec<f32>, SolverError> {
        let count = self.params.count as usize;
        let Some(sph) = &self.sph else { return Ok(vec![0.0; count]) };
        let kept: Vec<[f32; 2]> = self.gpu.read(&sph.kept, count)?;
        Ok(kept.iter().map(|[density, divergence]| density + divergence).collect())
    }

    /// Whether any particle exchanges with the grid.
    pub(super) fn has_solids(&self) -> bool {
        self.sph.as_ref().is_none_or(|s| s.liquids < self.params.count)
    }

    /// Longer lists of neighbours, after a segment found them too short; false where there are none longer.
    pub(super) fn lengthen_lists(&mut self) -> Result<bool, SolverError> {
        let Some(sph) = self.sph.as_mut().filter(|s| s.columns < COLUMNS_MOST) else { return Ok(false) };
        let count = self.params.count as usize;
        sph.neighbours = self.gpu.storage::<[u32; 4]>("solver.sph_neighbours", 2 * sph.columns as usize * count)?;
        sph.columns *= 2;
        sph.upload_solves(&self.gpu, count);
        Ok(true)
    }
}
