//! The sort: `bin`, `scan_sums`, `scan_blocks`, `scan_cells`, `scatter` and `order`, in one go.

use super::base_node;
use crate::solver::core::Params;
use crate::solver::state::ParticleState;
use glam::{IVec3, UVec3};
use std::collections::BTreeSet;

/// What the sort leaves behind.
pub struct Sorted {
    /// Original indices in their new order.
    pub order: Vec<u32>,
    /// Blocks that particles may reach, ascending.
    pub active: Vec<u32>,
    /// (cell, first slot) of each occupied cell.
    pub starts: Vec<(u32, u32)>,
}

/// Index of a cell of the window in block-linear storage.
pub fn index(cell: UVec3, params: &Params) -> u32 {
    let (block, inner) = (cell / 4, cell % 4);
    let block = (block.z * params.blocks[1] + block.y) * params.blocks[0] + block.x;
    block * 64 + inner.z * 16 + inner.y * 4 + inner.x
}

/// Sorts particles by cell, within a cell by original index.
pub fn sort(states: &[ParticleState], params: &Params) -> Sorted {
    let cell_of = |s: &ParticleState| (base_node(s.position_m, params) - IVec3::from(params.origin)).as_uvec3();
    let mut keyed: Vec<(u32, u32)> = states.iter().map(|s| (index(cell_of(s), params), s.index)).collect();
    keyed.sort_unstable();
    let mut starts: Vec<(u32, u32)> = Vec::new();
    for (slot, &(cell, _)) in keyed.iter().enumerate() {
        if starts.last().is_none_or(|&(last, _)| last != cell) {
            starts.push((cell, slot as u32));
        }
    }
    let mut active = BTreeSet::new();
    for s in states {
        let (low, high) = (cell_of(s).as_ivec3() - params.slack, cell_of(s).as_ivec3() + 2 + params.slack);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    active.insert(index(IVec3::new(x, y, z).as_uvec3(), params) / 64);
                }
            }
        }
    }
    Sorted { order: keyed.into_iter().map(|(_, i)| i).collect(), active: active.into_iter().collect(), starts }
}
