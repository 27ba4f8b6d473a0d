//! As captured, so at rest: the stress that a captured thing already carries.
//!
//! The captured positions are held, and F0 is sought so that stress, weight and support balance at
//! every grid node, with the same transfers that the run uses: what balances here stays where it is
//! there. Each system is the linear stiffness of the present state, solved by conjugate gradients
//! whose pseudo masses follow the local stiffness; its solution deforms F, and the true stress says
//! what is left. Slender stems have modes a thousand times slower than the grid's fastest, which
//! relaxation in time would have to wait for.

use super::advance::Substep;
use super::constants::SLACK_CELLS;
use super::core::Solver;
use super::grid::GridBuffers;
use super::record::Bound;
use super::state::{ParticleState, RIGID_TAG};
use super::support::Support;
use super::types::{PrestressReport, SolverError};
use super::wary::mass_units;
use super::watch::Control;
use crate::Stop;
use crate::gpu::{Readback, Recording, Tier};
use bytemuck::{Pod, Zeroable};
use std::collections::{BTreeMap, BTreeSet};

/// `Search` of `shaders/solver/prestress.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct Search {
    alpha: f32,
    beta: f32,
    gamma: f32,
    gained: f32,
    left: f32,
    weight: f32,
    rounds: u32,
    done: u32,
    released: f32,
}

/// Share of the weight that nobody sees settle, though the search goes on below it.
const WORTH_SAYING: f32 = 1e-3;
/// Jobs of its passes, as `shaders/solver/prestress.wgsl` names them.
const SET_UP: u32 = 0;
const CURVATURE: u32 = 1;
const TURN: u32 = 2;
const ADOPT: u32 = 3;
/// vec4 that the search keeps for each node.
const VECTORS: usize = 5;
/// A system is settled when BATCH rounds gain less than this share of the energy gained so far; as many
/// rounds again square what error is left in its slow modes. Threads of a few particles go on settling
/// long after that, and are no longer waited for.
const SETTLED: f32 = 1e-3;
/// The search is over when a whole system gains less than this share: strains squared are accounted for.
const CONVERGED: f32 = 1e-2;
/// Modulus of a rigid part over that of the stiffest particle of its object, while the search runs.
const RIGID_OVER_SOFT: f32 = 8.0;
/// A particle is not started with less of its volume than this.
const LEAST_VOLUME: f32 = 0.3;
/// Nor with a larger entry of F - I.
const MOST_STRAIN: f32 = 0.6;
/// Systems in all: each lets go of the supports that would have to pull, and a wide base has many.
const SYSTEMS: u32 = 8;
/// Rounds of conjugate gradients in all systems together.
const ROUNDS: u32 = 4_000;
/// Rounds that energy is compared over.
const BATCH: u32 = 64;
/// Pseudo masses are those for which a step of 1 has this CFL number.
const CFL: f32 = 0.4;
/// Particle-rounds of one submit on a software adapter.
const CPU_BATCH: u32 = 600_000;

/// The bind groups of the search.
struct Groups {
    gather: wgpu::BindGroup,
    residual: wgpu::BindGroup,
    product: wgpu::BindGroup,
    control: wgpu::BindGroup,
    update: wgpu::BindGroup,
}

/// What the twin compares.
#[cfg(test)]
pub(super) struct Rounds {
    /// Particles as the search sees them.
    pub pseudo: Vec<ParticleState>,
    /// Displacement of each node that is stored.
    pub displacements: Vec<[f32; 4]>,
    /// Particles under the stress that the displacements bring.
    pub adopted: Vec<ParticleState>,
}

/// What a search works on.
struct Scene<'a> {
    grid: GridBuffers,
    bound: Bound,
    groups: Groups,
    search: wgpu::Buffer,
    stop: &'a Stop,
    round: u32,
}

impl Solver {
    /// Solves the prestress of objects that stand as captured, for the gravity and pins at t = 0.
    /// Called before [`Solver::place`]; positions stay to the bit. Objects that nothing supports stay
    /// free of stress, and the report says so.
    pub fn prestress(&mut self, objects: &[u32], stop: &Stop, progress: &mut dyn FnMut(f32)) -> Result<PrestressReport, SolverError> {
        let mut report = PrestressReport { converged: true, residual: 0.0, iterations: 0, hanging: Vec::new(), warnings: Vec::new() };
        if objects.is_empty() || self.settings.gravity_m_s2 == glam::Vec3::ZERO {
            return Ok(report);
        }
        let mut states = self.states()?;
        // What is wholly rigid carries any load as it is.
        let soft: BTreeSet<u32> = states.iter().filter(|s| !s.is_rigid()).map(ParticleState::object).collect();
        let objects: Vec<u32> = objects.iter().copied().filter(|o| soft.contains(o)).collect();
        if objects.is_empty() {
            return Ok(report);
        }
        let seen = self.look()?;
        self.fit_window(seen.low, seen.high, SLACK_CELLS + 3)?;
        self.set_surroundings();
        let Support { carried: supported, hanging } = self.support(&states, &objects);
        report.hanging = hanging;
        if supported.is_empty() {
            return Ok(report);
        }
        self.settle_offsets(&mut states, &supported);
        let carries = |s: &ParticleState| !s.is_rigid() && supported.contains(&s.object()) && self.laws.substances[s.substance()].can_stand();
        if !states.iter().any(carries) {
            // Heaps stand where they are, and carry nothing.
            self.replace(states);
            return Ok(report);
        }
        let kept = self.params;
        let result = self.search(&states, &supported, stop, progress, &mut report);
        self.params = kept;
        let found = result?;
        let mut unstressed: Vec<[f32; 12]> = self.gpu.read(&self.unstressed, states.len())?;
        for (i, (state, found)) in states.iter_mut().zip(&found).enumerate() {
            if supported.contains(&state.object()) && !state.is_rigid() && can_carry(found.f()) {
                state.deformation = found.deformation;
                state.history = self.laws.substances[state.substance()].history_with(state.f(), state.history);
                let inverse = state.f().as_dmat3().inverse().as_mat3().transpose();
                let rows = [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(|row| row.extend(0.0).to_array());
                unstressed[i] = bytemuck::cast(rows);
            }
        }
        self.gpu.upload(&self.unstressed, &unstressed);
        self.replace(states);
        if !report.converged && report.residual >= WORTH_SAYING {
            report.warnings.push(format!(
                "it will sag or shift a little in the first moments: {:.1} % of its weight found nothing to carry it as captured; \"stiffer\" makes that \
                 less, \"hold the base\" steadies it",
                report.residual * 100.0
            ));
        }
        Ok(report)
    }

    /// Runs the search on pseudo masses; the particles with the F that it found, in original order.
    fn search(
        &mut self,
        states: &[ParticleState],
        objects: &[u32],
        stop: &Stop,
        progress: &mut dyn FnMut(f32),
        report: &mut PrestressReport,
    ) -> Result<Vec<ParticleState>, SolverError> {
        let mut scene = self.begin(&self.pseudo_particles(states, objects), objects, stop)?;
        report.residual = residual(&self.first_system(&mut scene)?);
        let mut gained = 0.0;
        report.converged = false;
        for _ in 0..SYSTEMS {
            self.keep_matter();
            let gain = self.solve(&mut scene, gained, progress)?;
            gained += gain;
            let found = self.adopt(&mut scene)?;
            let left = residual(&found);
            // Supports that were let go of leave their force to the next system. Else: not even a smaller
            // residual, or none that is a number, and the last stress was better.
            let settled = found.released == 0.0;
            if left.is_nan() || settled && left >= report.residual {
                self.restore_matter();
                break;
            }
            report.residual = left;
            report.converged = settled && gain <= CONVERGED * gained;
            if report.converged || scene.round > ROUNDS || stop.raised() {
                break;
            }
        }
        report.iterations = scene.round;
        self.states()
    }

    /// Particles whose mass is a stiffness: V (lambda + 2 mu) / (C cell)^2, at rest under their weight.
    /// Rigid parts count as much stiffer than the soft ones that hang on them.
    fn pseudo_particles(&self, states: &[ParticleState], objects: &[u32]) -> Vec<ParticleState> {
        let mut pseudo = states.to_vec();
        let mut stiffest: BTreeMap<u32, f32> = BTreeMap::new();
        for state in states {
            let most = stiffest.entry(state.object()).or_default();
            *most = most.max(state.lambda_pa + 2.0 * state.mu_pa);
        }
        for state in &mut pseudo {
            let takes_part = objects.contains(&state.object()) && self.laws.substances[state.substance()].can_stand();
            if state.is_rigid() {
                // An elastic one for the time, that the grid sees. No Poisson effect: lambda is 0.
                state.tag &= !RIGID_TAG;
                state.mu_pa = 0.5 * RIGID_OVER_SOFT * stiffest[&state.object()];
            }
            let stiffness = state.volume_m3 * (state.lambda_pa + 2.0 * state.mu_pa) / (CFL * self.settings.cell_m).powi(2);
            let weight_ratio = if takes_part { state.mass_kg / stiffness } else { 0.0 };
            // What its law remembers is not asked for meanwhile, and is untouched in the states that go on.
            state.history = weight_ratio;
            state.mass_kg = if takes_part { stiffness } else { 0.0 };
            state.velocity_m_s = self.settings.gravity_m_s2 * weight_ratio;
            state.affine = [0.0; 9];
            if takes_part {
                state.set_f(glam::Mat3::IDENTITY);
            }
        }
        pseudo
    }

    /// Uploads pseudo particles, and the scales that suit their masses and their small displacements.
    fn begin<'a>(&mut self, pseudo: &[ParticleState], objects: &[u32], stop: &'a Stop) -> Result<Scene<'a>, SolverError> {
        let heaviest = pseudo.iter().map(|s| s.mass_kg).fold(0.0, f32::max);
        self.params.mass_units = mass_units(heaviest, 0);
        self.params.momentum_floor = heaviest * 1e-12;
        // What stands together as captured carries each other.
        self.params.layers = 1;
        self.set_pins(|_, object| if objects.contains(&object) { 0 } else { u32::MAX });
        self.buffers[self.current].upload(&self.gpu, pseudo);
        self.set_up(stop)
    }

    /// For the twin: some rounds of the first system, taken over.
    #[cfg(test)]
    pub(super) fn search_rounds(&mut self, states: &[ParticleState], rounds: u32) -> Result<Rounds, SolverError> {
        let (pseudo, stop) = (self.pseudo_particles(states, &[0]), Stop::default());
        let mut scene = self.begin(&pseudo, &[0], &stop)?;
        self.first_system(&mut scene)?;
        let mut recording = Recording::default();
        for _ in 0..rounds {
            self.record_round(&mut scene, &mut recording);
        }
        let hand_out = job(ADOPT, scene.round);
        recording.indirect_with(&self.passes.prestress_update, &scene.groups.update, &hand_out, &scene.grid.active_groups, 0);
        self.gpu.submit(&recording);
        let displacements = self.gpu.read(&scene.grid.velocity, (scene.grid.capacity + 1) * 64)?;
        self.adopt(&mut scene)?;
        Ok(Rounds { pseudo, displacements, adopted: self.states()? })
    }

    /// Sorts, and makes room for the search's vectors on the active blocks.
    fn set_up<'a>(&mut self, stop: &'a Stop) -> Result<Scene<'a>, SolverError> {
        let (grid, active) = loop {
            let Some(grid) = self.grid.clone() else {
                return Err(SolverError::Input { what: "no grid".to_owned(), expected: "a window".to_owned() });
            };
            self.start_segment();
            let mut recording = Recording::default();
            self.record_sort(&self.bind(&grid, self.current), &mut recording);
            self.gpu.submit(&recording);
            let active = self.gpu.read::<Control>(&self.control, 1)?[0].watch().blocks;
            if active <= grid.capacity {
                break (grid, active);
            }
            self.make_room(active, 0)?;
        };
        self.current = 1 - self.current;
        let nodes = self.gpu.storage::<[f32; 4]>("solver.prestress_nodes", VECTORS * 64 * active)?;
        let partial = self.gpu.storage::<[f32; 4]>("solver.prestress_partial", active)?;
        let search = self.gpu.storage::<Search>("solver.prestress_search", 1)?;
        let (gpu, p, params) = (&self.gpu, &self.passes, &self.params_buffer);
        let state = &self.buffers[self.current];
        let groups = Groups {
            gather: gpu.bind(&p.prestress_gather, &[params, &state.kinematics, &state.matter, &grid.velocity, &self.control, &self.laws.table]),
            residual: gpu.bind(
                &p.prestress_residual,
                &[
                    params,
                    &grid.active_blocks,
                    &self.colliders_buffer,
                    &self.pins_buffer,
                    &grid.sums,
                    &grid.marks,
                    &grid.velocity,
                    &self.control,
                    &nodes,
                    &partial,
                ],
            ),
            product: gpu.bind(&p.prestress_product, &[params, &grid.active_blocks, &grid.sums, &grid.marks, &self.control, &nodes, &partial]),
            control: gpu.bind(&p.prestress_control, &[params, &grid.active_blocks, &partial, &search]),
            update: gpu.bind(&p.prestress_update, &[params, &grid.active_blocks, &search, &grid.velocity, &nodes, &partial]),
        };
        let bound = self.bind(&grid, self.current);
        Ok(Scene { grid, bound, groups, search, stop, round: 0 })
    }

    /// Weight and supports of every node, from particles free of stress.
    fn first_system(&mut self, scene: &mut Scene) -> Result<Search, SolverError> {
        let mut recording = Recording::default();
        let zero = job(SET_UP, 0);
        recording.dispatch_with(&self.passes.stress, &scene.bound.stress, &zero, self.particle_groups());
        self.record_system(scene, SET_UP, &mut recording);
        self.gpu.submit(&recording);
        self.read_search(scene)
    }

    /// Force left over under the present stress.
    fn record_system(&self, scene: &Scene, which: u32, recording: &mut Recording) {
        let substep = job(which, scene.round);
        self.record_p2g(&scene.bound, &substep, recording);
        recording.indirect_with(&self.passes.prestress_residual, &scene.groups.residual, &substep, &scene.grid.active_groups, 0);
        recording.dispatch_with(&self.passes.prestress_control, &scene.groups.control, &substep, [1, 1, 1]);
    }

    /// Rounds of conjugate gradients until the system is solved, the budget is spent, or it is stopped.
    /// The energy gained.
    fn solve(&mut self, scene: &mut Scene, before: f32, progress: &mut dyn FnMut(f32)) -> Result<f32, SolverError> {
        let batch = match self.gpu.tier {
            Tier::Cpu => (CPU_BATCH / self.params.count).clamp(1, BATCH),
            Tier::Gpu => BATCH,
        };
        let (mut gained, first, mut last) = (0.0, scene.round, ROUNDS);
        if first > last || scene.stop.raised() {
            return Ok(gained);
        }
        let mut rounds = self.rounds(scene, batch);
        loop {
            self.gpu.queue.submit([rounds]);
            let (round, back) = (scene.round, Readback::start(&self.gpu, &[(&scene.search, size_of::<Search>() as u64)]));
            // Made ready while the device works on those before.
            rounds = self.rounds(scene, batch);
            let search: Search = back.arrive(&self.gpu)?.part(0, bytemuck::pod_read_unaligned)?;
            let rate = (search.gained - gained) * (BATCH / batch) as f32;
            gained = search.gained;
            progress(round as f32 / ROUNDS as f32);
            if last == ROUNDS && rate <= SETTLED * (before + gained) {
                last = (2 * round - first).min(ROUNDS - 1);
            }
            if search.done != 0 || round > last || scene.stop.raised() {
                // The rounds that were made ready are not needed.
                scene.round = round;
                return Ok(gained);
            }
        }
    }

    /// The next rounds, ready to be submitted.
    fn rounds(&self, scene: &mut Scene, batch: u32) -> wgpu::CommandBuffer {
        let mut recording = Recording::default();
        for _ in 0..batch {
            self.record_round(scene, &mut recording);
        }
        self.gpu.encode(&recording)
    }

    fn record_round(&self, scene: &mut Scene, recording: &mut Recording) {
        let (passes, groups) = (&self.passes, self.particle_groups());
        let before = job(CURVATURE, scene.round);
        scene.round += 1;
        let (now, turn) = (job(CURVATURE, scene.round), job(TURN, scene.round));
        let (blocks, scene) = (&scene.grid.active_groups, &*scene);
        recording.dispatch_with(&passes.prestress_gather, &scene.groups.gather, &before, groups);
        self.record_p2g(&scene.bound, &now, recording);
        recording.indirect_with(&passes.prestress_product, &scene.groups.product, &now, blocks, 0);
        recording.dispatch_with(&passes.prestress_control, &scene.groups.control, &now, [1, 1, 1]);
        recording.indirect_with(&passes.prestress_update, &scene.groups.update, &now, blocks, 0);
        recording.dispatch_with(&passes.prestress_control, &scene.groups.control, &turn, [1, 1, 1]);
        recording.indirect_with(&passes.prestress_update, &scene.groups.update, &turn, blocks, 0);
    }

    /// Deforms F by the solution and measures what is left.
    fn adopt(&mut self, scene: &mut Scene) -> Result<Search, SolverError> {
        let mut recording = Recording::default();
        let substep = job(ADOPT, scene.round);
        recording.indirect_with(&self.passes.prestress_update, &scene.groups.update, &substep, &scene.grid.active_groups, 0);
        recording.dispatch_with(&self.passes.prestress_gather, &scene.groups.gather, &substep, self.particle_groups());
        scene.round += 1;
        self.record_system(scene, ADOPT, &mut recording);
        self.gpu.submit(&recording);
        self.read_search(scene)
    }

    fn read_search(&self, scene: &Scene) -> Result<Search, SolverError> {
        Ok(self.gpu.read::<Search>(&scene.search, 1)?[0])
    }

    fn keep_matter(&self) {
        self.copy_state(&self.buffers[self.current], &self.backup);
    }

    fn restore_matter(&self) {
        self.copy_state(&self.backup, &self.buffers[self.current]);
    }
}

/// Root mean square of what acceleration is left, as a share of gravity's.
fn residual(search: &Search) -> f32 {
    (search.left / search.weight).sqrt()
}

/// Immediates of a pass of the search.
fn job(job: u32, index: u32) -> Substep {
    Substep { dt_s: 0.0, dt_next_s: 0.0, index, job, since_s: 0.0, lag: 0 }
}

/// Whether a particle can start under this deformation. Slivers at the rim of a solid, whose nodes
/// hold almost no matter, may come out crushed or without a number; they weigh nothing to speak of and
/// start free of stress.
fn can_carry(f: glam::Mat3) -> bool {
    f.is_finite() && f.determinant() > LEAST_VOLUME && (f - glam::Mat3::IDENTITY).abs_diff_eq(glam::Mat3::ZERO, MOST_STRAIN)
}
