//! A spec in the solver's terms.

use super::Resolved;
use super::bodies::Matter;
use super::region::bounds;
use crate::solver::{Collider, Field, ObjectForce, PinRegion, Plane, Settings};
use crate::spec::{BoxShape, ColliderShape, FieldFacts, Force, Pin, PlaneShape, Region, Spec, Until};
use glam::{DVec3, Vec3};

/// What surrounds the particles of a spec.
pub fn settings(spec: &Spec, matter: &Matter, resolved: &Resolved) -> Settings {
    let ground = spec.world.ground;
    let object = |name: &str| spec.objects.iter().position(|o| o.name == name);
    Settings {
        gravity_m_s2: Vec3::from(spec.world.gravity_m_s2.map(|g| g as f32)),
        ground: Some(Plane { height_m: resolved.ground_m as f32, friction: ground.friction as f32, restitution: ground.restitution as f32 }),
        colliders: spec
            .colliders
            .iter()
            .map(|c| Collider { shape: c.shape, friction: c.friction as f32, restitution: c.restitution as f32 })
            .collect(),
        pins: spec.pins.iter().filter_map(|p| Some(pin(p, lets_go_s(spec, p), matter, object(&p.object)?))).collect(),
        forces: spec
            .forces
            .iter()
            .filter_map(|f| {
                let acceleration_m_s2 = Vec3::from(f.constant_m_s2()?.map(|a| a as f32));
                Some(ObjectForce { object: object(&f.object)? as u32, from_s: f.from_s, to_s: f.ends_s(), acceleration_m_s2 })
            })
            .collect(),
        fields: spec.forces.iter().filter_map(|f| field(f, spec, matter, object(&f.object)?)).collect(),
        frame_s: 1.0 / f64::from(spec.time.fps),
        seed: spec.seed,
        substeps_most: spec.solver.substeps_most,
        ..Settings::new(resolved.cell_m as f32)
    }
}

/// A force that is an expression. One that cannot be read is no part of a valid spec.
fn field(force: &Force, spec: &Spec, matter: &Matter, object: usize) -> Option<Field> {
    let captured_m = matter.centre_m[object].as_dvec3();
    let start_m = captured_m + DVec3::from(spec.objects[object].offset_m);
    let facts = FieldFacts { captured_m: captured_m.into(), start_m: start_m.into(), seed: spec.seed };
    let acceleration = force.program(&facts).ok().flatten()?;
    Some(Field { name: force.name.clone(), object: object as u32, from_s: force.from_s, to_s: force.ends_s(), acceleration })
}

fn end_s(until: Until) -> f64 {
    match until {
        Until::End => f64::INFINITY,
        Until::Time(time_s) => time_s,
    }
}

/// When a pin lets go: at its end, or where an event releases its object before.
pub(super) fn lets_go_s(spec: &Spec, pin: &Pin) -> f64 {
    end_s(pin.to_s).min(released_s(spec, pin))
}

/// When an event first releases an object after a pin began.
fn released_s(spec: &Spec, pin: &Pin) -> f64 {
    let events = spec.events.iter().filter(|e| e.release && e.object == pin.object);
    events.filter_map(|e| e.at_s).filter(|at_s| *at_s > pin.from_s).fold(f64::INFINITY, f64::min)
}

/// A region of an object as a shape within the object's captured bounds; it goes with the object to where that starts.
fn pin(pin: &Pin, to_s: f64, matter: &Matter, object: usize) -> PinRegion {
    let (low, high) = bounds(&matter.particles.position_m[matter.bodies.ranges[object].clone()]);
    let level = |share: f64| f64::from(low.z) + share * f64::from(high.z - low.z);
    let slab = |from: f64, to: f64| {
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        // A little wider than the object, so that what lies on its faces is held too.
        let margin = 0.01 * (high - low).max_element();
        let size_m = [high.x - low.x + 2.0 * margin, high.y - low.y + 2.0 * margin, to - from + margin];
        ColliderShape::Box(BoxShape { centre_m: [(low.x + high.x) / 2.0, (low.y + high.y) / 2.0, (from + to) / 2.0], size_m })
    };
    let shape = match pin.region {
        Region::Above(share) => slab(level(share), f64::from(high.z)),
        Region::Below(share) => slab(f64::from(low.z), level(share)),
        Region::Box(shape) => ColliderShape::Box(shape),
        Region::Sphere(shape) => ColliderShape::Sphere(shape),
        Region::HalfSpace(PlaneShape { point_m, normal }) => ColliderShape::Plane(PlaneShape { point_m, normal }),
    };
    PinRegion { object: object as u32, shape, low_m: low, high_m: high, from_s: pin.from_s, to_s, path: pin.path.clone() }
}
