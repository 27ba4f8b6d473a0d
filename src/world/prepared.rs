//! A scene read, turned upright and divided into objects: what every later stage starts from.

use super::{Facts, ObjectFacts, seam};
use crate::scene::Gaussians;
use crate::spec::{Axis, Camera, Collider, ColliderShape, Spec};
use glam::{DVec2, DVec3, Quat, Vec3};

/// The scene of one spec in the captured pose. World frame, metres.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// All Gaussians, along a Morton curve.
    pub gaussians: Gaussians,
    /// From the frame of the spherical harmonics to the world.
    pub world_from_sh: Quat,
    /// Index of each Gaussian's object, `u32::MAX` where it has none.
    pub object_of: Vec<u32>,
    /// Isolated Gaussians: drawn, but no part of any solid.
    pub floater: Vec<bool>,
    /// Which axis of the file points up, given or guessed.
    pub up: Axis,
    /// Height of the ground plane.
    pub ground_m: f64,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Prepared {
    /// Indices of one object's Gaussians; without floaters where they would distort a solid.
    pub fn members(&self, object: u32, with_floaters: bool) -> Vec<u32> {
        (0..self.gaussians.len() as u32).filter(|&i| self.object_of[i as usize] == object && (with_floaters || !self.floater[i as usize])).collect()
    }

    /// Lowest centre of all objects' Gaussians, floaters pruned.
    pub fn lowest(gaussians: &Gaussians, object_of: &[u32], floater: &[bool]) -> Option<f32> {
        let heights = gaussians.mean.iter().zip(object_of).zip(floater);
        heights.filter(|((_, object), floater)| **object != u32::MAX && !**floater).map(|((mean, _), _)| mean.z).reduce(f32::min)
    }

    /// Everything the language and the camera need to know of the objects.
    pub fn facts(&self, spec: &Spec, camera: Camera) -> Facts {
        let seam = |object: usize| seam::of(&self.gaussians, &self.members(object as u32, false));
        let seams = (0..spec.objects.len()).map(seam).collect();
        Facts { objects: self.object_facts(spec), seams, ground_m: self.ground_m, camera, has_static: self.object_of.contains(&u32::MAX) }
    }

    /// One entry for each object of the spec, in its order.
    pub fn object_facts(&self, spec: &Spec) -> Vec<ObjectFacts> {
        spec.objects
            .iter()
            .enumerate()
            .map(|(index, object)| {
                let members = self.members(index as u32, false);
                let points: Vec<Vec3> = members.iter().map(|&i| self.gaussians.mean[i as usize]).collect();
                let low = points.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
                let high = points.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
                let sum: glam::DVec3 = points.iter().map(|p| p.as_dvec3()).sum();
                let centre = sum / points.len().max(1) as f64;
                ObjectFacts {
                    name: object.name.clone(),
                    gaussians: members.len(),
                    low_m: low.as_dvec3().to_array(),
                    high_m: high.as_dvec3().to_array(),
                    centre_m: centre.to_array(),
                    support_m: support_below(
                        &spec.colliders,
                        self.ground_m,
                        [centre.x, centre.y, f64::from(low.z)],
                        NEAR_M.min(f64::from(high.z - low.z)),
                    ),
                    forward: object.forward,
                }
            })
            .collect()
    }
}

/// What is so little higher than a thing of usual size still counts as below it, metres.
pub const NEAR_M: f64 = 0.01;

/// Height of what is below a point: the ground, or the highest collider top that is not above it by more than `near_m`.
pub fn support_below(colliders: &[Collider], ground_m: f64, [x, y, z]: [f64; 3], near_m: f64) -> f64 {
    colliders.iter().filter_map(|c| top_at(&c.shape, x, y)).filter(|top| *top <= z + near_m).fold(ground_m, f64::max)
}

/// Height of a shape's upper side over one point of the plan, where it has one there.
fn top_at(shape: &ColliderShape, x: f64, y: f64) -> Option<f64> {
    match shape {
        ColliderShape::Box(b) => {
            let inside = (x - b.centre_m[0]).abs() <= b.size_m[0] / 2.0 && (y - b.centre_m[1]).abs() <= b.size_m[1] / 2.0;
            inside.then_some(b.centre_m[2] + b.size_m[2] / 2.0)
        }
        ColliderShape::Sphere(s) => ball_top(DVec3::from(s.centre_m), s.radius_m, x, y),
        ColliderShape::Capsule(c) => {
            let (from, to) = (DVec3::from(c.from_m), DVec3::from(c.to_m));
            let ends = [ball_top(from, c.radius_m, x, y), ball_top(to, c.radius_m, x, y)];
            ends.into_iter().flatten().chain(rod_top(from, to, c.radius_m, x, y)).reduce(f64::max)
        }
        ColliderShape::Plane(p) => {
            let [nx, ny, nz] = p.normal;
            (nz > 1e-6).then(|| p.point_m[2] - (nx * (x - p.point_m[0]) + ny * (y - p.point_m[1])) / nz)
        }
    }
}

fn ball_top(centre: DVec3, radius: f64, x: f64, y: f64) -> Option<f64> {
    let rise = radius * radius - (DVec2::new(x, y) - centre.truncate()).length_squared();
    (rise >= 0.0).then(|| centre.z + rise.sqrt())
}

/// Where a vertical line leaves the side of a cylinder, if it does so between the cylinder's ends.
fn rod_top(from: DVec3, to: DVec3, radius: f64, x: f64, y: f64) -> Option<f64> {
    let axis = (to - from).try_normalize()?;
    let start = DVec3::new(x, y, 0.0) - from;
    // Both seen along the axis: |across + z up|^2 = radius^2.
    let (across, up) = (start.reject_from_normalized(axis), DVec3::Z.reject_from_normalized(axis));
    let (a, b, c) = (up.length_squared(), across.dot(up), across.length_squared() - radius * radius);
    let root = b * b - a * c;
    if a < 1e-12 || root < 0.0 {
        return None;
    }
    let z = (root.sqrt() - b) / a;
    let along = (start + DVec3::Z * z).dot(axis);
    (0.0..=from.distance(to)).contains(&along).then_some(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::CapsuleShape;

    #[test]
    fn a_capsule_has_a_top_over_its_shadow() {
        let lying = ColliderShape::Capsule(CapsuleShape { from_m: [-1.0, 0.0, 0.5], to_m: [1.0, 0.0, 0.5], radius_m: 0.2 });
        let near = |top: Option<f64>, want: f64| top.is_some_and(|z| (z - want).abs() < 1e-12);
        assert!(near(top_at(&lying, 0.3, 0.0), 0.7) && near(top_at(&lying, 0.3, 0.12), 0.66) && near(top_at(&lying, 1.12, 0.0), 0.66));
        assert!(top_at(&lying, 1.3, 0.0).is_none() && top_at(&lying, 0.0, 0.3).is_none());
        let standing = ColliderShape::Capsule(CapsuleShape { from_m: [0.0; 3], to_m: [0.0, 0.0, 1.0], radius_m: 0.5 });
        assert!(near(top_at(&standing, 0.3, 0.0), 1.4));
        let leaning = ColliderShape::Capsule(CapsuleShape { from_m: [0.0; 3], to_m: [1.0, 0.0, 1.0], radius_m: 0.1 });
        assert!(near(top_at(&leaning, 0.5, 0.0), 0.5 + 0.1 * 2f64.sqrt()));
    }
}
