//! Liquids as smoothed particles: DFSPH (Bender and Koschier 2017) on the solver's own particles.
//!
//! Particles are half a cell apart and the kernel reaches a cell far, so that all neighbours of a
//! particle lie in the 27 cells around its own, in the order of the sort; such scenes sort before each
//! substep. The liquid does not touch the grid. Particles that do, solids, are neighbours with a volume
//! of their own, and what the liquid does to them goes into their velocity before the grid sees them.
//! A wall is felt as if the liquid went on behind it in layers, in closed form.
//!
//! As captured, so at rest: what is too dense when it becomes such a liquid may be so, and thins out slowly.
//!
//! A substep: lists of neighbours; weight, tension, viscosity; velocities that keep the density; motion. The
//! correction is relaxed Jacobi rounds over pressures that are never negative, from those of the last substep on.
//! How many are made is decided on the device, by sums of integers: each round lets the next one run, and one
//! that is not needed has no workgroups.
//!
//! Passes over neighbours: the search, tension, forces, half a round, a round and a half for each further one, motion.

mod passes;

use super::advance::{Plan, Substep};
use super::constants::{SPH_LEAST_ROUNDS, VISCOUS, VISCOUS_BOUND, VISCOUS_RANGE, WORKGROUP};
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
/// Rounds at most. What is left after them is the next substep's to correct.
const ROUNDS: u32 = 24;
/// A substep takes what is fastest so many times farther than cfl spacings: 0.64 of one. A dam breaks alike from 0.4 to 0.8, and
/// a million particles that meet the ground at once spread alike from 0.5 to 0.8.
const SPEED_SHARE: f64 = 1.6;
/// A substep in free fall from rest moves a particle by half the square of this, in spacings.
const FALL_SHARE: f64 = 0.15;
/// Share of the period of the shortest capillary wave, times 1 / sqrt(2 pi): half of what a continuous surface
/// takes (Brackbill et al. 1992), for pairs of particles are stiffer.
const CAPILLARY: f64 = 0.2;
/// What is kept of a particle that is new to this: no pressure, and how much too dense it may be it has not noted yet.
const UNNOTED: [f32; 4] = [0.0, -1.0, 0.0, 0.0];
/// What is left of the stiffest viscous error after the implicit rounds.
const VISCOUS_LEFT: f64 = 1e-2;

/// `Solve` of `shaders/solver/sph_solve.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Solve {
    liquids: u32,
    columns: u32,
    groups: u32,
}

/// The smoothed particles' part of a solver. Buffers are in the order of the sort and live within a
/// substep; only pressures, what may be too dense, and what viscosity did are kept from one to the next.
#[derive(Debug)]
pub(super) struct Sph {
    pub passes: SphPasses,
    columns: u32,
    liquids: u32,
    /// Largest viscosity, least density, largest tension over density.
    viscosity_pa_s: f32,
    least_density_kg_m3: f32,
    tension_over_density: f32,
    solve: wgpu::Buffer,
    /// Workgroups of even rounds, and of odd ones: a pass cannot write the counts that it runs by.
    pub turns: [wgpu::Buffer; 2],
    pub neighbours: wgpu::Buffer,
    pub slopes: wgpu::Buffer,
    pub near: wgpu::Buffer,
    pub place: wgpu::Buffer,
    pub coarse: wgpu::Buffer,
    pub motion: wgpu::Buffer,
    pub nature: wgpu::Buffer,
    pub density: wgpu::Buffer,
    pub inward: wgpu::Buffer,
    pub skin: wgpu::Buffer,
    pub answer: wgpu::Buffer,
    pub predicted: wgpu::Buffer,
    pub corrected: wgpu::Buffer,
    pub slowed: wgpu::Buffer,
    pub pressure: wgpu::Buffer,
    pub reached: wgpu::Buffer,
    pub errors: wgpu::Buffer,
    /// Pressure, how much too dense it may be, and how fast that changes, by the particles' original order.
    kept: wgpu::Buffer,
    /// What implicit viscosity accelerated each by in the last substep, in that order.
    braking: wgpu::Buffer,
}

/// Everything bound, for one of the two state buffers.
pub(super) struct SphBound {
    pub place: wgpu::BindGroup,
    pub near: wgpu::BindGroup,
    pub begin: wgpu::BindGroup,
    pub skin: wgpu::BindGroup,
    pub forces: wgpu::BindGroup,
    pub foresee: wgpu::BindGroup,
    /// Even and odd rounds.
    pub implicit: [wgpu::BindGroup; 2],
    pub settle: wgpu::BindGroup,
    /// Even and odd rounds.
    pub press: [wgpu::BindGroup; 2],
    pub correct: wgpu::BindGroup,
    pub advance: wgpu::BindGroup,
}

impl Sph {
    /// For so many particles, of which [`Solver::survey`] tells what they are; and what of it is part of the state, the
    /// pressures last.
    pub fn new(gpu: &Gpu, n: usize) -> Result<(Sph, [Kept; 2]), SolverError> {
        let vectors = |name: &str| gpu.storage::<[f32; 4]>(&format!("solver.sph_{name}"), n);
        let kept = Kept::new(gpu, "solver.sph_kept", &vec![UNNOTED; n])?;
        let braking = Kept::new(gpu, "solver.sph_braking", &vec![[0f32; 4]; n])?;
        let turns = |name: &str| gpu.storage::<[u32; 4]>(name, super::constants::SPH_SLOTS as usize);
        let sph = Sph {
            passes: SphPasses::new(gpu),
            columns: COLUMNS,
            liquids: 0,
            viscosity_pa_s: 0.0,
            least_density_kg_m3: f32::INFINITY,
            tension_over_density: 0.0,
            solve: gpu.storage::<Solve>("solver.sph_solve", 1)?,
            turns: [turns("solver.sph_even_rounds")?, turns("solver.sph_odd_rounds")?],
            neighbours: gpu.storage::<[u32; 4]>("solver.sph_neighbours", COLUMNS as usize * n)?,
            slopes: gpu.storage::<[f32; 4]>("solver.sph_slopes", COLUMNS as usize * n)?,
            near: gpu.storage::<u32>("solver.sph_near", n)?,
            place: vectors("place")?,
            coarse: gpu.storage::<u32>("solver.sph_coarse", n)?,
            motion: vectors("motion")?,
            nature: vectors("nature")?,
            density: gpu.storage::<[f32; 4]>("solver.sph_density", 2 * n)?,
            inward: gpu.storage::<f32>("solver.sph_inward", n)?,
            skin: gpu.storage::<[f32; 2]>("solver.sph_skin", n)?,
            answer: gpu.storage::<f32>("solver.sph_answer", n)?,
            predicted: vectors("predicted")?,
            corrected: vectors("corrected")?,
            slowed: vectors("slowed")?,
            pressure: gpu.storage::<f32>("solver.sph_pressure", n)?,
            reached: gpu.storage::<f32>("solver.sph_reached", n)?,
            errors: gpu.storage::<u32>("solver.sph_errors", super::constants::SPH_SLOTS as usize)?,
            kept: kept.live.clone(),
            braking: braking.live.clone(),
        };
        Ok((sph, [braking, kept]))
    }

    /// Sums up what the particles are.
    fn survey(&mut self, substances: &[Substance], states: &[ParticleState]) {
        (self.liquids, self.viscosity_pa_s, self.least_density_kg_m3, self.tension_over_density) = (0, 0.0, f32::INFINITY, 0.0);
        for state in states.iter().filter(|s| !s.has_left()) {
            if let Some(Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }) = substances.get(state.substance()) {
                let density = state.mass_kg / state.volume_m3;
                self.liquids += 1;
                self.viscosity_pa_s = self.viscosity_pa_s.max(*viscosity_pa_s);
                self.least_density_kg_m3 = self.least_density_kg_m3.min(density);
                self.tension_over_density = self.tension_over_density.max(surface_tension_n_m / density);
            }
        }
    }

    fn upload_solve(&self, gpu: &Gpu, count: usize) {
        let groups = (count as u32).div_ceil(WORKGROUP);
        gpu.upload(&self.solve, &[Solve { liquids: self.liquids, columns: self.columns, groups }]);
    }

    /// Longest substep: [`SPEED_SHARE`] cfl spacing / |v|, a share of the time that a spacing of free fall takes, and of
    /// the period of the shortest capillary wave.
    pub fn limit_s(&self, spacing_m: f64, cfl: f64, speed_m_s: f64, acceleration_m_s2: f64, shortest_s: f64) -> f64 {
        let moving_s = SPEED_SHARE * cfl * spacing_m / speed_m_s.max(1e-9);
        let falling_s = (FALL_SHARE * (spacing_m / acceleration_m_s2.max(1e-9)).sqrt()).max(shortest_s);
        let waving_s = CAPILLARY * (spacing_m.powi(3) / (std::f64::consts::TAU * f64::from(self.tension_over_density).max(1e-12))).sqrt();
        moving_s.min(falling_s).min(waving_s)
    }

    /// Rounds of implicit viscosity that a substep takes, 0 where it is mild enough to be explicit.
    pub fn viscous_rounds(&self, cell_m: f64, dt_s: f64) -> u32 {
        let kinematic = f64::from(self.viscosity_pa_s) / f64::from(self.least_density_kg_m3);
        let stiff = f64::from(VISCOUS_BOUND * VISCOUS) * kinematic * dt_s / (cell_m * cell_m);
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
        let lists = [&self.neighbours, &self.slopes, &self.near];
        let press = |next: usize| {
            let own = [params, &self.solve, &self.place, &self.nature];
            let moved = [&self.density, &self.pressure, &self.predicted, &self.errors, &self.corrected, &self.turns[next]];
            gpu.bind(&p.sph_press, &[&own[..], &lists, &moved].concat())
        };
        let implicit = |present, next| {
            let own = [params, &self.solve, colliders, &self.place, &self.nature, &self.neighbours, &self.near];
            gpu.bind(&p.sph_implicit, &[&own[..], &[&self.corrected, present, next, &self.errors]].concat())
        };
        let corrected = [&self.density, &self.answer, &self.corrected, &self.pressure, &self.errors, &self.reached];
        let pushed = [&self.density, &self.pressure, &self.predicted];
        let moved = [matter, objects, colliders, kinematics, &self.kept, control];
        let places = [params, kinematics, matter, &solver.laws.table, &self.kept];
        let [even, odd] = &self.turns;
        let placed = [&self.place, &self.motion, &self.nature, &self.pressure, &self.errors, even, odd, &self.coarse];
        let cells = [params, &self.place, &self.nature, &grid.cell_start, &grid.cell_end, colliders, &self.solve];
        let found = [&self.density, &self.answer, control, &self.errors, &self.inward, &self.coarse];
        let tight = [&self.place, &self.nature, &self.neighbours, &self.near, &self.inward, &self.skin];
        let around = [params, &self.solve, matter, objects, colliders, &self.place, &self.nature];
        let forced = [&self.density, &self.pressure, &self.motion, &self.skin, &self.predicted, &self.corrected];
        SphBound {
            place: gpu.bind(&p.sph_place, &[&places[..], &placed].concat()),
            near: gpu.bind(&p.sph_near, &[&cells[..], &lists, &found].concat()),
            begin: gpu.bind(&p.sph_begin, &[params, &self.nature, &self.density]),
            skin: gpu.bind(&p.sph_skin, &[&[params, &self.solve], &tight[..]].concat()),
            forces: gpu.bind(&p.sph_forces, &[&around[..], &lists, &forced].concat()),
            foresee: gpu.bind(&p.sph_foresee, &[params, matter, &self.braking, &self.corrected, &self.slowed]),
            implicit: [implicit(&self.slowed, &self.motion), implicit(&self.motion, &self.slowed)],
            settle: gpu.bind(&p.sph_settle, &[params, &self.near, &self.slowed, &self.predicted, &self.corrected, matter, &self.braking]),
            press: [press(1), press(0)],
            correct: gpu.bind(&p.sph_correct, &[&[params, &self.solve, &self.place], &lists[..], &corrected].concat()),
            advance: gpu.bind(&p.sph_advance, &[&[params, &self.solve, &self.place, &self.nature], &lists[..], &pushed, &moved].concat()),
        }
    }

    /// Adds one substep, from sorted particles to moved ones; in the `first` of a segment some may be new to this.
    pub fn record(&self, b: &SphBound, substep: &Substep, plan: &Plan, first: bool, groups: [u32; 3], recording: &mut Recording) {
        let p = &self.passes;
        let job = |job: u32| Substep { job, ..*substep };
        recording.dispatch(&p.sph_place, &b.place, groups);
        recording.dispatch(&p.sph_near, &b.near, groups);
        if first {
            recording.dispatch(&p.sph_begin, &b.begin, groups);
        }
        // Without tension its buffer stays zero.
        if self.tension_over_density > 0.0 {
            recording.dispatch(&p.sph_skin, &b.skin, groups);
        }
        let implicit = plan.viscous_rounds > 0;
        recording.dispatch_with(&p.sph_forces, &b.forces, &job(u32::from(implicit)), groups);
        if implicit {
            recording.dispatch_with(&p.sph_foresee, &b.foresee, substep, groups);
            for round in 0..plan.viscous_rounds {
                recording.dispatch_with(&p.sph_implicit, &b.implicit[(round % 2) as usize], &job(round), groups);
            }
            recording.dispatch_with(&p.sph_settle, &b.settle, substep, groups);
        }
        // The first half of the first round came with the forces.
        recording.dispatch_with(&p.sph_correct, &b.correct, &job(0), groups);
        for round in 1..ROUNDS {
            let parity = (round % 2) as usize;
            if round < SPH_LEAST_ROUNDS {
                recording.dispatch_with(&p.sph_press, &b.press[parity], &job(round), groups);
                recording.dispatch_with(&p.sph_correct, &b.correct, &job(round), groups);
            } else {
                let at = u64::from(round) * size_of::<[u32; 4]>() as u64;
                recording.indirect_with(&p.sph_press, &b.press[parity], &job(round), &self.turns[parity], at);
                recording.indirect_with(&p.sph_correct, &b.correct, &job(round), &self.turns[parity], at);
            }
        }
        recording.dispatch_with(&p.sph_advance, &b.advance, substep, groups);
    }
}

/// The largest surface tension over density, m^3/s^2, whose waves substeps of this length follow.
pub(super) fn tension_over_density(cell_m: f32, dt_s: f64) -> f64 {
    (0.5 * f64::from(cell_m)).powi(3) * (CAPILLARY / dt_s).powi(2) / std::f64::consts::TAU
}

impl Solver {
    /// Takes note of what the particles are, after that was given or changed on the host.
    pub(super) fn survey(&mut self, states: &[ParticleState]) {
        if let Some(sph) = &mut self.sph {
            sph.survey(&self.laws.substances, states);
            sph.upload_solve(&self.gpu, states.len());
            if sph.tension_over_density == 0.0 {
                let mut recording = Recording::default();
                recording.clear(&sph.skin);
                self.gpu.submit(&recording);
            }
            self.params.has_liquid = u32::from(sph.liquids > 0);
        }
    }

    /// The smoothed particles' part, where there are any.
    pub(super) fn sph(&self) -> Option<&Sph> {
        self.sph.as_ref().filter(|s| s.liquids > 0)
    }

    /// Pressure of each particle of such a liquid at the end of the last substep, in the original order. 0 of all
    /// others.
    pub(super) fn liquid_pressures_pa(&self) -> Result<Vec<f32>, SolverError> {
        let count = self.params.count as usize;
        let Some(sph) = &self.sph else { return Ok(vec![0.0; count]) };
        Ok(self.gpu.read::<[f32; 4]>(&sph.kept, count)?.into_iter().map(|[pressure_pa, ..]| pressure_pa).collect())
    }

    /// Particles, by their index, that have just become such a liquid: without pressure, and as dense as they are.
    pub(super) fn pour(&self, new: &[usize]) -> Result<(), SolverError> {
        let Some(sph) = self.sph.as_ref().filter(|_| !new.is_empty()) else { return Ok(()) };
        let mut kept: Vec<[f32; 4]> = self.gpu.read(&sph.kept, self.params.count as usize)?;
        new.iter().for_each(|&i| kept[i] = UNNOTED);
        self.gpu.upload(&sph.kept, &kept);
        Ok(())
    }

    /// Whether any particle exchanges with the grid.
    pub(super) fn has_solids(&self) -> bool {
        self.sph.as_ref().is_none_or(|s| s.liquids < self.params.count)
    }

    /// Longer lists of neighbours, after a segment found them too short; false where there are none longer.
    pub(super) fn lengthen_lists(&mut self) -> Result<bool, SolverError> {
        let Some(sph) = self.sph.as_mut().filter(|s| s.columns < COLUMNS_MOST) else { return Ok(false) };
        let count = self.params.count as usize;
        let fours = 2 * sph.columns as usize * count;
        sph.neighbours = self.gpu.storage::<[u32; 4]>("solver.sph_neighbours", fours)?;
        sph.slopes = self.gpu.storage::<[f32; 4]>("solver.sph_slopes", fours)?;
        sph.columns *= 2;
        sph.upload_solve(&self.gpu, count);
        Ok(true)
    }
}
