//! What no schema says: names that must be unique and exist, times in order, vectors with a
//! direction, conditions that can be read.

use std::collections::BTreeSet;

use super::error::{SpecError, SpecErrorKind};
use super::{Auto, ColliderShape, PlaneShape, Region, Spec, Until, canonical::number, expect};

/// Checks a spec whose structure and ranges are already right.
pub(super) fn spec(spec: &Spec) -> Result<(), SpecError> {
    if spec.scene.file.is_empty() {
        return Err(SpecError::new(SpecErrorKind::Missing, "scene.file", "no file").allowed("the path of a splat file, or builtin:demo"));
    }
    unique("object", spec.objects.iter().map(|object| object.name.as_str()))?;
    unique("pin", spec.pins.iter().map(|pin| pin.name.as_str()))?;
    unique("collider", spec.colliders.iter().map(|collider| collider.name.as_str()))?;
    unique("force", spec.forces.iter().map(|force| force.name.as_str()))?;
    unique("event", spec.events.iter().map(|event| event.name.as_str()))?;
    unique("expect", spec.expectations.iter().map(|expectation| expectation.that.as_str()))?;

    let objects: Vec<&str> = spec.objects.iter().map(|object| object.name.as_str()).collect();
    for pin in &spec.pins {
        let place = format!("pin.{}", pin.name);
        known_object(&place, &pin.object, &objects)?;
        span(&place, pin.from_s, pin.to_s)?;
        if let Region::HalfSpace(plane) = &pin.region {
            direction(&format!("{place}.region.half_space"), plane)?;
        }
    }
    for collider in &spec.colliders {
        if let ColliderShape::Plane(plane) = &collider.shape {
            direction(&format!("collider.{}.shape.plane", collider.name), plane)?;
        }
    }
    for force in &spec.forces {
        let place = format!("force.{}", force.name);
        known_object(&place, &force.object, &objects)?;
        span(&place, force.from_s, force.to_s)?;
    }
    for event in &spec.events {
        let place = format!("event.{}", event.name);
        known_object(&place, &event.object, &objects)?;
        if event.push_m_s.is_some() == event.velocity_m_s.is_some() {
            let message = if event.push_m_s.is_some() { "two things at once" } else { "nothing happens" };
            return Err(SpecError::new(SpecErrorKind::Conflict, place, message).allowed("push_m_s or velocity_m_s, one of them"));
        }
    }
    if let Auto::Value(camera) = &spec.camera
        && camera.eye_m == camera.target_m
    {
        return Err(SpecError::new(SpecErrorKind::Conflict, "camera", "eye_m and target_m are the same point").allowed("two points"));
    }
    for expectation in &spec.expectations {
        expect::Condition::parse(&expectation.that)?.refers_to(&objects)?;
    }
    Ok(())
}

fn unique<'a>(list: &str, names: impl Iterator<Item = &'a str>) -> Result<(), SpecError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(SpecError::new(SpecErrorKind::Duplicate, format!("{list}.{name}"), format!("two entries are called `{name}`"))
                .allowed("a name of its own each"));
        }
    }
    Ok(())
}

fn known_object(place: &str, name: &str, objects: &[&str]) -> Result<(), SpecError> {
    if objects.contains(&name) { Ok(()) } else { Err(SpecError::unknown(format!("{place}.object"), "object", name, objects.iter().copied())) }
}

fn span(place: &str, from_s: f64, to_s: Until) -> Result<(), SpecError> {
    match to_s {
        Until::Time(to_s) if to_s <= from_s => {
            let message = format!("{} is not after from_s = {}", number(to_s), number(from_s));
            Err(SpecError::new(SpecErrorKind::Conflict, format!("{place}.to_s"), message).allowed("a later time, or \"end\""))
        }
        _ => Ok(()),
    }
}

fn direction(place: &str, plane: &PlaneShape) -> Result<(), SpecError> {
    let length = plane.normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if (1e-6..1e6).contains(&length) {
        Ok(())
    } else {
        Err(SpecError::new(SpecErrorKind::Range, format!("{place}.normal"), format!("a normal of length {} has no direction", number(length)))
            .allowed("a direction such as [0, 0, 1]"))
    }
}
