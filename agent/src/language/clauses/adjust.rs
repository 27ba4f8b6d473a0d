//! More and less: which property a clause speaks of, and the ground's friction and bounce.

use super::super::clause::{Clause, Scale, step};
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Preposition, Property, Sense, Verb};
use super::amounts;
use super::pace::{self, NOTHING_MOVES};
use super::stuff;
use phystalk::spec::Auto;

/// Every property that stands without a verb.
const ALL: &[Property] = &[
    Property::Stiffness,
    Property::Hardness,
    Property::Density,
    Property::Height,
    Property::Speed,
    Property::Strength,
    Property::Size,
    Property::Bounce,
    Property::Friction,
    Property::Duration,
    Property::Gravity,
    Property::FrameRate,
    Property::Poisson,
    Property::Detail,
    Property::Viscosity,
    Property::Tension,
    Property::Cohesion,
    Property::Hold,
    Property::Stick,
    Property::Yield,
    Property::Slope,
];

/// Reads every property that the clause speaks of; whether there was one.
pub fn understand(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let mut any = false;
    // Numbers with units that belong to one property only need no name.
    // "5 Pa s" is of nothing else.
    for (dimension, property) in [(Dimension::Viscosity, Property::Viscosity), (Dimension::Tension, Property::Tension)] {
        if clause.has(|s| matches!(s, Sense::Measure(q, _) if q.dimension == dimension)) {
            clause.take_sense(&Sense::Property(property));
            amounts::set(property, clause, draft)?;
            any = true;
        }
    }
    let of_strength = clause.has(|s| matches!(s, Sense::Property(p) if amounts::ALL.contains(p)));
    if !of_strength && let Some((young, _)) = clause.take_measure(Dimension::Pressure) {
        clause.take_scale(&[Property::Stiffness, Property::Hardness]);
        stuff::set_young(clause, draft, young)?;
        any = true;
    }
    if let Some((density, _)) = clause.take_measure(Dimension::Density) {
        clause.take_scale(&[Property::Density]);
        stuff::set_density(clause, draft, density)?;
        any = true;
    }
    if clause.take_measure(Dimension::Mass).is_some() {
        return Err("a mass is not set directly, for it depends on the solid that is made of the capture: \"density 500 kg/m³\", \"twice as heavy\""
            .to_owned());
    }
    if let Some((fps, _)) = clause.take_measure(Dimension::FrameRate) {
        clause.take_scale(&[Property::FrameRate]);
        pace::set_fps(draft, fps)?;
        any = true;
    }
    while let Some(scale) = clause.take_scale(ALL) {
        property(scale, clause, draft)?;
        any = true;
    }
    Ok(any)
}

fn property(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    // "gravity of 5 m/s2", "friction 0.5": the property by name, with its value.
    if !scale.asked {
        return named(scale.property, clause, draft);
    }
    if scale.ratio <= 0.0 || !scale.ratio.is_finite() {
        return Err("nothing would be left of it".to_owned());
    }
    draft.compare(scale.property, scale.ratio > 1.0, clause)?;
    match scale.property {
        Property::Stiffness => stuff::stiffness(scale, clause, draft),
        Property::Hardness if pace::pushed_last(draft) => {
            let objects = draft.subjects(clause)?;
            pace::speed(draft, &objects, scale.ratio.powf(1.5f64.log2()))
        }
        Property::Hardness => stuff::stiffness(scale, clause, draft),
        Property::Density => stuff::weight(scale, clause, draft),
        Property::Height => pace::height(scale, clause, draft),
        Property::Speed | Property::Strength => {
            let objects = draft.subjects(clause)?;
            pace::speed(draft, &objects, scale.ratio)
        }
        Property::Size => Err("size is not built yet: things move as they were captured; \"a bigger jump\" is understood".to_owned()),
        Property::Bounce => {
            clause.take_sense(&Sense::Ground);
            bounce(scale, draft);
            Ok(())
        }
        Property::Stick if amounts::sticks(clause, draft) => amounts::scale(scale, clause, draft),
        Property::Friction | Property::Stick => {
            clause.take_sense(&Sense::Ground);
            let ratio = scale.ratio.powf(step(Property::Friction).ln() / step(scale.property).ln());
            let before = draft.spec.world.ground.friction;
            let after = if before == 0.0 && ratio > 1.0 { 0.1 } else { before * ratio };
            set_friction(draft, after, ratio);
            Ok(())
        }
        Property::Duration => {
            pace::duration(scale, clause, draft);
            Ok(())
        }
        Property::Gravity => {
            let before = draft.gravity_m_s2();
            if before < 1e-6 {
                return Err("there is no gravity to change: \"on earth\", \"gravity of 5 m/s²\"".to_owned());
            }
            super::world::set_gravity(draft, before * scale.ratio);
            Ok(())
        }
        Property::FrameRate => pace::set_fps(draft, f64::from(draft.spec.time.fps) * scale.ratio),
        Property::Detail => {
            detail(scale.ratio, draft);
            Ok(())
        }
        Property::Viscosity | Property::Tension | Property::Cohesion | Property::Hold | Property::Yield | Property::Slope => {
            amounts::scale(scale, clause, draft)
        }
        Property::Poisson => Err("Poisson's ratio is a number from 0 to 0.49: \"Poisson's ratio 0.4\"".to_owned()),
        Property::Distance | Property::FieldOfView => Err("that is the camera's: \"camera closer\"".to_owned()),
    }
}

/// A property by its name, with a number.
fn named(property: Property, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let mut plain =
        || clause.take_measure(Dimension::Plain).or_else(|| clause.take_measure(Dimension::Percent).map(|(v, l)| (v / 100.0, l))).map(|(v, _)| v);
    match property {
        Property::Gravity => {
            let value = clause.take_measure(Dimension::Acceleration).or_else(|| clause.take_measure(Dimension::Plain)).map(|(v, _)| v);
            super::world::set_gravity(draft, value.ok_or("how much gravity? \"gravity of 5 m/s²\", \"half the gravity\", \"on mars\"")?.abs());
        }
        Property::Stiffness => {
            let value = plain().ok_or("how stiff? \"stiffness 30 kPa\", \"twice as stiff\", \"softer\"")?;
            stuff::set_young(clause, draft, value)?;
        }
        Property::Density => {
            let value = plain().ok_or("how dense? \"density 500 kg/m³\", \"twice as heavy\"")?;
            stuff::set_density(clause, draft, value)?;
        }
        Property::Friction => {
            let value = plain().ok_or("how much friction? \"friction 0.5\", \"more slippery\", \"on ice\"")?;
            clause.take_sense(&Sense::Ground);
            super::world::set_all_friction(draft, value);
        }
        Property::Bounce => {
            let value = plain().ok_or("how bouncy? \"bounciness 0.5\", \"bouncier\"")?.clamp(0.0, 1.0);
            clause.take_sense(&Sense::Ground);
            set_restitution(draft, value);
        }
        Property::Poisson => {
            let value = plain().filter(|v| (0.0..=0.49).contains(v)).ok_or("Poisson's ratio is a number from 0 to 0.49")?;
            stuff::set_poisson(clause, draft, value)?;
        }
        Property::FrameRate => {
            let value = plain().ok_or("how many? \"at 100 fps\"")?;
            pace::set_fps(draft, value)?;
        }
        Property::Duration => {
            let value = clause.take_measure(Dimension::Time).or_else(|| clause.take_measure(Dimension::Plain)).map(|(v, _)| v);
            super::world::set_duration(draft, value.ok_or("how long? \"for 3 seconds\", \"longer\"")?)?;
        }
        Property::Speed | Property::Strength => {
            let (value, _) = clause.take_measure_or_plain(Dimension::Speed).ok_or("how fast? \"push it at 3 m/s\", \"faster\"")?;
            let objects = draft.subjects(clause)?;
            let before = pace::current_speed(draft, objects[0]).ok_or(NOTHING_MOVES)?;
            pace::speed(draft, &objects, value / before)?;
        }
        Property::Height => {
            let (value, _) = clause.take_measure_or_plain(Dimension::Length).ok_or("how high? \"jump 30 cm\", \"drop it from 1 m\"")?;
            for object in draft.subjects(clause)? {
                let rising = draft.spec.objects[object].velocity_m_s[2];
                if rising > 0.0 {
                    let was = rising * rising / (2.0 * draft.gravity_for_heights_m_s2());
                    pace::set_jump(draft, object, was, value);
                } else {
                    super::place::raise(draft, object, value)?;
                }
            }
        }
        Property::Detail => {
            let cells = plain().ok_or("how fine? \"finer\", \"resolution 96\"")?;
            draft.spec.solver.cells_across = Auto::Value(cells.round().clamp(4.0, 1024.0) as u32);
            draft.gloss.push(format!("{} grid cells along the longest side", cells.round()));
        }
        property if amounts::ALL.contains(&property) => amounts::set(property, clause, draft)?,
        _ => return Err("how much?".to_owned()),
    }
    Ok(())
}

/// How fine the grid is; an automatic one is taken for that of full quality.
fn detail(ratio: f64, draft: &mut Draft) {
    let before = draft.spec.solver.cells_across.unwrap_or(phystalk::world::CELLS_ACROSS_FULL);
    let after = (f64::from(before) * ratio).round().clamp(4.0, 1024.0) as u32;
    draft.spec.solver.cells_across = Auto::Value(after);
    draft.gloss.push(format!("{after} grid cells along the longest side instead of {before}"));
}

/// "vase is softer", or "vase is less heavy" as asked.
pub fn comparative(name: String, scale: Scale, more: &str, less: &str) -> String {
    format!("{name} is {}", if scale.ratio > 1.0 { more } else { less })
}

/// Bounciness is the ground's and the colliders' here: "bouncier" takes two fifths of the way to 1, "less bouncy" halves.
fn bounce(scale: Scale, draft: &mut Draft) {
    // Of two that meet the larger counts.
    let own = draft.spec.objects.iter().filter_map(|object| object.material.restitution());
    let before = own.fold(draft.spec.world.ground.restitution, f64::max);
    let after = if scale.ratio > 1.0 { 1.0 - (1.0 - before) * 0.6f64.powf(scale.ratio.log2()) } else { before * scale.ratio };
    set_restitution(draft, after);
}

pub fn set_restitution(draft: &mut Draft, restitution: f64) {
    let restitution = say::tidy(restitution);
    draft.spec.world.ground.restitution = restitution;
    for collider in &mut draft.spec.colliders {
        collider.restitution = restitution;
    }
    let mut who = "what is below".to_owned();
    for object in &mut draft.spec.objects {
        if let Some(own) = object.material.restitution_mut() {
            *own = restitution;
            who = format!("{who}, and {}", object.name);
        }
    }
    draft.gloss.push(format!("{who} gives back {} % of the speed", say::short(restitution * 100.0)));
}

fn set_friction(draft: &mut Draft, ground: f64, ratio: f64) {
    let before = draft.spec.world.ground.friction;
    draft.spec.world.ground.friction = say::tidy(ground);
    for collider in &mut draft.spec.colliders {
        collider.friction = say::tidy(collider.friction * ratio);
    }
    let others = if draft.spec.colliders.is_empty() { "" } else { ", and what stands on it alike" };
    draft.gloss.push(format!("friction of the ground {} to {}{others}", say::short(before), say::short(ground)));
}

/// Whether a verb is light beside a material or an adjective: "turn it into jelly", "put it on the moon".
pub fn is_light(verb: Verb, clause: &Clause) -> bool {
    let says = |pick: &dyn Fn(&Sense) -> bool| clause.phrases().iter().any(|p| pick(&p.sense));
    let into = says(&|s| *s == Sense::Preposition(Preposition::Into));
    let material = says(&|s| matches!(s, Sense::Material(_) | Sense::Unbuilt(_)));
    let pose = says(&|s| matches!(s, Sense::Pose(_)));
    let property = says(&|s| matches!(s, Sense::Property(p) if *p != Property::Height));
    let place = says(&|s| matches!(s, Sense::Gravity(_) | Sense::Surface(_)));
    let driven = says(&|s| matches!(s, Sense::Verb(Verb::Field(_))));
    let directed = clause.has(|s| matches!(s, Sense::Direction(_) | Sense::Measure(..)));
    match verb {
        Verb::Turn => (material && (into || !directed)) || property || pose,
        Verb::Move => ((material || place || pose || driven) && !directed) || property,
        Verb::Lift => property,
        // "It shatters into sand", not "the sand melts".
        Verb::Change(_) => {
            let at = |pick: &dyn Fn(&Sense) -> bool| clause.phrases().iter().position(|p| pick(&p.sense));
            material && at(&|s| *s == Sense::Verb(verb)) < at(&|s| matches!(s, Sense::Material(_) | Sense::Unbuilt(_)))
        }
        _ => false,
    }
}
