//! What one substep records, and what its passes are bound to.

use super::advance::{Plan, Substep};
use super::constants::{SCAN_LANES, SCAN_RUN};
use super::core::Solver;
use super::fields::When;
use super::grid::GridBuffers;
use super::liquid::LiquidBound;
use super::rigid::RigidBound;
use super::sph::SphBound;
use super::transfer::TransferBound;
use super::types::SolverError;
use super::volume::VolumeBound;
use crate::gpu::Recording;

/// The bind groups of the passes over one of the two state buffers.
pub(super) struct Bound {
    pub rigid: Option<RigidBound>,
    pub active_groups: wgpu::Buffer,
    /// Where a scene has fields.
    pub fields: Option<wgpu::BindGroup>,
    pub encounter: Option<wgpu::BindGroup>,
    bin: wgpu::BindGroup,
    scan_sums: wgpu::BindGroup,
    scan_blocks: wgpu::BindGroup,
    count: wgpu::BindGroup,
    scan_cells: wgpu::BindGroup,
    scatter: wgpu::BindGroup,
    order: wgpu::BindGroup,
    regroup: wgpu::BindGroup,
    pub stress: wgpu::BindGroup,
    pub grid: wgpu::BindGroup,
    pub transfers: TransferBound,
    pub liquid: Option<LiquidBound>,
    pub volume: Option<VolumeBound>,
    pub sph: Option<SphBound>,
}

impl Solver {
    pub(super) fn record_substep(&mut self, plan: &Plan, step: u32, bound: &[Bound; 2], recording: &mut Recording) {
        let sorts = step.is_multiple_of(plan.sort_every);
        let substep = Substep {
            dt_s: plan.dt_of(step),
            dt_next_s: plan.dt_of(step + 1),
            index: self.substep,
            job: 0,
            since_s: plan.time_s(step) as f32,
            lag: u32::from(step > 0 && self.fuses(plan, step - 1)),
        };
        if step == 0 {
            self.rigid.iter().zip(&bound[self.current].rigid).for_each(|(r, b)| r.record_start(b, &substep, recording));
        }
        if self.soft && sorts {
            let b = &bound[self.current];
            match step > 0 && self.regroups() {
                true => self.record_regroup(b, recording),
                false => self.record_sort(b, recording),
            }
            self.current = 1 - self.current;
        }
        let b = &bound[self.current];
        if let Some(liquid) = b.liquid.as_ref().filter(|_| step.is_multiple_of(plan.pour_every)) {
            let span_s = plan.time_s((step + plan.pour_every).min(plan.substeps)) - plan.time_s(step);
            self.record_liquid(liquid, &b.active_groups, span_s as f32, recording);
        }
        if let Some(volume) = b.volume.as_ref().filter(|_| sorts) {
            self.record_volume(volume, recording);
        }
        if self.soft {
            self.record_soft(b, plan, step, &substep, recording);
        }
        self.rigid.iter().zip(&b.rigid).for_each(|(r, b)| r.record_substep(b, &substep, self.params.count, recording));
        self.record_fields(b, &substep, recording);
        self.substep += 1;
    }

    /// Whether one pass ends a substep and sums for the next: where nothing comes between.
    fn fuses(&self, plan: &Plan, step: u32) -> bool {
        let next = step + 1;
        let alone = self.fields.is_none() && self.sph().is_none();
        alone && self.transfers.fuse() && next < plan.substeps && !next.is_multiple_of(plan.sort_every)
    }

    /// One substep of everything that is not rigid.
    fn record_soft(&self, b: &Bound, plan: &Plan, step: u32, substep: &Substep, recording: &mut Recording) {
        let (passes, groups) = (&self.passes, self.particle_groups());
        if step == 0 {
            recording.dispatch_with(&passes.stress, &b.stress, &Substep { dt_next_s: substep.dt_s, ..*substep }, groups);
        }
        if let (Some(sph), Some(bound)) = (self.sph(), &b.sph) {
            sph.record(bound, substep, plan, step == 0, groups, recording);
        }
        if self.has_solids() {
            if substep.lag == 0 {
                self.record_p2g(b, substep, recording);
            }
            self.rigid.iter().zip(&b.rigid).for_each(|(r, b)| r.record_meeting(b, substep, groups, recording));
            recording.indirect_with(&passes.grid, &b.grid, substep, &b.active_groups, 0);
            if let Some(liquid) = &b.liquid {
                self.record_walls(liquid, &b.active_groups, recording);
            }
            if let (Some(encounter), Some(bindings)) = (&self.encounter, &b.encounter) {
                recording.indirect_with(&encounter.passes.encounter, bindings, substep, &b.active_groups, 0);
            }
            match self.fuses(plan, step) {
                true => self.record_fused(b, substep, recording),
                false => self.record_g2p(b, substep, recording),
            }
        }
    }

    /// Puts the particles in the order of their cells and stores the blocks that they may reach.
    pub(super) fn record_sort(&self, b: &Bound, recording: &mut Recording) {
        let groups = self.particle_groups();
        self.record_blocks(b, recording);
        recording.dispatch(&self.passes.count, &b.count, groups);
        recording.indirect(&self.passes.scan_cells, &b.scan_cells, &b.active_groups, 0);
        recording.dispatch(&self.passes.scatter, &b.scatter, groups);
        recording.dispatch(&self.passes.order, &b.order, groups);
    }

    /// Whether it is enough that the particles of a block lie together: where nobody asks for those of a cell, nor adds up in
    /// their order.
    fn regroups(&self) -> bool {
        self.transfers.by_block() && self.sph().is_none() && self.rigid.is_none()
    }

    /// Puts the particles of each block together again and stores the blocks that they may reach.
    pub(super) fn record_regroup(&self, b: &Bound, recording: &mut Recording) {
        self.record_blocks(b, recording);
        recording.dispatch(&self.passes.regroup, &b.regroup, self.particle_groups());
    }

    /// Finds the blocks that the particles may reach, and where each is stored.
    pub(super) fn record_blocks(&self, b: &Bound, recording: &mut Recording) {
        let blocks = self.params.blocks.iter().product::<u32>() * self.params.layers;
        let chunks = [blocks.div_ceil(SCAN_LANES * SCAN_RUN), 1, 1];
        recording.dispatch(&self.passes.bin, &b.bin, self.particle_groups());
        recording.dispatch(&self.passes.scan_sums, &b.scan_sums, chunks);
        recording.dispatch(&self.passes.scan_blocks, &b.scan_blocks, chunks);
    }

    /// Everything bound, for either of the two state buffers.
    pub(super) fn bind_both(&self) -> Result<[Bound; 2], SolverError> {
        let Some(grid) = &self.grid else {
            return Err(SolverError::Input { what: "no grid".to_owned(), expected: "a window".to_owned() });
        };
        Ok([self.bind(grid, 0), self.bind(grid, 1)])
    }

    /// Everything bound, for particles that lie in one of the two state buffers.
    pub(super) fn bind(&self, grid: &GridBuffers, current: usize) -> Bound {
        let (gpu, p, params) = (&self.gpu, &self.passes, &self.params_buffer);
        let (state, other) = (&self.buffers[current], &self.buffers[1 - current]);
        let (kinematics, matter) = (&state.kinematics, &state.matter);
        let (laws, control) = (&self.laws, &self.control);
        let stress = [params, kinematics, matter, control, &laws.table, &laws.activations];
        let mut on_grid = vec![
            params,
            &grid.active_blocks,
            &self.colliders_buffer,
            &self.pins_buffer,
            &grid.sums,
            &grid.marks,
            &grid.velocity,
            control,
            &grid.masses,
        ];
        on_grid.extend(grid.liquid.iter().flat_map(|l| [&l.pull, &l.film]));
        Bound {
            rigid: self.rigid.as_ref().map(|r| r.bind(self, grid, current)),
            active_groups: grid.active_groups.clone(),
            fields: self.fields.as_ref().map(|f| f.bind(self, state, When::Now)),
            encounter: self.encounter.as_ref().map(|e| e.bind(self, grid)),
            bin: gpu.bind(&p.bin, &[params, kinematics, matter, &grid.block_info, control, &self.number_in_block]),
            scan_sums: gpu.bind(&p.scan_sums, &[params, &grid.block_info, &grid.chunk_sums]),
            scan_blocks: gpu.bind(
                &p.scan_blocks,
                &[params, &grid.block_info, &grid.chunk_sums, &grid.block_start, &grid.active_blocks, &grid.items, &grid.active_groups, control],
            ),
            count: gpu.bind(&p.count, &[params, kinematics, matter, &grid.cell_count]),
            scan_cells: gpu
                .bind(&p.scan_cells, &[params, &grid.active_blocks, &grid.block_start, &grid.cell_count, &grid.cell_start, &grid.cell_end, control]),
            scatter: gpu.bind(&p.scatter, &[params, kinematics, matter, &grid.cell_count, &grid.cell_start, &self.slots]),
            order: gpu.bind(
                &p.order,
                &[
                    params,
                    &self.slots,
                    kinematics,
                    matter,
                    &other.kinematics,
                    &other.matter,
                    &grid.block_start,
                    &grid.cell_end,
                    control,
                    &grid.cell_start,
                ],
            ),
            regroup: gpu
                .bind(&p.regroup, &[params, kinematics, matter, &other.kinematics, &other.matter, &grid.block_start, &self.number_in_block, control]),
            stress: gpu.bind(&p.stress, &stress[..if laws.all { 6 } else { 5 }]),
            grid: gpu.bind(&p.grid, &on_grid),
            liquid: self.bind_liquid(grid, state),
            volume: self.bind_volume(grid, state),
            transfers: self.transfers.bind(self, grid, state),
            sph: self.sph().map(|sph| sph.bind(self, grid, current)),
        }
    }
}
