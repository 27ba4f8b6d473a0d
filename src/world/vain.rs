//! What a spec asks for in vain: what begins after the end, holds nothing, or cannot hold. It is said before anything moves.

use super::Resolved;
use super::bodies::Matter;
use super::region::{bounds, holds};
use crate::solver::{Substance, is_inside};
use crate::spec::{Drive, Event, Force, Material, Spec};
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
    said.extend(spec.events.iter().filter_map(|event| empty_part(spec, matter, event).or_else(|| without_effect(spec, event))));
    said.extend(spec.forces.iter().filter_map(without_strength));
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
    let mut said = Vec::new();
    // An automatic duration has an end as well, whatever begins later.
    let asked_s = spec.time.duration_s.unwrap_or(end_s);
    if asked_s == 0.0 {
        return said;
    }
    if asked_s - end_s > 1e-6 {
        said.push(format!("time.duration_s = {asked_s} is no whole number of frames of 1/{} s: the last one is at {end_s:.3} s", spec.time.fps));
    }
    let late = |list: &str, name: &str, at_s: f64| {
        (at_s >= end_s).then(|| format!("{list} {name}: begins at {at_s} s, and the end is at {end_s:.3} s: use a time.duration_s above {at_s} s"))
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

/// An event that changes nothing of what it happens to.
fn without_effect(spec: &Spec, event: &Event) -> Option<String> {
    let (name, of) = (&event.name, &event.object);
    let stuffs = stuffs(spec, event);
    let who = event.part.as_ref().map_or_else(|| of.clone(), |part| format!("part {part} of {of}"));
    let nothing = |why: String| Some(format!("event {name}: {why}, so nothing happens"));
    if event.push_m_s == Some([0.0; 3]) {
        return nothing("its push_m_s has no length".to_owned());
    }
    if event.weaken.is_some() && stuffs.iter().all(|m| m.young_pa().is_none()) {
        return nothing(format!("{who} is {}, which has no stiffness that could weaken", kinds(&stuffs)));
    }
    if event.weaken == Some(1.0) {
        return nothing("weaken = 1 keeps all of its strength".to_owned());
    }
    if event.freeze && stuffs.iter().all(|m| matches!(m, Material::Rigid(_))) {
        return nothing(format!("{who} is rigid and keeps its shape already"));
    }
    if event.material.as_ref().is_some_and(|to| stuffs.iter().all(|m| *m == to)) {
        return nothing(format!("{who} is of that stuff already"));
    }
    let holds = |at_s: f64| {
        let pinned = spec.pins.iter().any(|p| p.object == *of && p.from_s <= at_s);
        pinned || spec.events.iter().any(|e| e.object == *of && e.freeze && e.at_s.is_none_or(|from_s| from_s <= at_s))
    };
    match event.at_s.filter(|at_s| event.release && !holds(*at_s)) {
        Some(at_s) => nothing(format!("nothing holds {of} yet at {at_s} s")),
        None => None,
    }
}

/// What an event may happen to: of its part, or of all of its object, at the start or by another event.
fn stuffs<'a>(spec: &'a Spec, event: &Event) -> Vec<&'a Material> {
    let Some(object) = spec.objects.iter().find(|o| o.name == event.object) else { return Vec::new() };
    let own = std::iter::once(&object.material).filter(|_| event.part.is_none());
    let parts = object.parts.iter().filter(|p| event.part.as_ref().is_none_or(|name| *name == p.name)).map(|p| &p.material);
    let others = spec.events.iter().filter(|e| e.name != event.name && e.object == event.object);
    let later = others.filter(|e| event.part.is_none() || e.part.is_none() || e.part == event.part).filter_map(|e| e.material.as_ref());
    own.chain(parts).chain(later).collect()
}

/// "rigid", "liquid or rigid".
fn kinds(stuffs: &[&Material]) -> String {
    let mut kinds: Vec<&str> = stuffs.iter().map(|m| m.kind()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    kinds.join(" or ")
}

/// A force whose strength is 0. Air that stands still slows things down all the same.
fn without_strength(force: &Force) -> Option<String> {
    let field = match *force.drives().first()? {
        Drive::Constant([0.0, 0.0, 0.0]) => "acceleration_m_s2",
        Drive::Wind(wind) if wind.drag_per_s == 0.0 => "wind.drag_per_s",
        Drive::Vortex(vortex) if vortex.drag_per_s == 0.0 => "vortex.drag_per_s",
        Drive::Attractor(attractor) if attractor.strength_m_s2 == 0.0 => "attractor.strength_m_s2",
        Drive::Explosion(explosion) if explosion.speed_m_s == 0.0 => "explosion.speed_m_s",
        Drive::Spring(spring) if spring.stiffness_per_s2 == 0.0 && spring.damping_per_s == 0.0 => "spring.stiffness_per_s2",
        Drive::Motor(motor) if motor.rate_per_s == 0.0 => "motor.rate_per_s",
        _ => return None,
    };
    Some(format!("force {}: its {field} is 0, so it does nothing", force.name))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Attractor, Auto, Object, Part, Pin, Region, Rigid, Until, Wind};

    fn spec() -> Spec {
        let mut spec = crate::scene::demo::spec();
        let rigid = Material::Rigid(Rigid::default());
        spec.objects = vec![Object::new("vase")];
        spec.objects[0].parts = vec![Part { name: "pot".to_owned(), region: Region::Below(0.5), material: rigid }];
        spec
    }

    #[test]
    fn events_that_change_nothing_are_said() {
        let mut spec = spec();
        let of_pot = |event: Event| Event { part: Some("pot".to_owned()), ..event };
        let said = |spec: &Spec, event: &Event| without_effect(spec, event).unwrap_or_default();
        let weaken = Event { weaken: Some(0.5), ..Event::at("give", "vase", 1.0) };
        assert_eq!(without_effect(&spec, &weaken), None);
        assert!(said(&spec, &of_pot(weaken.clone())).contains("part pot of vase is rigid, which has no stiffness"));
        assert!(said(&spec, &of_pot(Event { freeze: true, ..Event::at("set", "vase", 1.0) })).contains("keeps its shape already"));
        assert!(said(&spec, &Event { push_m_s: Some([0.0; 3]), ..Event::at("push", "vase", 1.0) }).contains("no length"));
        let stuff = Event { material: Some(Material::Rigid(Rigid::default())), ..Event::at("change", "vase", 1.0) };
        assert_eq!(without_effect(&spec, &stuff), None);
        assert!(said(&spec, &of_pot(stuff.clone())).contains("of that stuff already"));
        // What another event may have made of it by then counts.
        spec.events.push(of_pot(Event { material: Some(Material::default()), ..Event::at("soft", "vase", 0.5) }));
        assert_eq!(without_effect(&spec, &of_pot(weaken)), None);
        let hold =
            Pin { name: "hold".to_owned(), object: "vase".to_owned(), region: Region::Above(0.0), from_s: 1.5, to_s: Until::End, path: Vec::new() };
        spec.pins.push(hold);
        let release = |at_s| Event { release: true, ..Event::at("let-go", "vase", at_s) };
        assert!(said(&spec, &release(1.0)).contains("nothing holds vase yet at 1 s"));
        assert_eq!(without_effect(&spec, &release(2.0)), None);
    }

    #[test]
    fn forces_without_strength_are_said_and_still_air_is_none() {
        let with = |fill: &dyn Fn(&mut Force)| {
            let mut force = Force::new("field", "vase", 0.0, Until::End);
            fill(&mut force);
            without_strength(&force)
        };
        assert!(with(&|f| f.set_constant([0.0; 3])).is_some_and(|s| s.contains("acceleration_m_s2 is 0")));
        assert!(with(&|f| f.attractor = Some(Attractor { centre_m: Auto::Auto, strength_m_s2: 0.0, radius_m: 1.0, falloff: 0.0 })).is_some());
        let wind = |drag_per_s| Wind { velocity_m_s: [0.0; 3], drag_per_s, gust: 0.0, turbulence: 0.0, eddy_m: 0.3 };
        assert!(with(&|f| f.wind = Some(wind(0.0))).is_some() && with(&|f| f.wind = Some(wind(1.0))).is_none());
    }
}
