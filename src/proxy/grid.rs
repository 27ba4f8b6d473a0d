//! A box of cubic voxels in the world.

use glam::{UVec3, Vec3};

/// Voxels of one edge length; x runs fastest, then y, then z.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// The lowest corner of the first voxel, metres.
    pub low: Vec3,
    /// Edge of a voxel, metres.
    pub voxel_m: f32,
    /// Voxels along each axis.
    pub size: UVec3,
}

impl Grid {
    /// How many voxels there are.
    pub fn len(&self) -> usize {
        self.size.x as usize * self.row_count()
    }

    /// Rows along x: y and z together.
    pub fn row_count(&self) -> usize {
        self.size.y as usize * self.size.z as usize
    }

    /// Voxels in one horizontal slab.
    pub fn slab(&self) -> usize {
        self.size.x as usize * self.size.y as usize
    }

    /// Where a voxel is stored.
    pub fn index(&self, voxel: UVec3) -> usize {
        (voxel.z as usize * self.size.y as usize + voxel.y as usize) * self.size.x as usize + voxel.x as usize
    }

    /// The voxel stored at an index.
    pub fn voxel(&self, index: usize) -> UVec3 {
        let (row, x) = (index as u32 / self.size.x, index as u32 % self.size.x);
        UVec3::new(x, row % self.size.y, row / self.size.y)
    }

    /// The voxels, by index, that share a face with one that is on no side and not on top: below,
    /// above, and the four in its layer. Below the lowest layer the index is out of range.
    pub fn faces(&self, index: u32) -> [u32; 6] {
        let (row, slab) = (self.size.x, self.slab() as u32);
        [index.wrapping_sub(slab), index + slab, index - row, index - 1, index + 1, index + row]
    }

    /// Whether a voxel is on a side or on top of the grid.
    pub fn on_border(&self, voxel: UVec3) -> bool {
        voxel.x == 0 || voxel.y == 0 || (voxel + 1).cmpeq(self.size).any()
    }

    /// The middle of a voxel, metres.
    pub fn centre(&self, voxel: UVec3) -> Vec3 {
        self.low + (voxel.as_vec3() + 0.5) * self.voxel_m
    }

    /// Volume of one voxel, cubic metres.
    pub fn voxel_volume_m3(&self) -> f64 {
        f64::from(self.voxel_m).powi(3)
    }
}
