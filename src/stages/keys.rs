//! Keys: a hash of a stage's declared inputs, its version and its shader text. Nothing that is not in
//! here may change what a stage makes.

use crate::gpu::Gpu;
use crate::spec::{Event, Force, Object, Pin, Spec, Until};
use crate::world::Resolved;
use crate::{proxy, render, skin, solver, world};
use serde::Serialize;
use serde_json::json;
use std::sync::LazyLock;

/// Changed whenever the meaning of any key does.
const KEY_FORMAT: u32 = 4;
/// Version of reading, turning, pruning and selecting.
const SCENE_VERSION: u32 = 1;
/// Version of choosing neighbours and weights.
const BIND_VERSION: u32 = 1;
/// Version of what a segment of motion holds.
const SEGMENT_VERSION: u32 = 2;
/// Version of what pictures hold.
const PICTURE_VERSION: u32 = 1;

/// BLAKE3 of a stage's name and declared inputs, in hexadecimal.
fn hash(stage: &str, inputs: &impl Serialize) -> String {
    let text = serde_json::to_vec(&json!([KEY_FORMAT, stage, inputs])).unwrap_or_default();
    blake3::hash(&text).to_hex().to_string()
}

/// Keys of the stages that come before motion.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StillKeys {
    pub scene: String,
    pub proxy: String,
    pub bind: String,
}

/// What the scene stage reads: the file's content, its axes, and which Gaussians belong to what.
pub(super) fn scene(spec: &Spec, file_blake3: &str) -> String {
    let objects: Vec<_> = spec.objects.iter().map(|o| (&o.name, &o.select)).collect();
    hash("scene", &json!([SCENE_VERSION, file_blake3, spec.scene.up, spec.scene.metres_per_unit, objects, spec.world.ground.height_m]))
}

/// The keys before motion, given what the scene resolved to.
pub(super) fn still(spec: &Spec, scene: String, resolved: &Resolved) -> StillKeys {
    let kinds: Vec<_> = spec.objects.iter().map(|o| (o.proxy, o.stands())).collect();
    let proxy = hash("proxy", &json!([proxy::VERSION, scene, kinds, resolved.cell_m, resolved.ground_m, spec.seed]));
    let bind = hash("bind", &json!([BIND_VERSION, proxy, spec.skin]));
    StillKeys { scene, proxy, bind }
}

/// Device, driver and kind: the bits of motion and pictures are those of one device.
fn device(gpu: &Gpu) -> serde_json::Value {
    json!([gpu.info.name, format!("{:?}", gpu.info.backend), gpu.info.driver, gpu.info.driver_info])
}

/// What a prestress depends on: the solid, what it is made of, what it stands on, gravity, and how long a frame is, which
/// bounds how stiff a thing may be.
pub(super) fn prestress(spec: &Spec, keys: &StillKeys, resolved: &Resolved, gpu: &Gpu) -> String {
    let bodies: Vec<_> = spec.objects.iter().map(|o| (&o.material, &o.parts, o.rest)).collect();
    let pins: Vec<_> = spec.pins.iter().filter(|p| p.from_s <= 0.0).map(|p| (&p.object, &p.region)).collect();
    // What is too stiff for the shortest substep is softened before.
    let shortest_s = solver::shortest_substep_s(1.0 / f64::from(spec.time.fps), spec.solver.substeps_most);
    hash(
        "prestress",
        &json!([
            solver::VERSION,
            world::VERSION,
            *SOLVER_TEXT,
            device(gpu),
            keys.proxy,
            resolved.cell_m,
            shortest_s,
            resolved.ground_m,
            bodies,
            pins
        ]),
    ) + &hash("support", &json!([spec.world, spec.colliders]))
}

/// What motion until `to_s` depends on, and nothing that the spec says of later times.
///
/// An event at exactly `to_s` is later: it takes effect at that boundary, after the state there was kept.
pub(super) fn motion(spec: &Spec, prestress: &str, frames: std::ops::RangeInclusive<u32>, to_s: f64) -> String {
    let starts: Vec<_> = spec.objects.iter().map(start).collect();
    // What waits for an impact may happen at any time, as far as a key can tell.
    let mut events: Vec<&Event> = spec.events.iter().filter(|e| e.at_s.is_none_or(|at_s| at_s < to_s)).collect();
    events.sort_by(|a, b| a.at_s.unwrap_or(f64::INFINITY).total_cmp(&b.at_s.unwrap_or(f64::INFINITY)));
    let events: Vec<_> = events.into_iter().map(|e| Event { name: String::new(), ..e.clone() }).collect();
    let forces: Vec<_> = spec.forces.iter().filter(|f| f.from_s < to_s).map(|f| force_until(f, to_s)).collect();
    let pins: Vec<_> = spec.pins.iter().filter(|p| p.from_s < to_s).map(|p| pin_until(p, to_s)).collect();
    hash("motion", &json!([SEGMENT_VERSION, prestress, spec.seed, spec.time.fps, starts, events, forces, pins, frames.start(), frames.end()]))
}

fn start(object: &Object) -> serde_json::Value {
    json!([object.name, object.offset_m, object.rotate_deg, object.velocity_m_s, object.spin_rad_s])
}

/// Seconds until which something lasts, as far as `to_s` can tell.
fn end_before(until: Until, to_s: f64) -> Option<f64> {
    match until {
        Until::Time(end) if end < to_s => Some(end),
        _ => None,
    }
}

fn force_until(force: &Force, to_s: f64) -> serde_json::Value {
    json!([way(force), end_before(force.to_s, to_s)])
}

/// The way a force acts, whole: a later point of a spring's path is part of it. What it is called and when it ends is not.
fn way(force: &Force) -> Force {
    Force { name: String::new(), to_s: Until::End, ..force.clone() }
}

/// What tells a force in what a segment says of itself, whatever it is called in the version that asks.
pub(super) fn force(force: &Force) -> String {
    hash("force", &way(force))
}

fn pin_until(pin: &Pin, to_s: f64) -> serde_json::Value {
    // On the way to a point, the next one counts.
    let known = pin.path.iter().take_while(|p| p[0] < to_s).count() + 1;
    let path: Vec<_> = pin.path.iter().take(known).collect();
    json!([pin.object, pin.region, pin.from_s, end_before(pin.to_s, to_s), path])
}

/// What the pictures depend on: the whole motion, the skin, the camera, the size, the renderer.
pub(super) fn picture(spec: &Spec, motion: &str, keys: &StillKeys, resolved: &Resolved, gpu: &Gpu) -> String {
    hash(
        "picture",
        &json!([
            PICTURE_VERSION,
            skin::VERSION,
            render::VERSION,
            world::VERSION,
            *PICTURE_TEXT,
            device(gpu),
            motion,
            keys.bind,
            resolved.camera,
            resolved.size,
            spec.output.background,
            resolved.frames
        ]),
    )
}

/// Hashes of the shaders that motion and pictures pass through.
static SOLVER_TEXT: LazyLock<String> = LazyLock::new(|| text_hash(&solver::shader_text()));
static PICTURE_TEXT: LazyLock<String> = LazyLock::new(|| text_hash(&(skin::shader_text() + &render::shader_text() + &render::shadow::shader_text())));

fn text_hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::Camera;

    #[test]
    fn a_prestress_of_stiff_matter_is_of_one_length_of_frames() {
        // Shorter frames carry less stiffness, and the kept state holds what was carried.
        let gpu = Gpu::shared_for_tests().unwrap();
        let camera = Camera { eye_m: [0.0, -3.0, 1.0], target_m: [0.0; 3], fov_deg: 40.0, orbit_deg_s: 0.0 };
        let resolved = Resolved {
            duration_s: 2.0,
            frames: 101,
            ground_m: 0.0,
            cell_m: 0.02,
            size: [640, 360],
            camera,
            reframed: false,
            leaves: false,
            cut: false,
        };
        let key = |spec: &Spec| prestress(spec, &still(spec, "scene".to_owned(), &resolved), &resolved, &gpu);
        let fifty = Spec::of_scene("vase.splat");
        let mut other = fifty.clone();
        other.time.fps = 240;
        assert_ne!(key(&fifty), key(&other));
        // What comes after the start has no part in it.
        let mut later = fifty.clone();
        later.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::at("push", "vase", 1.2) });
        assert_eq!(key(&fifty), key(&later));
    }
}
