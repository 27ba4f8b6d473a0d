//! How far each voxel of a solid is from where the solid stands, along a way inside the solid.

use super::grid::Grid;
use glam::IVec3;

/// A step over a face; over an edge it is 4 and over a corner 5: within 6 % of the distance (Borgefors 1986).
pub(super) const STEP: u32 = 3;
/// Share of a solid's height, from its lowest voxel, that it stands on.
const BASE_SHARE: f32 = 0.015;
/// Not reached.
const FAR: u32 = u32::MAX;

/// The way to each voxel of the solid, [`STEP`] a voxel. Pieces that hang on nothing stand on their own lowest voxels.
pub(super) fn from_base(grid: &Grid, solid: &[bool]) -> Vec<u32> {
    let slab = grid.slab();
    let mut way = vec![FAR; solid.len()];
    let (Some(first), Some(last)) = (solid.iter().position(|&s| s), solid.iter().rposition(|&s| s)) else { return way };
    let base = 1 + (BASE_SHARE * (last / slab - first / slab) as f32) as usize;
    let mut from = first;
    while let Some(lowest) = (from..solid.len()).find(|&v| solid[v] && way[v] == FAR) {
        let floor = (lowest / slab + base) * slab;
        let seeds = (lowest..floor.min(solid.len())).filter(|&v| solid[v] && way[v] == FAR).map(|v| v as u32).collect();
        spread(grid, solid, &mut way, seeds);
        from = lowest;
    }
    way
}

/// Goes on from seeds, nearest first, to everything that is nearer from there (Dial 1969).
fn spread(grid: &Grid, solid: &[bool], way: &mut [u32], seeds: Vec<u32>) {
    let around = Around::new(grid);
    seeds.iter().for_each(|&v| way[v as usize] = 0);
    let mut buckets = vec![seeds];
    let mut at = 0;
    while at < buckets.len() {
        for voxel in std::mem::take(&mut buckets[at]) {
            if way[voxel as usize] as usize != at {
                continue;
            }
            for (near, step) in around.of(voxel) {
                let length = at + step as usize;
                let Some(known) = way.get_mut(near as usize) else { continue };
                if *known as usize > length && solid[near as usize] {
                    *known = length as u32;
                    buckets.resize_with(buckets.len().max(length + 1), Vec::new);
                    buckets[length].push(near);
                }
            }
        }
        at += 1;
    }
}

/// The 26 voxels that touch one, as steps of an index and of the way.
pub(super) struct Around([(u32, u32); 26]);

impl Around {
    pub fn new(grid: &Grid) -> Around {
        let (row, slab) = (grid.size.x as i32, grid.slab() as i32);
        let offset = |k: i32| IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        let step = |o: IVec3| ((o.x + o.y * row + o.z * slab) as u32, STEP - 1 + o.abs().element_sum() as u32);
        Around(std::array::from_fn(|k| step(offset(if k < 13 { k as i32 } else { k as i32 + 1 }))))
    }

    /// The neighbours of a voxel of a solid, with the way to them. Those below the floor have an index out of range.
    pub fn of(&self, voxel: u32) -> impl Iterator<Item = (u32, u32)> {
        self.0.iter().map(move |&(step, way)| (voxel.wrapping_add(step), way))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec3, Vec3};

    #[test]
    fn the_way_goes_round_what_is_not_solid() {
        let grid = Grid { low: Vec3::ZERO, voxel_m: 1.0, size: UVec3::new(30, 10, 30) };
        // An arch: up, across, and down again to a voxel above the floor; a speck beside it.
        let arch =
            |v: UVec3| v.y == 4 && ((v.x == 3 && v.z <= 20) || (v.z == 20 && (3..=20).contains(&v.x)) || (v.x == 20 && (5..=20).contains(&v.z)));
        let solid: Vec<bool> = (0..grid.len()).map(|i| arch(grid.voxel(i)) || grid.voxel(i) == UVec3::new(26, 4, 10)).collect();
        let way = from_base(&grid, &solid);
        let at = |x, z| way[grid.index(UVec3::new(x, 4, z))];
        assert_eq!((at(3, 0), at(3, 10), at(10, 0)), (0, 30, FAR));
        // A corner is cut once: two faces become an edge.
        assert_eq!(at(20, 5), 3 * (20 + 17 + 15) - 4);
        assert_eq!(at(26, 10), 0);
    }
}
