//! The rotation and scale between a file's frame and the world. No translation.

use crate::spec::Axis;
use glam::{Mat3, Quat, Vec3};

/// How a scene's own frame becomes the world's: z up, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFrame {
    /// Which axis of the file points up.
    pub up: Axis,
    /// Metres in one unit of the file.
    pub metres_per_unit: f32,
}

impl SceneFrame {
    /// World from scene, a rotation: +z (x,y,z), -z (x,-y,-z), +y (x,-z,y), -y (x,z,-y), +x (-z,y,x), -x (z,y,-x).
    pub fn rotation(&self) -> Mat3 {
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let rows = match self.up {
            Axis::PlusZ => [x, y, z],
            Axis::MinusZ => [x, -y, -z],
            Axis::PlusY => [x, -z, y],
            Axis::MinusY => [x, z, -y],
            Axis::PlusX => [-z, y, x],
            Axis::MinusX => [z, y, -x],
        };
        Mat3::from_cols(rows[0], rows[1], rows[2]).transpose()
    }

    /// The same rotation as a quaternion.
    pub fn quat(&self) -> Quat {
        Quat::from_mat3(&self.rotation())
    }

    /// A point of the file, in the world.
    pub fn to_world(&self, point: Vec3) -> Vec3 {
        self.rotation() * point * self.metres_per_unit
    }

    /// A point of the world, in the file.
    pub fn to_scene(&self, point: Vec3) -> Vec3 {
        self.rotation().transpose() * point / self.metres_per_unit
    }
}
