//! What no schema says: names that must be unique and exist, times in order, vectors with a
//! direction, conditions that can be read.

use std::collections::BTreeSet;

use super::error::{SpecError, SpecErrorKind};
use super::expression::{Fault, Kind, Program, parse};
use super::{Activation, Auto, ColliderShape, Drive, Event, Force, Material, Motor, Region, Spec, Until, Vortex, canonical::number, expect, limits};

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

    for object in &spec.objects {
        let place = format!("object.{}", object.name);
        material(&object.material, &place)?;
        unique(&format!("{place}.part"), object.parts.iter().map(|part| part.name.as_str()))?;
        for part in &object.parts {
            let place = format!("{place}.part.{}", part.name);
            material(&part.material, &place)?;
            region(&part.region, &place)?;
        }
    }
    bodies(spec)?;
    let objects: Vec<&str> = spec.objects.iter().map(|object| object.name.as_str()).collect();
    for pin in &spec.pins {
        let place = format!("pin.{}", pin.name);
        known_object(&place, &pin.object, &objects)?;
        span(&place, pin.from_s, pin.to_s)?;
        let still = [pin.from_s, 0.0, 0.0, 0.0];
        let begins = pin.path.first().is_none_or(|first| first[0] != pin.from_s);
        points(&format!("{place}.path"), &if begins { [&[still], pin.path.as_slice()].concat() } else { pin.path.clone() })?;
        if let Some(first) = pin.path.first().filter(|first| first[0] <= pin.from_s && first[1..] != [0.0; 3]) {
            let message = format!("at {} s it is already {} m away", number(first[0]), number(first[1].hypot(first[2]).hypot(first[3])));
            return Err(SpecError::new(SpecErrorKind::Conflict, format!("{place}.path"), message).allowed("[from_s, 0, 0, 0] first, or a later time"));
        }
        region(&pin.region, &place)?;
    }
    for collider in &spec.colliders {
        if let ColliderShape::Plane(plane) = &collider.shape {
            heading(&format!("collider.{}.shape.plane.normal", collider.name), &plane.normal, "a normal")?;
        }
    }
    for force in &spec.forces {
        let place = format!("force.{}", force.name);
        known_object(&place, &force.object, &objects)?;
        span(&place, force.from_s, force.to_s)?;
        drive(&place, force)?;
    }
    steps(spec)?;
    for event in &spec.events {
        let place = format!("event.{}", event.name);
        known_object(&place, &event.object, &objects)?;
        self::event(spec, event, &place)?;
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

/// No more rigid bodies than there may be: objects and parts that start rigid or ever become so, each one at most.
fn bodies(spec: &Spec) -> Result<(), SpecError> {
    let rigid = |material: &Material| matches!(material, Material::Rigid(_));
    let count: usize = spec
        .objects
        .iter()
        .map(|object| {
            let becomes = |part: Option<&str>| {
                let of = |event: &&Event| event.object == object.name && (event.part.is_none() || event.part.as_deref() == part);
                spec.events.iter().filter(of).filter_map(|event| event.material.as_ref()).any(rigid)
            };
            let parts = object.parts.iter().filter(|part| rigid(&part.material) || becomes(Some(&part.name))).count();
            parts + usize::from(rigid(&object.material) || becomes(None))
        })
        .sum();
    if count > limits::RIGID as usize {
        let message = format!("{count} objects and parts are rigid, or become so");
        return Err(SpecError::new(SpecErrorKind::Range, "object", message).allowed(format!("at most {}", limits::RIGID)));
    }
    Ok(())
}

/// What no range says of a material.
fn material(material: &Material, owner: &str) -> Result<(), SpecError> {
    let place = format!("{owner}.material");
    let Material::Muscle(muscle) = material else { return Ok(()) };
    heading(&format!("{place}.fibre"), &muscle.fibre, "a direction")?;
    let Activation::Curve(points) = &muscle.activation else { return Ok(()) };
    let refuse = |message: String| {
        Err(SpecError::new(SpecErrorKind::Range, format!("{place}.activation"), message)
            .allowed("[time_s, activation] pairs, times rising, activation 0 to 1"))
    };
    for pair in points.windows(2) {
        if pair[1][0] <= pair[0][0] {
            return refuse(format!("{} s is not after {} s", number(pair[1][0]), number(pair[0][0])));
        }
    }
    match points.iter().find(|[time_s, value]| !(0.0..=limits::TIME_S).contains(time_s) || !(0.0..=1.0).contains(value)) {
        Some(point) => refuse(format!("[{}, {}] is out of range", number(point[0]), number(point[1]))),
        None => Ok(()),
    }
}

fn region(region: &Region, owner: &str) -> Result<(), SpecError> {
    match region {
        Region::HalfSpace(plane) => heading(&format!("{owner}.region.half_space.normal"), &plane.normal, "a normal"),
        _ => Ok(()),
    }
}

/// One time and one effect, on something that can have it.
fn event(spec: &Spec, event: &Event, place: &str) -> Result<(), SpecError> {
    let refuse = |message: String, allowed: &str| Err(SpecError::new(SpecErrorKind::Conflict, place, message).allowed(allowed));
    match (event.at_s, event.when) {
        (Some(_), Some(_)) => return refuse("at_s and when both say when".to_owned(), "one of them"),
        (None, None) => return refuse("it never happens".to_owned(), "at_s, or when = \"impact\""),
        _ => {}
    }
    match event.effects().as_slice() {
        [] => return refuse("nothing happens".to_owned(), EFFECTS),
        [_] => {}
        [first, second, ..] => return refuse(format!("{first} and {second} at once"), "one effect for each event; two events may have one time"),
    }
    if let Some(changed) = &event.material {
        material(changed, place)?;
    }
    let Some(object) = spec.objects.iter().find(|object| object.name == event.object) else { return Ok(()) };
    if let Some(part) = &event.part {
        if !object.parts.iter().any(|known| known.name == *part) {
            return Err(SpecError::unknown(format!("{place}.part"), "part", part, object.parts.iter().map(|part| part.name.as_str())));
        }
        if event.material.is_none() && event.weaken.is_none() && !event.freeze {
            return refuse(format!("{} acts on the whole object", event.effects().join("")), "part with material, weaken or freeze");
        }
    }
    let others = || spec.events.iter().filter(|other| other.object == event.object);
    if event.weaken.is_some() {
        let becomes = others().filter_map(|other| other.material.as_ref());
        let mut materials = std::iter::once(&object.material).chain(object.parts.iter().map(|part| &part.material)).chain(becomes);
        if !materials.any(|material| material.young_pa().is_some()) {
            return refuse(
                format!("{} has no stiffness that could weaken", object.material.kind()),
                "an event on something elastic, plastic, of sand or of snow",
            );
        }
    }
    if event.release && !others().any(|other| other.freeze) && !spec.pins.iter().any(|pin| pin.object == event.object) {
        return refuse(format!("nothing holds {}", event.object), "a pin on it, or an event that freezes it");
    }
    Ok(())
}

const EFFECTS: &str = "push_m_s, velocity_m_s, material, weaken, freeze or release, one of them";

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

/// Exactly one way to act, and that one whole.
fn drive(place: &str, force: &Force) -> Result<(), SpecError> {
    let conflict = |place: String, message: &str, allowed: &str| Err(SpecError::new(SpecErrorKind::Conflict, place, message).allowed(allowed));
    let ways = format!("{}, one of them", Force::WAYS.join(", "));
    match force.drives().as_slice() {
        [] => conflict(place.to_owned(), "nothing acts", &ways),
        [Drive::Expression(text)] => match parse(text, Kind::Vector) {
            Ok(_) => Ok(()),
            Err(fault) => Err(expression(&format!("{place}.acceleration_m_s2"), &fault)),
        },
        [Drive::Vortex(Vortex { axis, .. })] => heading(&format!("{place}.vortex.axis"), axis, "an axis"),
        [Drive::Motor(Motor { axis, .. })] => heading(&format!("{place}.motor.axis"), axis, "an axis"),
        [Drive::Drag(drag)] if drag.linear_per_s == 0.0 && drag.quadratic_per_m == 0.0 => {
            conflict(format!("{place}.drag"), "nothing acts", "linear_per_s or quadratic_per_m above 0")
        }
        [Drive::Spring(spring)] if spring.to_m.is_some() != spring.path_m.is_empty() => {
            let message = if spring.to_m.is_some() { "two goals at once" } else { "no goal" };
            conflict(format!("{place}.spring"), message, "to_m or path_m, one of them")
        }
        [Drive::Spring(spring)] => points(&format!("{place}.spring.path_m"), &spring.path_m),
        [_] => Ok(()),
        [..] => conflict(place.to_owned(), "several ways at once", &ways),
    }
}

/// A fault of an expression.
pub(super) fn expression(place: &str, fault: &Fault) -> SpecError {
    let mut error = SpecError::new(SpecErrorKind::Syntax, place, format!("{fault}"));
    // Its message says what is near already.
    error.allowed = None;
    error
}

/// All expressions together must compile in a moment.
fn steps(spec: &Spec) -> Result<(), SpecError> {
    let texts: BTreeSet<&str> = spec
        .forces
        .iter()
        .flat_map(Force::drives)
        .filter_map(|d| match d {
            Drive::Expression(text) => Some(text),
            _ => None,
        })
        .collect();
    let programs = texts.iter().filter_map(|text| Program::of(&parse(text, Kind::Vector).ok()?).ok());
    let sum: usize = programs.map(|p| p.instructions.len()).sum();
    if sum > limits::EXPRESSION_STEPS {
        let message = format!("the expressions of all forces take {sum} steps");
        return Err(SpecError::new(SpecErrorKind::Range, "force", message).allowed(format!("at most {}", limits::EXPRESSION_STEPS)));
    }
    Ok(())
}

/// Points of a path: within reach, one after another, and not faster than anything may be.
fn points(place: &str, path: &[[f64; 4]]) -> Result<(), SpecError> {
    let refuse = |message: String, allowed: &str| Err(SpecError::new(SpecErrorKind::Conflict, place, message).allowed(allowed));
    let far = |p: &&[f64; 4]| !(0.0..=limits::TIME_S).contains(&p[0]) || p[1..].iter().any(|x| x.abs() > limits::PLACE_M);
    if let Some(point) = path.iter().find(far) {
        return refuse(format!("[{}] is out of range", point.map(number).join(", ")), "times from 0 to 600, places within 1e5 m");
    }
    for pair in path.windows(2) {
        let (span_s, way) = (pair[1][0] - pair[0][0], [1, 2, 3].map(|a| pair[1][a] - pair[0][a]));
        if span_s <= 0.0 {
            return refuse(format!("{} s is not after {} s", number(pair[1][0]), number(pair[0][0])), "times that rise from point to point");
        }
        let speed = way.iter().map(|x| x * x).sum::<f64>().sqrt() / span_s;
        if speed > limits::SPEED_M_S {
            return refuse(format!("{} m/s from {} s on", number(speed.round()), number(pair[0][0])), "at most 200 m/s");
        }
    }
    Ok(())
}

/// A vector that says where to, whatever its length.
fn heading(place: &str, vector: &[f64; 3], what: &str) -> Result<(), SpecError> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    if (1e-6..1e6).contains(&length) {
        Ok(())
    } else {
        let fault = if length < 1.0 { "has no direction" } else { "is too long for one" };
        Err(SpecError::new(SpecErrorKind::Range, place, format!("{what} of length {} {fault}", number(length)))
            .allowed("a direction such as [0, 0, 1]"))
    }
}
