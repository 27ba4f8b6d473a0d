//! Where objects will be, as far as ballistics tell: enough to choose a duration and a camera before
//! anything is simulated. Predicted from the spec, never read from a result.

use super::ObjectFacts;
use super::prepared::{NEAR_M, support_below};
use super::settings::lets_go_s;
use super::spread;
use crate::solver::velocity_change;
use crate::spec::expression::{Inputs, Program};
use crate::spec::{Event, FieldFacts, Force, Object, Pin, Spec};
use glam::DVec3;

/// Seconds granted after the last landing or stop, for what ballistics do not know.
const SETTLE_S: f64 = 0.8;
/// Shortest and longest automatic duration, seconds.
const DURATION_S: (f64, f64) = (2.0, 8.0);
/// What slides, drifts or is driven on and on is shown for so long after the last landing or event.
const TAIL_S: f64 = 3.0;
/// Friction taken where the spec says none, so that a slide ends.
const LEAST_FRICTION: f64 = 0.05;
/// Slower bounces are none.
const LEAST_BOUNCE_M_S: f64 = 0.1;

/// One object's predicted path.
#[derive(Clone, Debug, Default)]
pub struct Path {
    /// Displacements of the object from its captured pose that the path passes through.
    pub points: Vec<DVec3>,
    /// When it has landed and stopped.
    pub rests_s: f64,
    /// The last moment that must be seen: a landing, an event, the end of what drives or leads it.
    pub needs_s: f64,
    /// When it first stands on something.
    pub lands_s: Option<f64>,
    /// Where it comes apart and flows, and how far from its middle it gets.
    pub puddle: Option<(DVec3, f64)>,
}

/// A body on its way: displacement from the captured pose, and velocity.
struct Body {
    at: DVec3,
    velocity: DVec3,
    /// Pushes that wait for its landing, and whether it has been in the air.
    waiting: Vec<Event>,
    flown: bool,
    /// Where each of its pins took hold of it.
    held_from: Vec<Option<DVec3>>,
}

impl Body {
    fn push(&mut self, event: &Event) {
        self.velocity = event.velocity_m_s.map_or(self.velocity, DVec3::from) + event.push_m_s.map_or(DVec3::ZERO, DVec3::from);
    }
}

/// What drives one object over spans of time.
struct Drives {
    /// From when, until when, and how: constant, or by an expression.
    spans: Vec<(f64, f64, DVec3, Option<Program>)>,
    /// The object's centre in the captured pose.
    centre: DVec3,
}

impl Drives {
    fn of(spec: &Spec, thing: &Object, facts: &ObjectFacts) -> Drives {
        let centre = DVec3::from(facts.centre_m);
        let start_m = (centre + DVec3::from(thing.offset_m)).into();
        let facts = FieldFacts { captured_m: facts.centre_m, start_m, seed: spec.seed };
        let forces = spec.forces.iter().filter(|f| f.object == thing.name);
        let span = |f: &Force| {
            let constant = f.constant_m_s2().map_or(DVec3::ZERO, DVec3::from);
            (f.from_s, f.ends_s(), constant, f.program(&facts).ok().flatten())
        };
        Drives { spans: forces.map(span).collect(), centre }
    }

    /// When the last of them ends.
    fn end_s(&self) -> f64 {
        self.spans.iter().map(|s| s.1).fold(0.0, f64::max)
    }

    /// When the last of them begins or ends; what goes on for ever does not end.
    fn turns_s(&self) -> f64 {
        self.spans.iter().map(|s| if s.1.is_finite() { s.1 } else { s.0 }).fold(0.0, f64::max)
    }

    /// Change of velocity over a step.
    fn change(&self, body: &Body, time_s: f64, step_s: f64) -> DVec3 {
        let acting = || self.spans.iter().filter(|s| s.0 < time_s + step_s && s.1 > time_s);
        let share = |s: &(f64, f64, DVec3, Option<Program>)| (s.1.min(time_s + step_s) - s.0.max(time_s)) / step_s;
        let constant: DVec3 = acting().map(|s| s.2 * (step_s * share(s))).sum();
        let here = Inputs {
            position_m: (self.centre + body.at).into(),
            velocity_m_s: body.velocity.into(),
            rest_m: self.centre.into(),
            time_s: time_s + 0.5 * step_s,
            mass_kg: 1e-3,
            seed: 0.0,
        };
        let driven = acting().filter_map(|s| Some(velocity_change([s.3.as_ref()?], &here, step_s) * share(s)));
        constant + driven.sum::<DVec3>()
    }
}

/// Follows one object through its launch, its pushes and what drives it: parabolas until it lands on
/// what is below it then, a slide that friction ends, and a fall from the edge where the slide leads over one.
pub fn predict(spec: &Spec, object: usize, facts: &ObjectFacts, ground_m: f64, until_s: f64) -> Path {
    let gravity = DVec3::from(spec.world.gravity_m_s2);
    let Some(thing) = spec.objects.get(object) else { return Path::default() };
    let drives = Drives::of(spec, thing, facts);
    let waiting = spec.events.iter().filter(|e| e.object == thing.name && e.when.is_some()).cloned().collect();
    let pins: Vec<&Pin> = spec.pins.iter().filter(|p| p.object == thing.name).collect();
    let held_from = vec![None; pins.len()];
    let mut body = Body { at: DVec3::from(thing.offset_m), velocity: DVec3::from(thing.velocity_m_s), waiting, flown: false, held_from };
    let mut events: Vec<_> = spec.events.iter().filter(|e| e.object == thing.name).collect();
    events.sort_by(|a, b| a.at_s.unwrap_or(until_s).total_cmp(&b.at_s.unwrap_or(until_s)));
    let mut path = Path { points: vec![body.at], ..Path::default() };
    let mut now = 0.0;
    let ground = Ground { spec, restitution: restitution(thing, spec), facts, ground_m, gravity, pins };
    for (event, at_s) in events.into_iter().filter_map(|event| Some((event, event.at_s?))) {
        travel(&mut body, now, at_s.min(until_s), &ground, &drives, &mut path);
        now = at_s;
        body.push(event);
    }
    travel(&mut body, now, until_s.max(now), &ground, &drives, &mut path);
    path.rests_s = path.rests_s.max(drives.end_s().min(until_s));
    let own = || spec.events.iter().filter(|e| e.object == thing.name);
    let changed = own().filter(|e| e.effects() != ["push_m_s"]).filter_map(|e| e.at_s);
    path.rests_s = path.rests_s.max(changed.fold(0.0, f64::max).min(until_s));
    path.needs_s = own().filter_map(|e| e.at_s).fold(path.needs_s.max(drives.turns_s()), f64::max).min(until_s);
    if let Some(flow) = spread::of(spec, thing, facts, path.lands_s, until_s) {
        path.rests_s = path.rests_s.max(flow.until_s.min(until_s));
        path.needs_s = path.needs_s.max(flow.until_s.min(until_s));
        path.puddle = Some((body.at, flow.radius_m));
    }
    path
}

/// Of a rigid thing and the ground, the larger.
fn restitution(thing: &Object, spec: &Spec) -> f64 {
    thing.material.restitution().map_or(0.0, |own| own.max(spec.world.ground.restitution))
}

/// What it lands and slides on, and what holds it.
struct Ground<'a> {
    spec: &'a Spec,
    /// Share of its speed that it leaves with: what is soft keeps the rest in itself.
    restitution: f64,
    facts: &'a ObjectFacts,
    ground_m: f64,
    gravity: DVec3,
    pins: Vec<&'a Pin>,
}

impl Ground<'_> {
    /// Where a pin has it at a time, led from where it took hold; a part that is held holds the rest, as far as a picture goes.
    fn held_at(&self, body: &mut Body, time_s: f64) -> Option<DVec3> {
        let number = self.pins.iter().position(|pin| pin.from_s <= time_s && time_s < lets_go_s(self.spec, pin))?;
        let (pin, from) = (self.pins[number], *body.held_from[number].get_or_insert(body.at));
        let begin = [pin.from_s, 0.0, 0.0, 0.0];
        let next = pin.path.iter().position(|point| point[0] > time_s);
        let before = next.map_or(pin.path.last(), |next| next.checked_sub(1).map(|i| &pin.path[i])).unwrap_or(&begin);
        let after = next.map_or(before, |next| &pin.path[next]);
        let place = |point: &[f64; 4]| DVec3::new(point[1], point[2], point[3]);
        let share = ((time_s - before[0]) / (after[0] - before[0]).max(1e-9)).clamp(0.0, 1.0);
        Some(from + place(before).lerp(place(after), share))
    }

    /// When the next of its pins takes hold.
    fn takes_hold_s(&self, time_s: f64) -> f64 {
        self.pins.iter().map(|pin| pin.from_s).filter(|from_s| *from_s > time_s).fold(f64::INFINITY, f64::min)
    }

    /// The least displacement along z at a displacement: its lowest point on the ground, or on the collider that its
    /// middle is over.
    fn floor(&self, at: DVec3) -> f64 {
        let [x, y, _] = self.facts.centre_m;
        let low = self.facts.low_m[2];
        support_below(&self.spec.colliders, self.ground_m, [x + at.x, y + at.y, low + at.z], NEAR_M) - low
    }
}

/// Small steps are enough: the result frames a picture and rounds to whole frames.
fn travel(body: &mut Body, from_s: f64, to_s: f64, ground: &Ground, drives: &Drives, path: &mut Path) {
    let step_s = 0.01;
    let gravity = ground.gravity;
    let brake = ground.spec.world.ground.friction.max(LEAST_FRICTION) * (-gravity.z).max(0.0) * step_s;
    let mut now = from_s;
    while now < to_s {
        if let Some(at) = ground.held_at(body, now + step_s) {
            if at != body.at {
                path.rests_s = path.rests_s.max(now + step_s);
                path.needs_s = path.needs_s.max(now + step_s);
            }
            (body.at, body.velocity) = (at, DVec3::ZERO);
            path.points.push(at);
            now += step_s;
            continue;
        }
        let floor = ground.floor(body.at);
        let change = drives.change(body, now, step_s);
        body.velocity += change;
        let lifted = change.z + gravity.z * step_s > 0.0;
        body.flown |= body.at.z > floor + 1e-3;
        if body.at.z <= floor + 1e-3 {
            path.lands_s = path.lands_s.or(Some(now));
        }
        let flying = body.at.z > floor + 1e-4 || body.velocity.z > 1e-3 || gravity.z >= 0.0 || lifted;
        if flying {
            body.velocity += gravity * step_s;
        } else {
            let flat = body.velocity.truncate();
            let speed = flat.length();
            if speed <= brake && now > drives.end_s() {
                body.velocity = DVec3::ZERO;
                now = to_s.min(ground.takes_hold_s(now));
                path.points.push(body.at);
                continue;
            }
            body.velocity = (flat * (1.0 - brake / speed.max(brake).max(1e-12))).extend(0.0);
        }
        let before = body.at;
        body.at += body.velocity * step_s;
        if body.at.z < floor {
            body.at.z = floor;
            let back_m_s = -body.velocity.z * ground.restitution;
            body.velocity.z = if back_m_s > LEAST_BOUNCE_M_S { back_m_s } else { 0.0 };
            if std::mem::take(&mut body.flown) {
                std::mem::take(&mut body.waiting).iter().for_each(|event| body.push(event));
            }
        }
        now += step_s;
        path.points.push(body.at);
        if body.at != before {
            path.rests_s = path.rests_s.max(now);
            // What nothing draws back never lands, and what is driven about has no flight of its own.
            if flying && gravity.z < 0.0 && change == DVec3::ZERO {
                path.needs_s = path.needs_s.max(now);
            }
        }
    }
}

/// The automatic duration, in seconds and whole frames, and whether something is predicted to move on after it: until
/// everything has landed and settled, but no longer than [`TAIL_S`] for the sake of what slides or is driven on, 2 to 8 s.
pub fn duration_s(spec: &Spec, facts: &[ObjectFacts], ground_m: f64) -> (f64, bool) {
    let paths: Vec<Path> = facts.iter().enumerate().map(|(i, f)| predict(spec, i, f, ground_m, DURATION_S.1)).collect();
    let last = |pick: fn(&Path) -> f64| paths.iter().map(pick).fold(0.0, f64::max);
    let (rests, shown) = (last(|p| p.rests_s), last(|p| p.needs_s) + TAIL_S);
    let wanted = if rests > 0.0 { rests.min(shown) + SETTLE_S } else { 0.0 };
    let fps = f64::from(spec.time.fps);
    ((wanted.clamp(DURATION_S.0, DURATION_S.1) * fps - 1e-6).ceil() / fps, rests > shown || rests >= DURATION_S.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Auto, Axis, Event, Object, Output, Region, Scene, Skin, Solver, Time, Until, World};

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
        assert_eq!(duration_s(&spec(), &facts(), 0.0).0, 2.0);
    }

    #[test]
    fn a_jump_rises_by_its_ballistic_height_and_six_times_that_on_the_moon() {
        let mut spec = spec();
        spec.objects[0].velocity_m_s = [0.0, 0.0, (2.0f64 * 9.81 * 0.3).sqrt()];
        let apex = |spec: &Spec| predict(spec, 0, &facts()[0], 0.0, 8.0).points.iter().map(|p| p.z).fold(0.0, f64::max);
        assert!((apex(&spec) - 0.3).abs() < 0.02);
        let earth_s = duration_s(&spec, &facts(), 0.0).0;
        spec.world.gravity_m_s2 = [0.0, 0.0, -1.62];
        assert!((apex(&spec) - 0.3 * 9.81 / 1.62).abs() < 0.05);
        assert!(duration_s(&spec, &facts(), 0.0).0 > earth_s);
    }

    #[test]
    fn what_slides_over_an_edge_falls_to_the_ground() {
        use crate::spec::{BoxShape, Collider, ColliderShape};
        let mut spec = spec();
        let shape = ColliderShape::Box(BoxShape { centre_m: [0.0, 0.0, -0.25], size_m: [1.0, 1.0, 0.5] });
        spec.colliders.push(Collider { name: "table".into(), shape, friction: 0.3, restitution: 0.0 });
        let lowest = |spec: &Spec| predict(spec, 0, &facts()[0], -0.5, 4.0).points.iter().map(|p| p.z).fold(0.0, f64::min);
        spec.objects[0].velocity_m_s = [0.0, 0.5, 0.0];
        assert_eq!(lowest(&spec), 0.0, "it stops on the table");
        let stays_s = duration_s(&spec, &facts(), -0.5).0;
        spec.objects[0].velocity_m_s = [0.0, 2.0, 0.0];
        assert!((lowest(&spec) + 0.5).abs() < 1e-9);
        assert!(duration_s(&spec, &facts(), -0.5).0 > stays_s);
    }

    #[test]
    fn what_is_held_stays_and_what_is_led_goes_its_way() {
        let mut spec = spec();
        spec.objects[0].offset_m = [0.0, 0.0, 0.5];
        let pin = Pin {
            name: "hook".into(),
            object: "vase".into(),
            region: Region::Above(0.9),
            from_s: 0.0,
            to_s: Until::Time(2.0),
            path: vec![[1.0, 0.4, 0.0, 0.0], [1.5, 0.4, 0.2, 0.0]],
        };
        spec.pins.push(pin);
        let path = predict(&spec, 0, &facts()[0], 0.0, 4.0);
        let at = |time_s: f64| path.points[(time_s / 0.01).round() as usize];
        assert!((at(0.5) - DVec3::new(0.2, 0.0, 0.5)).length() < 0.01 && (at(1.9) - DVec3::new(0.4, 0.2, 0.5)).length() < 0.01);
        assert!(path.points.last().is_some_and(|p| p.z.abs() < 1e-9), "let go, it falls");
    }

    #[test]
    fn what_is_released_falls_and_what_is_caught_stays_where_it_was_caught() {
        let mut spec = spec();
        spec.objects[0].offset_m = [0.0, 0.0, 2.0];
        let pin = |from_s| Pin { name: "hook".into(), object: "vase".into(), region: Region::Above(0.9), from_s, to_s: Until::End, path: vec![] };
        let at = |spec: &Spec, time_s: f64| predict(spec, 0, &facts()[0], 0.0, 4.0).points[(time_s / 0.01).round() as usize].z;
        spec.pins = vec![pin(0.0)];
        spec.events.push(Event { release: true, ..Event::at("let-go", "vase", 1.0) });
        assert!(at(&spec, 0.99) == 2.0 && at(&spec, 1.3) < 1.7);
        (spec.pins, spec.events) = (vec![pin(0.3)], vec![]);
        let fallen_m = 0.5 * 9.81 * 0.3 * 0.3;
        assert!((at(&spec, 0.3) - (2.0 - fallen_m)).abs() < 0.05 && at(&spec, 0.31) == at(&spec, 1.0));
        // What lies still is led from there too.
        spec.objects[0].offset_m = [0.0; 3];
        spec.pins[0].path = vec![[1.0, 0.0, 0.0, 0.4]];
        assert!(predict(&spec, 0, &facts()[0], 0.0, 4.0).points.iter().any(|p| (p.z - 0.4).abs() < 1e-9));
    }

    #[test]
    fn a_push_on_impact_comes_with_the_landing() {
        let mut spec = spec();
        spec.objects[0].offset_m = [0.0, 0.0, 0.5];
        spec.events.push(Event { push_m_s: Some([2.0, 0.0, 0.0]), ..Event::on_impact("push", "vase") });
        let points = predict(&spec, 0, &facts()[0], 0.0, 4.0).points;
        assert!(points.iter().filter(|p| p.z > 0.05).all(|p| p.x == 0.0) && points[points.len() - 1].x > 0.5);
    }

    #[test]
    fn a_late_push_lengthens_the_film() {
        let mut spec = spec();
        spec.events.push(Event { push_m_s: Some([1.0, 0.0, 0.0]), ..Event::at("push", "vase", 2.5) });
        let duration = duration_s(&spec, &facts(), 0.0).0;
        assert!(duration > 3.0 && duration <= 8.0, "{duration}");
        assert!((duration * 50.0).fract().abs() < 1e-6);
    }

    #[test]
    fn what_goes_on_and_on_is_shown_for_a_while_and_a_landing_whole() {
        let mut spec = spec();
        spec.world.gravity_m_s2 = [0.0, 0.0, -1.62];
        spec.objects[0].velocity_m_s = [1.5, 0.0, 0.0];
        // Friction takes six seconds on the moon.
        assert_eq!(duration_s(&spec, &facts(), 0.0), (3.8, true));
        spec.objects[0].velocity_m_s = [0.0, 0.0, 4.4];
        let (jump_s, cut) = duration_s(&spec, &facts(), 0.0);
        assert!(jump_s > 2.0 * 4.4 / 1.62 && !cut, "{jump_s}");
        spec.world.gravity_m_s2 = [0.0; 3];
        assert_eq!(duration_s(&spec, &facts(), 0.0), (3.8, true));
        spec.objects[0].velocity_m_s = [0.0; 3];
        spec.forces.push(Force::constant("pull", "vase", 1.0, Until::End, [0.0, 3.0, 0.0]));
        assert_eq!(duration_s(&spec, &facts(), 0.0), (4.8, true));
        spec.forces[0].to_s = Until::Time(1.5);
        assert_eq!(duration_s(&spec, &facts(), 0.0), (5.3, true));
    }
}
