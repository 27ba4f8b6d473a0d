//! Where objects will be, as far as ballistics tell: enough to choose a duration and a camera before
//! anything is simulated. Predicted from the spec, never read from a result.

use super::ObjectFacts;
use crate::spec::Spec;
use glam::DVec3;

/// Seconds granted after the last landing or stop, for what ballistics do not know.
const SETTLE_S: f64 = 0.8;
/// Shortest and longest automatic duration, seconds.
const DURATION_S: (f64, f64) = (2.0, 8.0);
/// Friction taken where the spec says none, so that a slide ends.
const LEAST_FRICTION: f64 = 0.05;

/// One object's predicted path.
#[derive(Clone, Debug, Default)]
pub struct Path {
    /// Displacements of the object from its captured pose that the path passes through.
    pub points: Vec<DVec3>,
    /// When it has landed and stopped.
    pub rests_s: f64,
}

/// A body on its way: displacement from the captured pose, and velocity.
struct Body {
    at: DVec3,
    velocity: DVec3,
}

/// Follows one object through its launch and its pushes: parabolas until it lands on the height it
/// stood at, then a slide that friction ends.
pub fn predict(spec: &Spec, object: usize, facts: &ObjectFacts, until_s: f64) -> Path {
    let gravity = DVec3::from(spec.world.gravity_m_s2);
    let Some(thing) = spec.objects.get(object) else { return Path::default() };
    let floor = facts.support_m - facts.low_m[2];
    let mut body = Body { at: DVec3::from(thing.offset_m), velocity: DVec3::from(thing.velocity_m_s) };
    let mut events: Vec<_> = spec.events.iter().filter(|e| e.object == thing.name).collect();
    events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    let mut path = Path { points: vec![body.at], rests_s: 0.0 };
    let mut now = 0.0;
    for event in events {
        travel(&mut body, now, event.at_s.min(until_s), floor, gravity, spec.world.ground.friction, &mut path);
        now = event.at_s;
        body.velocity = event.velocity_m_s.map_or(body.velocity, DVec3::from) + event.push_m_s.map_or(DVec3::ZERO, DVec3::from);
    }
    for force in spec.forces.iter().filter(|f| f.object == thing.name) {
        let end = match force.to_s {
            crate::spec::Until::End => until_s,
            crate::spec::Until::Time(t) => t.min(until_s),
        };
        let span = (end - force.from_s).max(0.0);
        body.velocity += DVec3::from(force.acceleration_m_s2) * span * 0.5;
        path.rests_s = path.rests_s.max(end);
    }
    travel(&mut body, now, until_s.max(now), floor, gravity, spec.world.ground.friction, &mut path);
    path
}

/// Small steps are enough: the result frames a picture and rounds to whole frames.
fn travel(body: &mut Body, from_s: f64, to_s: f64, floor: f64, gravity: DVec3, friction: f64, path: &mut Path) {
    let step_s = 0.01;
    let brake = friction.max(LEAST_FRICTION) * (-gravity.z).max(0.0) * step_s;
    let mut now = from_s;
    while now < to_s {
        let flying = body.at.z > floor + 1e-4 || body.velocity.z > 1e-3 || gravity.z >= 0.0;
        if flying {
            body.velocity += gravity * step_s;
        } else {
            let flat = body.velocity.truncate();
            let speed = flat.length();
            if speed <= brake {
                body.velocity = DVec3::ZERO;
                now = to_s;
                path.points.push(body.at);
                continue;
            }
            body.velocity = (flat * (1.0 - brake / speed)).extend(0.0);
        }
        body.at += body.velocity * step_s;
        if body.at.z < floor {
            body.at.z = floor;
            body.velocity.z = 0.0;
        }
        now += step_s;
        path.points.push(body.at);
        path.rests_s = path.rests_s.max(now);
    }
}

/// The automatic duration: until everything has landed and settled, 2 to 8 s, in whole frames.
pub fn duration_s(spec: &Spec, facts: &[ObjectFacts]) -> f64 {
    let rests = facts.iter().enumerate().map(|(i, f)| predict(spec, i, f, DURATION_S.1).rests_s).fold(0.0, f64::max);
    let wanted = if rests > 0.0 { rests + SETTLE_S } else { 0.0 };
    let fps = f64::from(spec.time.fps);
    (wanted.clamp(DURATION_S.0, DURATION_S.1) * fps - 1e-6).ceil() / fps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Auto, Axis, Event, Object, Output, Scene, Skin, Solver, Time, World};

    fn spec() -> Spec {
        Spec {
            format: 1,
            seed: 1,
            scene: Scene { file: "vase.splat".into(), blake3: None, up: Auto::Auto, metres_per_unit: 1.0 },
            time: Time::default(),
            world: World::default(),
            solver: Solver::default(),
            objects: vec![Object::new("vase")],
            pins: vec![],
            colliders: vec![],
            forces: vec![],
            events: vec![],
            skin: Skin::default(),
            camera: Auto::Auto,
            output: Output::default(),
            expectations: vec![],
        }
    }

    fn facts() -> Vec<ObjectFacts> {
        let (low_m, high_m) = ([-0.2, -0.5, 0.0], [0.2, 0.5, 1.0]);
        vec![ObjectFacts { name: "vase".into(), gaussians: 1, low_m, high_m, centre_m: [0.0, 0.0, 0.5], support_m: 0.0, forward: Axis::PlusX }]
    }

    #[test]
    fn a_thing_left_alone_is_shown_for_two_seconds() {
        assert_eq!(duration_s(&spec(), &facts()), 2.0);
    }

    #[test]
    fn a_jump_rises_by_its_ballistic_height_and_six_times_that_on_the_moon() {
        let mut spec = spec();
        spec.objects[0].velocity_m_s = [0.0, 0.0, (2.0f64 * 9.81 * 0.3).sqrt()];
        let apex = |spec: &Spec| predict(spec, 0, &facts()[0], 8.0).points.iter().map(|p| p.z).fold(0.0, f64::max);
        assert!((apex(&spec) - 0.3).abs() < 0.02);
        let earth_s = duration_s(&spec, &facts());
        spec.world.gravity_m_s2 = [0.0, 0.0, -1.62];
        assert!((apex(&spec) - 0.3 * 9.81 / 1.62).abs() < 0.05);
        assert!(duration_s(&spec, &facts()) > earth_s);
    }

    #[test]
    fn a_late_push_lengthens_the_film() {
        let mut spec = spec();
        spec.events.push(Event { name: "push".into(), at_s: 2.5, object: "vase".into(), push_m_s: Some([1.0, 0.0, 0.0]), velocity_m_s: None });
        let duration = duration_s(&spec, &facts());
        assert!(duration > 3.0 && duration <= 8.0, "{duration}");
        assert!((duration * 50.0).fract().abs() < 1e-6);
    }
}
