//! Threads as thick as what the Gaussians can tell.
//!
//! Two voxels are one spacing of the Gaussians, and a thread or sheet that comes out thinner owes it to
//! where the voxels happen to lie. One voxel across bends sixteen times as easily as two.

use super::grid::Grid;
use glam::UVec3;

/// Lets every voxel of the solid lie in a full cube of two voxels a side: where it does not, the cube
/// that is fullest already is filled, in the order of the voxels. The border stays free.
pub(super) fn thicken(grid: &Grid, solid: &mut [bool]) {
    let thin: Vec<usize> = (0..solid.len()).filter(|&i| solid[i]).collect();
    for voxel in thin {
        let fullest = cubes(grid, grid.voxel(voxel))
            .map(|cube| (cube.iter().filter(|&&i| solid[i]).count(), cube))
            .reduce(|a, b| if b.0 > a.0 { b } else { a });
        if let Some((full, cube)) = fullest
            && full < 8
        {
            for i in cube {
                solid[i] = true;
            }
        }
    }
}

/// The cubes of two voxels a side that hold a voxel and keep off the border; the floor is none.
fn cubes(grid: &Grid, voxel: UVec3) -> impl Iterator<Item = [usize; 8]> {
    let corner = |n: u32| UVec3::new(n & 1, n >> 1 & 1, n >> 2);
    (0..8).filter_map(move |n| {
        let low = (voxel + 1).checked_sub(corner(n) + 1)?;
        let free = (0..8).all(|k| !grid.on_border(low + corner(k)));
        free.then(|| std::array::from_fn(|k| grid.index(low + corner(k as u32))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_thread_becomes_two_voxels_thick_and_what_is_thick_stays() {
        let grid = Grid { low: Vec3::ZERO, voxel_m: 0.1, size: UVec3::new(12, 12, 20) };
        // A block with a leaning thread on it.
        let block = |v: UVec3| v.cmpge(UVec3::new(2, 2, 0)).all() && v.cmplt(UVec3::new(7, 7, 5)).all();
        let thread = |v: UVec3| v.z >= 5 && v.z < 15 && v.x == 4 + (v.z - 5) / 3 && v.y == 4;
        let mut solid: Vec<bool> = (0..grid.len()).map(|i| block(grid.voxel(i)) || thread(grid.voxel(i))).collect();
        let before = solid.clone();
        thicken(&grid, &mut solid);
        for (i, (&now, &then)) in solid.iter().zip(&before).enumerate() {
            let v = grid.voxel(i);
            assert!(now || !then, "nothing is lost at {v}");
            assert!(!now || cubes(&grid, v).any(|cube| cube.iter().all(|&k| solid[k])), "thin at {v}");
            assert!(then || !now || v.z >= 4, "the block stays as it was at {v}");
        }
        let across = |z: u32| (0..144).filter(|k| solid[grid.index(UVec3::new(k % 12, k / 12, z))]).count();
        assert!((6..14).all(|z| (4..=8).contains(&across(z))), "{:?}", (5..15).map(across).collect::<Vec<_>>());
    }
}
