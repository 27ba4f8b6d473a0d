//! The sort: `bin`, `scan_sums`, `scan_blocks`, `count`, `scan_cells`, `scatter` and `order`, in one go.

use super::base_node;
use crate::solver::constants::DEALT;
use crate::solver::core::Params;
use crate::solver::state::ParticleState;
use glam::{IVec3, UVec3};
use std::collections::BTreeSet;

/// What the sort leaves behind.
pub struct Sorted {
    /// Original indices in their new order.
    pub order: Vec<u32>,
    /// Numbers of the blocks that particles may reach, ascending; the first is stored as block 1.
    pub active: Vec<u32>,
    /// (cell as it is stored, first slot) of each occupied cell.
    pub starts: Vec<(u32, u32)>,
}

/// Number of the block of a layer that a cell of the window lies in.
pub fn block_number(cell: UVec3, layer: u32, params: &Params) -> u32 {
    let (block, [across, along, up]) = (cell / 4, params.blocks);
    ((layer * up + block.z) * along + block.y) * across + block.x
}

/// Place of a cell within its block.
pub fn inner(cell: UVec3) -> u32 {
    let inner = cell % 4;
    inner.z * 16 + inner.y * 4 + inner.x
}

/// Sorts particles by cell, within a cell by original index.
pub fn sort(states: &[ParticleState], params: &Params) -> Sorted {
    let cell_of = |s: &ParticleState| (base_node(s.position_m, params) - IVec3::from(params.origin)).as_uvec3();
    let layer_of = |s: &ParticleState| {
        let object = (s.object() % DEALT) as usize;
        (params.layer_of[object / 8] >> (4 * (object % 8)) & 15) % params.layers
    };
    let mut active = BTreeSet::new();
    for s in states {
        let (low, high) = (cell_of(s).as_ivec3() - params.slack, cell_of(s).as_ivec3() + 2 + params.slack);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let cell = IVec3::new(x, y, z).as_uvec3();
                    active.insert(block_number(cell, layer_of(s), params));
                    if params.pools != 0 {
                        active.insert(block_number(cell, 0, params));
                    }
                }
            }
        }
    }
    let active: Vec<u32> = active.into_iter().collect();
    let slot = |block: u32| active.binary_search(&block).map_or(0, |k| k as u32 + 1);
    let into = |s: &ParticleState| if params.has_liquid != 0 { 0 } else { layer_of(s) };
    let stored = |s: &ParticleState| slot(block_number(cell_of(s), into(s), params)) * 64 + inner(cell_of(s));
    let mut keyed: Vec<(u32, u32)> = states.iter().map(|s| (stored(s), s.index)).collect();
    keyed.sort_unstable();
    let mut starts: Vec<(u32, u32)> = Vec::new();
    for (slot, &(cell, _)) in keyed.iter().enumerate() {
        if starts.last().is_none_or(|&(last, _)| last != cell) {
            starts.push((cell, slot as u32));
        }
    }
    Sorted { order: keyed.into_iter().map(|(_, i)| i).collect(), active, starts }
}
