//! The automatic camera: behind the object and to its right, a little above, far enough to hold the
//! predicted path.

use super::ballistics::{self, Path};
use super::{ObjectFacts, Prepared};
use crate::spec::{Camera, Spec};
use glam::DVec3;

/// From the target towards the eye in plan: behind (-x) and to the right (-y), so that +y is left on
/// the screen too and forward goes away to the right.
const BEHIND: [f64; 2] = [-0.87, -0.49];
/// Height of the eye over the target, for each metre of distance in plan.
const RISE: f64 = 0.30;
/// Vertical field of view.
const FOV_DEG: f64 = 45.0;
/// Share of the half-picture that the path may fill.
const FILL: f64 = 0.86;

/// A box that holds every object all along its predicted path.
#[derive(Clone, Copy, Debug)]
pub struct PathBox {
    low: DVec3,
    high: DVec3,
}

/// The box of all objects' predicted paths until `duration_s`.
pub fn path_box(spec: &Spec, facts: &[ObjectFacts], duration_s: f64) -> PathBox {
    let mut all = PathBox { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
    for (index, object) in facts.iter().enumerate() {
        let Path { points, .. } = ballistics::predict(spec, index, object, duration_s);
        let (low, high) = (DVec3::from(object.low_m), DVec3::from(object.high_m));
        for shift in points.iter().copied().chain([DVec3::ZERO]) {
            all.low = all.low.min(low + shift);
            all.high = all.high.max(high + shift);
        }
    }
    if all.low.is_finite() && all.high.is_finite() { all } else { PathBox { low: DVec3::splat(-0.5), high: DVec3::splat(0.5) } }
}

/// The automatic camera for a box and a picture of `aspect` = width / height.
pub fn frame(path: &PathBox, aspect: f64) -> Camera {
    let target = (path.low + path.high) / 2.0;
    let direction = DVec3::new(BEHIND[0], BEHIND[1], RISE).normalize();
    let (mut near, mut far) = (0.0, (path.high - path.low).length().max(1e-3) * 50.0);
    for _ in 0..60 {
        let middle = 0.5 * (near + far);
        let camera = at(target, target + direction * middle);
        if holds(&camera, path, aspect, FILL) {
            far = middle;
        } else {
            near = middle;
        }
    }
    at(target, target + direction * far)
}

fn at(target: DVec3, eye: DVec3) -> Camera {
    Camera { eye_m: eye.to_array(), target_m: target.to_array(), fov_deg: FOV_DEG, orbit_deg_s: 0.0 }
}

/// Whether a box lies within `fill` of the picture's half-width and half-height.
pub fn holds(camera: &Camera, path: &PathBox, aspect: f64, fill: f64) -> bool {
    let eye = DVec3::from(camera.eye_m);
    let forward = (DVec3::from(camera.target_m) - eye).normalize_or_zero();
    let right = forward.cross(DVec3::Z).normalize_or_zero();
    let up = right.cross(forward);
    let half = (camera.fov_deg.to_radians() / 2.0).tan();
    (0..8).all(|corner| {
        let pick = |bit: usize, low: f64, high: f64| if corner >> bit & 1 == 1 { high } else { low };
        let point = DVec3::new(pick(0, path.low.x, path.high.x), pick(1, path.low.y, path.high.y), pick(2, path.low.z, path.high.z)) - eye;
        let depth = point.dot(forward);
        depth > 1e-6 && point.dot(right).abs() <= depth * half * aspect * fill && point.dot(up).abs() <= depth * half * fill
    })
}

/// The camera of one run: as the spec says; else the session's, while it holds the predicted path;
/// else a new frame. The flag tells that the session's camera had to be left.
pub fn resolve(spec: &Spec, prepared: &Prepared, duration_s: f64, aspect: f64, session: Option<Camera>) -> (Camera, bool) {
    if let crate::spec::Auto::Value(camera) = spec.camera {
        return (camera, false);
    }
    let path = path_box(spec, &prepared.object_facts(spec), duration_s);
    match session {
        Some(camera) if holds(&camera, &path, aspect, 1.0) => (camera, false),
        Some(_) => (frame(&path, aspect), true),
        None => (frame(&path, aspect), false),
    }
}

/// The camera at a later time: turned about the vertical through its target, counter-clockwise seen from above.
pub fn orbited(camera: &Camera, time_s: f64) -> Camera {
    let target = DVec3::from(camera.target_m);
    let arm = DVec3::from(camera.eye_m) - target;
    let turn = glam::DQuat::from_rotation_z((camera.orbit_deg_s * time_s).to_radians());
    Camera { eye_m: (target + turn * arm).to_array(), ..*camera }
}
