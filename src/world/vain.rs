//! What a spec asks for in vain: what begins after the end, holds nothing, or cannot hold. It is said before anything moves.

use super::Resolved;
use super::bodies::Matter;
use super::region::{bounds, holds};
use crate::solver::{Substance, is_inside};
use crate::spec::{Auto, Event, Spec};
use glam::Vec3;

/// Less of an object inside something solid is its skin.
const SKIN: f64 = 0.02;

/// All of it, in words.
pub fn said(spec: &Spec, matter: &Matter, resolved: &Resolved) -> Vec<String> {
    let mut said = too_late(spec, resolved.time_s(resolved.frames - 1, spec.time.fps));
    said.extend(spec.pins.iter().filter_map(|pin| {
        let points = points(spec, matter, &pin.object)?;
        let whole = bounds(points);
        let none = !points.iter().any(|x| holds(&pin.region, *x, whole));
        none.then(|| format!("pin {}: its region holds nothing of {}", pin.name, pin.object))
    }));
    said.extend(spec.events.iter().filter_map(|event| empty_part(spec, matter, event)));
    said.extend(slips_its_pins(spec, matter));
    said.extend(spec.objects.iter().filter(|o| o.offset_m == [0.0; 3] && o.rotate_deg == [0.0; 3]).flat_map(|object| {
        let points = points(spec, matter, &object.name).unwrap_or_default();
        buried(spec, resolved, points).into_iter().map(|(what, percent)| {
            format!("{}: {percent:.0} % of it starts inside {what}, which will squeeze it out or hold it: move one of them", object.name)
        })
    }));
    said
}

/// What would begin when all is over.
fn too_late(spec: &Spec, end_s: f64) -> Vec<String> {
    let Auto::Value(asked_s) = spec.time.duration_s else { return Vec::new() };
    if asked_s == 0.0 {
        return Vec::new();
    }
    let mut said = Vec::new();
    if asked_s - end_s > 1e-6 {
        said.push(format!("time.duration_s = {asked_s} is no whole number of frames of 1/{} s: the last one is at {end_s:.3} s", spec.time.fps));
    }
    let late = |list: &str, name: &str, at_s: f64| {
        (at_s >= end_s).then(|| format!("{list} {name}: begins at {at_s} s, and the end is at {end_s:.3} s: use a longer time.duration_s"))
    };
    said.extend(spec.events.iter().filter_map(|e| late("event", &e.name, e.at_s?)));
    said.extend(spec.forces.iter().filter_map(|f| late("force", &f.name, f.from_s)));
    said.extend(spec.pins.iter().filter_map(|p| late("pin", &p.name, p.from_s)));
    said
}

/// An event of a part that no particle is of.
fn empty_part(spec: &Spec, matter: &Matter, event: &Event) -> Option<String> {
    let index = spec.objects.iter().position(|o| o.name == event.object)?;
    let part = event.part.as_ref()?;
    let number = spec.objects[index].parts.iter().position(|p| p.name == *part)? as u16 + 1;
    let none = !matter.piece[matter.bodies.ranges[index].clone()].contains(&number);
    none.then(|| format!("event {}: part {part} of {} holds no particle, so nothing happens", event.name, event.object))
}

/// Liquids of smoothed particles, from the start or by an event, which no pin holds.
fn slips_its_pins(spec: &Spec, matter: &Matter) -> Vec<String> {
    let smoothed = |substance: &Substance| matches!(substance, Substance::SphLiquid { .. });
    let slips = |index: usize, name: &str| {
        let changed = spec.events.iter().zip(&matter.changes).filter(|(e, _)| e.object == *name).filter_map(|(_, change)| change.as_ref());
        matter.stuffs[index].iter().chain(changed).any(|stuff| smoothed(&stuff.substance))
    };
    let pinned = spec.objects.iter().enumerate().filter(|(_, o)| spec.pins.iter().any(|pin| pin.object == o.name));
    let names = pinned.filter(|(index, o)| slips(*index, &o.name)).map(|(_, o)| &o.name);
    names.map(|name| format!("{name}: a liquid of smoothed particles is not held by pins")).collect()
}

/// What an object stands in, and how many percent of it.
fn buried(spec: &Spec, resolved: &Resolved, points: &[Vec3]) -> Vec<(String, f64)> {
    let share = |inside: &dyn Fn(Vec3) -> bool| points.iter().filter(|x| inside(**x)).count() as f64 / points.len().max(1) as f64;
    let ground = ("the ground".to_owned(), share(&|x| f64::from(x.z) < resolved.ground_m));
    let colliders = spec.colliders.iter().map(|c| (format!("collider {}", c.name), share(&|x| is_inside(&c.shape, x))));
    std::iter::once(ground).chain(colliders).filter(|(_, share)| *share > SKIN).map(|(what, share)| (what, 100.0 * share)).collect()
}

/// An object's particles where they were captured.
fn points<'a>(spec: &Spec, matter: &'a Matter, object: &str) -> Option<&'a [Vec3]> {
    let index = spec.objects.iter().position(|o| o.name == object)?;
    Some(&matter.particles.position_m[matter.bodies.ranges.get(index)?.clone()])
}
