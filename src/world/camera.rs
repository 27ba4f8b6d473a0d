//! The automatic camera: behind the object and to its right, a little above, as near as it holds the predicted path.

use super::ballistics::{self, Path};
use super::prepared::{NEAR_M, support_below};
use super::{ObjectFacts, Prepared};
use crate::spec::{Auto, Camera, Spec};
use glam::{DVec2, DVec3};

/// From the target towards the eye in plan: behind (-x) and to the right (-y), so that +y is left on
/// the screen too and forward goes away to the right.
const BEHIND: [f64; 2] = [-0.87, -0.49];
/// Height of the eye over the target, for each metre of distance in plan.
const RISE: f64 = 0.30;
/// Vertical field of view.
const FOV_DEG: f64 = 45.0;
/// Share of the half-picture that the path may fill.
const FILL: f64 = 0.88;
/// How far along the ground a path is followed, in longest sides of the object: a picture of a longer one shows a speck.
const FAR_SIZES: f64 = 2.5;
/// How far from its middle what flows is followed, in longest sides: what runs on farther is a film on the ground.
const PUDDLE_SIZES: f64 = 0.8;
/// The session's camera is left where the path spans less of the picture than this, and a frame of its own would
/// show more: after a long shot, what stays in place is a speck in it.
const LEAST_SPAN: f64 = 0.3;
/// A Gaussian is seen as far from its centre, in its largest standard deviations.
const SEEN_SIGMAS: f32 = 1.5;

/// Points around every object all along its predicted path: the farthest in each of 26 directions.
#[derive(Clone, Debug, Default)]
pub struct Outline(Vec<DVec3>);

/// How a run is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framed {
    /// From where.
    pub camera: Camera,
    /// The session's camera lost the predicted path and was left.
    pub reframed: bool,
    /// The predicted path leaves the picture.
    pub leaves: bool,
}

/// The directions along edges, faces and corners of a cube, of unit length.
fn directions() -> impl Iterator<Item = DVec3> {
    let at = |i: i32| DVec3::new(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1));
    (0..27).map(at).filter_map(DVec3::try_normalize)
}

impl Outline {
    /// Of the spec's objects until `duration_s`, within `far_sizes` of where each starts. What is farthest of a thing and
    /// of its way in one direction is farthest of the thing on its way.
    pub fn new(spec: &Spec, prepared: &Prepared, facts: &[ObjectFacts], duration_s: f64, far_sizes: f64) -> Outline {
        let mut points = Vec::new();
        for (index, object) in facts.iter().enumerate() {
            let Path { points: way, puddle, .. } = ballistics::predict(spec, index, object, prepared.ground_m, duration_s);
            let size_m = (DVec3::from(object.high_m) - DVec3::from(object.low_m)).max_element();
            let start = way.first().copied().unwrap_or_default();
            let near = |shift: &&DVec3| (**shift - start).truncate().length() <= far_sizes * size_m;
            let way: Vec<DVec3> = way.iter().filter(near).copied().chain([DVec3::ZERO]).collect();
            let members = prepared.members(index as u32, false);
            for direction in directions() {
                let along = |a: &DVec3, b: &DVec3| a.dot(direction).total_cmp(&b.dot(direction));
                let reach = |&g: &u32| {
                    let sigma = prepared.gaussians.scale[g as usize].max_element() * SEEN_SIGMAS;
                    prepared.gaussians.mean[g as usize].as_dvec3() + f64::from(sigma) * direction
                };
                let Some(edge) = members.iter().map(reach).max_by(along) else { continue };
                let Some(shift) = way.iter().copied().max_by(along) else { continue };
                points.push(edge + shift);
            }
            if let Some((shift, radius_m)) = puddle.filter(|(shift, _)| near(&shift)) {
                points.extend(rim(spec, prepared, object, shift, radius_m.min(PUDDLE_SIZES * size_m)));
            }
        }
        Outline(points)
    }

    /// Where its points are seen: right and up of the middle, in half-widths and half-heights of the picture. `None`
    /// where one is behind the camera.
    fn seen(&self, camera: &Camera, aspect: f64) -> Option<Vec<DVec2>> {
        let eye = DVec3::from(camera.eye_m);
        let [right, up, forward] = axes(DVec3::from(camera.target_m) - eye);
        let half = (camera.fov_deg.to_radians() / 2.0).tan();
        let place = |p: DVec3| {
            let depth = p.dot(forward);
            (depth > 1e-6).then(|| DVec2::new(p.dot(right) / aspect, p.dot(up)) / (depth * half))
        };
        self.0.iter().map(|p| place(*p - eye)).collect()
    }

    /// Whether it lies within `fill` of the picture's half-width and half-height.
    pub fn within(&self, camera: &Camera, aspect: f64, fill: f64) -> bool {
        self.seen(camera, aspect).is_some_and(|points| points.iter().all(|p| p.abs().max_element() <= fill))
    }

    /// Share of the picture's width or height, whichever is larger, that it spans.
    fn span(&self, camera: &Camera, aspect: f64) -> f64 {
        let points = self.seen(camera, aspect).unwrap_or_default();
        let (low, high) = points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        0.5 * (high - low).max_element().max(0.0)
    }

    /// The automatic camera for a picture of `aspect` = width / height.
    ///
    /// In its own axes a point (x, y, z) is seen from (ex, ey, ez) while |x - ex| <= k (z - ez), for which ex has to lie
    /// between max(x - k z) + k ez and min(x + k z) - k ez: the nearest eye is where the first of the two gaps closes.
    pub fn frame(&self, aspect: f64) -> Camera {
        let toward = -DVec3::new(BEHIND[0], BEHIND[1], RISE);
        let [right, up, forward] = axes(toward);
        let half = (FOV_DEG.to_radians() / 2.0).tan() * FILL;
        let nothing = [DVec3::splat(-0.5), DVec3::splat(0.5)];
        let points = if self.0.is_empty() { &nothing[..] } else { &self.0 };
        let gap = |axis: DVec3, k: f64| {
            let low = points.iter().map(|p| p.dot(axis) - k * p.dot(forward)).fold(f64::NEG_INFINITY, f64::max);
            let high = points.iter().map(|p| p.dot(axis) + k * p.dot(forward)).fold(f64::INFINITY, f64::min);
            ((low + high) / 2.0, (high - low) / (2.0 * k))
        };
        let ((x, z_wide), (y, z_high)) = (gap(right, half * aspect), gap(up, half));
        let eye = x * right + y * up + z_wide.min(z_high) * forward;
        let (low, high) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        let target = eye + ((low + high) / 2.0 - eye).dot(forward).max(1e-3) * forward;
        Camera { eye_m: eye.to_array(), target_m: target.to_array(), fov_deg: FOV_DEG, orbit_deg_s: 0.0 }
    }
}

/// Points around an object that flows apart, on whatever is below each.
fn rim(spec: &Spec, prepared: &Prepared, object: &ObjectFacts, shift: DVec3, radius_m: f64) -> impl Iterator<Item = DVec3> {
    let (middle, low_m) = (DVec3::from(object.centre_m) + shift, object.low_m[2] + shift.z);
    (0..8).map(move |k| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
        let (x, y) = (middle.x + radius_m * cos, middle.y + radius_m * sin);
        DVec3::new(x, y, support_below(&spec.colliders, prepared.ground_m, [x, y, low_m], NEAR_M))
    })
}

/// Right, up and forward of a camera that looks along `toward`.
fn axes(toward: DVec3) -> [DVec3; 3] {
    let forward = toward.normalize_or(DVec3::X);
    let right = forward.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
    [right, right.cross(forward), forward]
}

/// The camera of one run: as the spec says; else the session's, while it holds the predicted path and shows it large
/// enough; else a new frame.
pub fn resolve(spec: &Spec, prepared: &Prepared, duration_s: f64, aspect: f64, session: Option<Camera>) -> Framed {
    let facts = prepared.object_facts(spec);
    let outline = |far_sizes: f64| Outline::new(spec, prepared, &facts, duration_s, far_sizes);
    let near = outline(FAR_SIZES);
    let (camera, reframed) = match (spec.camera, session) {
        (Auto::Value(camera), _) => (camera, false),
        (Auto::Auto, Some(camera)) if near.within(&camera, aspect, 1.0) && near.span(&camera, aspect) >= LEAST_SPAN => (camera, false),
        (Auto::Auto, session) => (near.frame(aspect), session.is_some()),
    };
    Framed { camera, reframed, leaves: !outline(f64::INFINITY).within(&camera, aspect, 1.0) }
}

/// The camera at a later time: turned about the vertical through its target, counter-clockwise seen from above.
pub fn orbited(camera: &Camera, time_s: f64) -> Camera {
    let target = DVec3::from(camera.target_m);
    let arm = DVec3::from(camera.eye_m) - target;
    let turn = glam::DQuat::from_rotation_z((camera.orbit_deg_s * time_s).to_radians());
    Camera { eye_m: (target + turn * arm).to_array(), ..*camera }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Gaussians;
    use crate::spec::Axis;
    use glam::{Quat, Vec3};

    /// A slab of Gaussians 0.4 m deep, 0.8 m wide, 1 m high, with a spec of it.
    fn scene() -> (Spec, Prepared) {
        let at = |i: usize| Vec3::new((i % 5) as f32 * 0.1 - 0.2, (i / 5 % 9) as f32 * 0.1 - 0.4, (i / 45) as f32 * 0.1);
        let count = 5 * 9 * 11;
        let gaussians = Gaussians {
            mean: (0..count).map(at).collect(),
            scale: vec![Vec3::splat(1e-3); count],
            rotation: vec![[1.0, 0.0, 0.0, 0.0]; count],
            opacity: vec![1.0; count],
            sh_degree: 0,
            sh: vec![0.0; 3 * count],
        };
        let prepared = Prepared {
            gaussians,
            world_from_sh: Quat::IDENTITY,
            object_of: vec![0; count],
            floater: vec![false; count],
            up: Axis::PlusZ,
            ground_m: 0.0,
            warnings: Vec::new(),
        };
        (Spec::of_scene("slab.splat"), prepared)
    }

    /// From the eye to the target.
    fn distance_of(camera: Camera) -> f64 {
        (DVec3::from(camera.eye_m) - DVec3::from(camera.target_m)).length()
    }

    fn outline(spec: &Spec, prepared: &Prepared, far_sizes: f64) -> Outline {
        Outline::new(spec, prepared, &prepared.object_facts(spec), 2.0, far_sizes)
    }

    #[test]
    fn what_stands_still_fills_the_picture_from_edge_to_edge() {
        let (spec, prepared) = scene();
        let outline = outline(&spec, &prepared, FAR_SIZES);
        for aspect in [16.0 / 9.0, 1.0, 0.4] {
            let camera = outline.frame(aspect);
            assert!(outline.within(&camera, aspect, FILL + 1e-9) && !outline.within(&camera, aspect, FILL - 1e-3), "{aspect}");
        }
        // As high as the picture, but for the margin and what the view from above adds.
        let camera = outline.frame(16.0 / 9.0);
        let share = 1.0 / (2.0 * distance_of(camera) * (camera.fov_deg.to_radians() / 2.0).tan());
        assert!(share > 0.62, "{share}");
    }

    #[test]
    fn a_long_way_is_followed_for_its_first_metres_and_that_is_told() {
        let (mut spec, prepared) = scene();
        let aspect = 16.0 / 9.0;
        assert!(!resolve(&spec, &prepared, 2.0, aspect, None).leaves);
        spec.objects[0].velocity_m_s = [0.0, 1.0, 2.0];
        let near = resolve(&spec, &prepared, 2.0, aspect, None);
        assert!(!near.leaves, "half a metre is held");
        spec.objects[0].velocity_m_s = [0.0, 8.0, 4.0];
        let far = resolve(&spec, &prepared, 2.0, aspect, None);
        let whole = outline(&spec, &prepared, f64::INFINITY).frame(aspect);
        let (kept, wide) = (distance_of(far.camera), distance_of(whole));
        assert!(far.leaves && kept < 0.7 * wide, "{kept} of {wide}");
        // A drop is held from where it starts to where it lands, however high.
        spec.objects[0].velocity_m_s = [0.0; 3];
        spec.objects[0].offset_m = [0.0, 0.0, 8.0];
        assert!(!resolve(&spec, &prepared, 2.0, aspect, None).leaves);
    }

    #[test]
    fn what_flows_is_held_with_its_puddle_and_still_fills_much_of_the_picture() {
        let (mut spec, prepared) = scene();
        let aspect = 16.0 / 9.0;
        let distance = |spec: &Spec| {
            let framed = resolve(spec, &prepared, 2.0, aspect, None);
            assert!(!framed.leaves);
            distance_of(framed.camera)
        };
        let dry = distance(&spec);
        spec.objects[0].material = crate::spec::presets::material("water").unwrap().material.clone();
        let wet = distance(&spec);
        assert!(wet > 1.02 * dry && wet < 1.6 * dry, "{dry} {wet}");
        // Where it runs far away, the picture stays where it began.
        spec.objects[0].velocity_m_s = [0.0, 30.0, 0.0];
        let gone = distance_of(resolve(&spec, &prepared, 2.0, aspect, None).camera);
        assert!(gone < 6.0 * dry, "{dry} {gone}");
    }

    #[test]
    fn the_sessions_camera_stays_while_it_holds_the_path() {
        let (mut spec, prepared) = scene();
        let aspect = 16.0 / 9.0;
        let first = resolve(&spec, &prepared, 2.0, aspect, None).camera;
        assert_eq!(resolve(&spec, &prepared, 2.0, aspect, Some(first)), Framed { camera: first, reframed: false, leaves: false });
        spec.objects[0].velocity_m_s = [0.0, 0.0, 4.0];
        let next = resolve(&spec, &prepared, 2.0, aspect, Some(first));
        assert!(next.reframed && !next.leaves && next.camera != first);
        // Nor does it stay where a long shot left it.
        spec.objects[0].velocity_m_s = [0.0, 0.0, 12.0];
        let far = resolve(&spec, &prepared, 8.0, aspect, None).camera;
        spec.objects[0].velocity_m_s = [0.0; 3];
        assert_eq!(resolve(&spec, &prepared, 2.0, aspect, Some(far)), Framed { camera: first, reframed: true, leaves: false });
        spec.objects[0].velocity_m_s = [0.0, 0.0, 4.0];
        // A camera that was set is never left, but that the path leaves it is told.
        spec.camera = Auto::Value(first);
        assert_eq!(resolve(&spec, &prepared, 2.0, aspect, None), Framed { camera: first, reframed: false, leaves: true });
    }
}
