//! Particles to grid and back, in one of two forms.
//!
//! On a software adapter a thread takes a particle, and what lies in one cell is summed along the subgroup. On a
//! GPU a workgroup takes the particles of one block, and sums in a tile of workgroup memory (Gao et al. 2018): what
//! leaves it for the grid is 512 nodes, not 27 a particle. Between two sorts one pass there ends a substep and sums for
//! the next (Wang et al. 2020). Both forms write the same grid.

use super::advance::Substep;
use super::core::Solver;
use super::grid::GridBuffers;
use super::passes::SUBSTEP;
use super::record::Bound;
use super::state::StateBuffers;
use crate::gpu::{Gpu, Kernel, KernelSource, Recording, Tier};

mod cell {
    use super::SUBSTEP;
    passes! {
        /// A thread for each particle.
        CellPasses;
        p2g: ["control", "substep", "substance", "hash", "particle", "contact", "on_grid", "marks", "p2g"] [Read, Read, Read, Read, Write, Write, Write, Read] SUBSTEP;
        g2p: ["control", "substep", "substance", "material", "elastic_only", "particle", "particle_write", "contact", "gather", "move", "g2p"] [Read, Write, Write, Read, Read, Read, Write, Read] SUBSTEP;
    }
}

mod cell_laws {
    use super::SUBSTEP;
    passes! {
        /// The same, with all laws.
        CellLawPasses;
        g2p_laws: ["control", "substep", "substance", "material", "particle", "particle_write", "svd", "hencky", "law_plastic", "law_viscoplastic", "law_sand", "law_snow", "law_muscle", "cube_root", "law_liquid", "laws", "activation", "g2p_laws", "remember", "contact", "gather", "move", "g2p"] [Read, Write, Write, Read, Read, Read, Write, Read, Read, Write] SUBSTEP;
    }
}

mod tile {
    use super::SUBSTEP;
    passes! {
        /// A workgroup for the particles of a block.
        TilePasses;
        p2g_tile: ["control", "substep", "substance", "hash", "particle", "contact", "on_grid", "marks", "tile", "tile_scatter", "p2g_tile"] [Read, Read, Read, Read, Write, Write, Write, Read, Read] SUBSTEP;
        g2p_tile: ["control", "substep", "substance", "material", "elastic_only", "particle", "particle_write", "contact", "gather", "move", "tile", "tile_gather", "g2p_tile"] [Read, Write, Write, Read, Read, Read, Write, Read, Read] SUBSTEP;
    }
}

mod tile_laws {
    use super::SUBSTEP;
    passes! {
        /// The same, with all laws.
        TileLawPasses;
        g2p_tile_laws: ["control", "substep", "substance", "material", "particle", "particle_write", "svd", "hencky", "law_plastic", "law_viscoplastic", "law_sand", "law_snow", "law_muscle", "cube_root", "law_liquid", "laws", "activation", "g2p_tile_laws", "remember", "contact", "gather", "move", "tile", "tile_gather", "g2p_tile"] [Read, Write, Write, Read, Read, Read, Write, Read, Read, Read, Write] SUBSTEP;
    }
}

mod fused {
    use super::SUBSTEP;
    passes! {
        /// From the grid to particles and back to the grid.
        FusedPasses;
        fused: ["control", "substep", "substance", "hash", "material", "elastic_only", "particle", "particle_write", "contact", "on_grid", "marks", "gather", "move", "tile", "tile_gather", "tile_scatter", "fused"] [Read, Write, Write, Read, Read, Read, Write, Read, Read, Write, Write] SUBSTEP;
    }
}

mod fused_laws {
    use super::SUBSTEP;
    passes! {
        /// The same, with all laws.
        FusedLawPasses;
        fused_laws: ["control", "substep", "substance", "hash", "material", "particle", "particle_write", "svd", "hencky", "law_plastic", "law_viscoplastic", "law_sand", "law_snow", "law_muscle", "cube_root", "law_liquid", "laws", "activation", "fused_laws", "remember", "contact", "on_grid", "marks", "gather", "move", "tile", "tile_gather", "tile_scatter", "fused"] [Read, Write, Write, Read, Read, Read, Write, Read, Read, Write, Write, Read, Write] SUBSTEP;
    }
}

/// Every pass of this file, for validation and keys.
pub(super) fn kernels() -> Vec<KernelSource> {
    [cell::kernels(), cell_laws::kernels(), tile::kernels(), tile_laws::kernels(), fused::kernels(), fused_laws::kernels()].concat()
}

/// Those that every solver on a device asks for.
pub(super) fn usual(gpu: &Gpu) -> Vec<KernelSource> {
    match gpu.tier {
        Tier::Cpu => cell::kernels(),
        Tier::Gpu => [tile::kernels(), fused::kernels()].concat(),
    }
}

/// The transfers of one form.
#[derive(Clone, Debug)]
pub(super) struct Transfers {
    by_block: bool,
    p2g: Kernel,
    g2p: Kernel,
    /// From the grid to particles and back to the grid.
    fused: Option<Kernel>,
}

/// Their bind groups over one of the two state buffers.
pub(super) struct TransferBound {
    p2g: wgpu::BindGroup,
    g2p: wgpu::BindGroup,
    fused: Option<wgpu::BindGroup>,
    groups: wgpu::Buffer,
}

/// Workgroup memory that a pass with two tiles takes.
const FUSED_BYTES: u32 = 20 << 10;
/// Where the counts of workgroups by item lie behind those by block.
const ITEM_GROUPS: u64 = 16;

impl Transfers {
    /// Of elastic matter.
    pub fn new(gpu: &Gpu) -> Transfers {
        match gpu.tier {
            Tier::Cpu => {
                let cell::CellPasses { p2g, g2p } = cell::CellPasses::new(gpu);
                Transfers { by_block: false, p2g, g2p, fused: None }
            }
            Tier::Gpu => {
                let tile::TilePasses { p2g_tile, g2p_tile } = tile::TilePasses::new(gpu);
                let fused = (gpu.device.limits().max_compute_workgroup_storage_size >= FUSED_BYTES).then(|| fused::FusedPasses::new(gpu).fused);
                Transfers { by_block: true, p2g: p2g_tile, g2p: g2p_tile, fused }
            }
        }
    }

    /// Compiles what matter of other laws takes.
    pub fn know_all_laws(&mut self, gpu: &Gpu) {
        match gpu.tier {
            Tier::Cpu => self.g2p = cell_laws::CellLawPasses::new(gpu).g2p_laws,
            Tier::Gpu => {
                self.g2p = tile_laws::TileLawPasses::new(gpu).g2p_tile_laws;
                self.fused = self.fused.take().map(|_| fused_laws::FusedLawPasses::new(gpu).fused_laws);
            }
        }
    }

    /// Whether a workgroup takes the particles of a block.
    pub fn by_block(&self) -> bool {
        self.by_block
    }

    /// Whether one pass may do both.
    pub fn fuse(&self) -> bool {
        self.fused.is_some()
    }

    pub fn bind(&self, solver: &Solver, grid: &GridBuffers, state: &StateBuffers) -> TransferBound {
        let (gpu, params, control, laws) = (&solver.gpu, &solver.params_buffer, &solver.control, &solver.laws);
        let (kinematics, matter) = (&state.kinematics, &state.matter);
        let mut p2g = vec![params, kinematics, matter, &solver.colliders_buffer, &grid.sums, &grid.marks, control, &laws.table];
        let mut g2p = vec![params, kinematics, matter, &grid.velocity, &solver.colliders_buffer, &solver.objects_buffer, control, &laws.table];
        if self.by_block {
            p2g.push(&grid.items);
            g2p.push(&grid.items);
        }
        let mut fused = [&g2p[..], &[&grid.sums, &grid.marks]].concat();
        if laws.all {
            g2p.extend([&laws.activations, laws.shown()]);
            fused.extend([&laws.activations, laws.shown()]);
        }
        let fused = self.fused.as_ref().map(|kernel| gpu.bind(kernel, &fused));
        TransferBound { p2g: gpu.bind(&self.p2g, &p2g), g2p: gpu.bind(&self.g2p, &g2p), fused, groups: grid.active_groups.clone() }
    }
}

impl Solver {
    /// Adds the pass from particles to grid.
    pub(super) fn record_p2g(&self, b: &Bound, substep: &Substep, recording: &mut Recording) {
        self.record_transfer(&self.transfers.p2g, &b.transfers.p2g, &b.transfers.groups, substep, recording);
    }

    /// Adds the pass from the grid to particles.
    pub(super) fn record_g2p(&self, b: &Bound, substep: &Substep, recording: &mut Recording) {
        self.record_transfer(&self.transfers.g2p, &b.transfers.g2p, &b.transfers.groups, substep, recording);
    }

    /// Adds the pass that does both, where there is one.
    pub(super) fn record_fused(&self, b: &Bound, substep: &Substep, recording: &mut Recording) {
        if let (Some(fused), Some(bindings)) = (&self.transfers.fused, &b.transfers.fused) {
            self.record_transfer(fused, bindings, &b.transfers.groups, substep, recording);
        }
    }

    fn record_transfer(&self, kernel: &Kernel, bindings: &wgpu::BindGroup, groups: &wgpu::Buffer, substep: &Substep, recording: &mut Recording) {
        match self.transfers.by_block {
            true => recording.indirect_with(kernel, bindings, substep, groups, ITEM_GROUPS),
            false => recording.dispatch_with(kernel, bindings, substep, self.particle_groups()),
        }
    }
}
