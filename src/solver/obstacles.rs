//! Static colliders and pins as the kernels read them, and the same geometry on the CPU.

use super::grip::Pose;
use super::types::{PinRegion, Settings};
use crate::spec::ColliderShape;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

/// Most steps of a way out: one surface may lead behind another.
const WAYS_OUT: u32 = 8;

/// A collider on the device; see `shaders/solver/contact.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct ColliderRecord {
    pub at: [f32; 4],
    pub shape: [f32; 4],
    pub surface: [f32; 4],
}

/// A pin on the device; see `shaders/solver/pin.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct PinRecord {
    pub at: [f32; 4],
    pub shape: [f32; 4],
    /// Corners of the box that it is limited to; whom it holds: an object's bodies, and its layer of the grid.
    pub low: [f32; 3],
    pub object: u32,
    pub high: [f32; 3],
    pub layer: u32,
    /// Where `centre` of the captured pose is at the start of the segment, how the object was turned about it (columns), and
    /// the pin's velocity.
    pub shift: [f32; 4],
    pub centre: [f32; 4],
    pub turn: [[f32; 4]; 3],
    pub velocity: [f32; 4],
}

/// Where a point is against a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    pub distance_m: f32,
    pub face: u32,
}

/// All colliders, the ground first where there is one.
pub(super) fn colliders(settings: &Settings) -> Vec<ColliderRecord> {
    let ground = settings.ground.map(|g| ColliderRecord {
        at: [0.0, 0.0, g.height_m, 0.0],
        shape: [0.0, 0.0, 1.0, 0.0],
        surface: [g.friction, g.restitution, 0.0, 0.0],
    });
    let others = settings.colliders.iter().map(|c| {
        let (at, shape) = geometry(&c.shape, 0.0);
        ColliderRecord { at, shape, surface: [c.friction, c.restitution, 0.0, 0.0] }
    });
    ground.into_iter().chain(others).collect()
}

/// A pin holds the nodes up to half a cell around its shape, so that it holds what is in it, and at
/// least one layer; around the object's box there is room for the nodes that its outermost particles
/// reach.
pub(super) fn pin(region: &PinRegion, pose: &Pose, layer: u32, cell_m: f32, time_s: f64) -> PinRecord {
    let (at, shape) = geometry(&region.shape, 0.5 * cell_m);
    let room = Vec3::splat(2.0 * cell_m);
    // A hair later, so that a path's corner counts as passed.
    let (shift, velocity) = region.motion(time_s + 1e-9);
    PinRecord {
        at,
        shape,
        low: (region.low_m - room).into(),
        object: region.object,
        high: (region.high_m + room).into(),
        layer,
        shift: (shift.as_vec3() + Vec3::from(pose.start_m)).extend(0.0).into(),
        centre: Vec3::from(pose.centre_m).extend(0.0).into(),
        turn: pose.turn,
        velocity: velocity.as_vec3().extend(0.0).into(),
    }
}

impl PinRecord {
    /// Whether it holds what lies there in the captured pose.
    pub fn surrounds(&self, x: Vec3) -> bool {
        let shape = ColliderRecord { at: self.at, shape: self.shape, surface: [0.0; 4] };
        x.cmpge(Vec3::from(self.low)).all() && x.cmple(Vec3::from(self.high)).all() && shape.touch(x).distance_m <= 0.0
    }
}

fn geometry(shape: &ColliderShape, grow_m: f32) -> ([f32; 4], [f32; 4]) {
    let point = |p: &[f64; 3]| DVec3::from(*p).as_vec3();
    match shape {
        ColliderShape::Plane(p) => {
            let normal = DVec3::from(p.normal).normalize_or(DVec3::Z).as_vec3();
            ((point(&p.point_m) + normal * grow_m).extend(0.0).into(), normal.extend(0.0).into())
        }
        ColliderShape::Box(b) => {
            let half = point(&b.size_m) * 0.5 + Vec3::splat(grow_m);
            (point(&b.centre_m).extend(1.0).into(), half.extend(0.0).into())
        }
        ColliderShape::Sphere(s) => (point(&s.centre_m).extend(2.0).into(), [0.0, 0.0, 0.0, s.radius_m as f32 + grow_m]),
        ColliderShape::Capsule(c) => {
            let axis = (DVec3::from(c.to_m) - DVec3::from(c.from_m)).as_vec3();
            (point(&c.from_m).extend(2.0).into(), axis.extend(c.radius_m as f32 + grow_m).into())
        }
    }
}

impl ColliderRecord {
    /// From the nearest point of a capsule's axis.
    fn off_axis(&self, x: Vec3) -> Vec3 {
        let (d, axis) = (x - Vec3::from_slice(&self.at), Vec3::from_slice(&self.shape));
        d - axis * (d.dot(axis) / axis.length_squared().max(1e-30)).clamp(0.0, 1.0)
    }

    /// Signed distance to the surface and the face that is nearest.
    pub fn touch(&self, x: Vec3) -> Touch {
        let d = x - Vec3::from_slice(&self.at);
        let shape = Vec3::from_slice(&self.shape);
        match self.at[3] as u32 {
            0 => Touch { distance_m: d.dot(shape), face: 0 },
            2 => Touch { distance_m: self.off_axis(x).length() - self.shape[3], face: 0 },
            _ => {
                let q = d.abs() - shape;
                let axis = if q.x > q.y && q.x > q.z {
                    0
                } else if q.y > q.z {
                    1
                } else {
                    2
                };
                Touch { distance_m: q[axis], face: axis as u32 + if d[axis] < 0.0 { 4 } else { 0 } }
            }
        }
    }

    /// Outward normal of a face, for a point beside it.
    pub fn normal(&self, face: u32, x: Vec3) -> Vec3 {
        match self.at[3] as u32 {
            0 => Vec3::from_slice(&self.shape),
            2 => self.off_axis(x).normalize_or(Vec3::Z),
            _ => {
                let mut normal = Vec3::ZERO;
                normal[(face & 3) as usize] = if face >= 4 { -1.0 } else { 1.0 };
                normal
            }
        }
    }
}

/// How far points have to go, all together, so that they are not mostly behind some surface.
pub(super) fn way_out(colliders: &[ColliderRecord], points: &[Vec3]) -> Vec3 {
    let mut way = Vec3::ZERO;
    for _ in 0..WAYS_OUT {
        let out = colliders.iter().find_map(|c| out_of(c, points, way));
        match out {
            Some(out) => way += out,
            None => break,
        }
    }
    way
}

/// The way out of one collider, where more than half of the points are in it.
fn out_of(collider: &ColliderRecord, points: &[Vec3], way: Vec3) -> Option<Vec3> {
    let touches = || points.iter().map(|&p| (p + way, collider.touch(p + way)));
    let behind = touches().filter(|(_, t)| t.distance_m < 0.0).count();
    let (x, deepest) = touches().min_by(|a, b| a.1.distance_m.total_cmp(&b.1.distance_m))?;
    (2 * behind > points.len()).then(|| collider.normal(deepest.face, x) * -deepest.distance_m)
}

/// Whether a place is inside something solid.
pub fn is_inside(shape: &ColliderShape, x: Vec3) -> bool {
    let (at, shape) = geometry(shape, 0.0);
    ColliderRecord { at, shape, surface: [0.0; 4] }.touch(x).distance_m < 0.0
}

/// Distance to the nearest surface, infinite where there is none.
pub(super) fn distance_m(colliders: &[ColliderRecord], x: Vec3) -> f32 {
    colliders.iter().map(|c| c.touch(x).distance_m).fold(f32::INFINITY, f32::min)
}
