//! More and less: stiffness, weight, height, speed, friction, bounce, length of the run, gravity.

use super::super::clause::{Clause, Scale};
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Preposition, Property, Sense, Verb};
use glam::DVec3;
use phystalk::spec::{Auto, Event, Material, Part, Region, presets};

/// Stiffness taken for "softer" where the automatic one is not known: before the first run of a scene.
pub const YOUNG_BEFORE_RUN_PA: f64 = 2e5;

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
];

/// Reads every property that the clause speaks of; whether there was one.
pub fn understand(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let mut any = false;
    // Numbers with units that belong to one property only need no name.
    if let Some((young, _)) = clause.take_measure(Dimension::Pressure) {
        clause.take_scale(&[Property::Stiffness, Property::Hardness]);
        set_young(clause, draft, young)?;
        any = true;
    }
    if let Some((density, _)) = clause.take_measure(Dimension::Density) {
        clause.take_scale(&[Property::Density]);
        for object in draft.subjects(clause)? {
            set_density(draft, object, density);
            let line = format!("{} has a density of {} kg/m³", draft.name(object), say::short(density));
            draft.gloss.push(line);
        }
        any = true;
    }
    if clause.take_measure(Dimension::Mass).is_some() {
        return Err("a mass is not set directly, for it depends on the solid that is made of the capture: \"density 500 kg/m³\", \"twice as heavy\""
            .to_owned());
    }
    if let Some((fps, _)) = clause.take_measure(Dimension::FrameRate) {
        clause.take_scale(&[Property::FrameRate]);
        set_fps(draft, fps)?;
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
    match scale.property {
        Property::Stiffness => stiffness(scale, clause, draft),
        Property::Hardness if pushed_last(draft) => {
            let objects = draft.subjects(clause)?;
            speed(draft, &objects, scale.ratio.powf(1.5f64.log2()))
        }
        Property::Hardness => stiffness(scale, clause, draft),
        Property::Density => {
            for object in draft.subjects(clause)? {
                let before = draft.material(object).density_kg_m3();
                let after = say::tidy(before * scale.ratio);
                set_density(draft, object, after);
                let line = format!(
                    "{}: {} to {} kg/m³",
                    comparative(draft.name(object), scale, "heavier", "lighter"),
                    say::short(before),
                    say::short(after)
                );
                draft.gloss.push(line);
            }
            Ok(())
        }
        Property::Height => height(scale, clause, draft),
        Property::Speed | Property::Strength => {
            let objects = draft.subjects(clause)?;
            speed(draft, &objects, scale.ratio)
        }
        Property::Size => Err("size is not built yet: things move as they were captured; \"a bigger jump\" is understood".to_owned()),
        Property::Bounce => {
            clause.take_sense(&Sense::Ground);
            bounce(scale, draft);
            Ok(())
        }
        Property::Friction => {
            clause.take_sense(&Sense::Ground);
            let before = draft.spec.world.ground.friction;
            let after = if before == 0.0 && scale.ratio > 1.0 { 0.1 } else { before * scale.ratio };
            set_friction(draft, after, scale.ratio);
            Ok(())
        }
        Property::Duration => {
            duration(scale, clause, draft);
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
        Property::FrameRate => set_fps(draft, f64::from(draft.spec.time.fps) * scale.ratio),
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
            set_young(clause, draft, value)?;
        }
        Property::Density => {
            let value = plain().ok_or("how dense? \"density 500 kg/m³\", \"twice as heavy\"")?;
            for object in draft.subjects(clause)? {
                set_density(draft, object, value);
                let line = format!("{} has a density of {} kg/m³", draft.name(object), say::short(value));
                draft.gloss.push(line);
            }
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
            for object in draft.subjects(clause)? {
                *draft.material(object).poisson_mut().ok_or("what flows or is rigid has no Poisson's ratio")? = say::tidy(value);
                let line = format!("{} has a Poisson's ratio of {}", draft.name(object), say::short(value));
                draft.gloss.push(line);
            }
        }
        Property::FrameRate => {
            let value = plain().ok_or("how many? \"at 100 fps\"")?;
            set_fps(draft, value)?;
        }
        Property::Duration => {
            let value = clause.take_measure(Dimension::Time).or_else(|| clause.take_measure(Dimension::Plain)).map(|(v, _)| v);
            super::world::set_duration(draft, value.ok_or("how long? \"for 3 seconds\", \"longer\"")?)?;
        }
        Property::Speed | Property::Strength => {
            let (value, _) = clause.take_measure_or_plain(Dimension::Speed).ok_or("how fast? \"push it at 3 m/s\", \"faster\"")?;
            let objects = draft.subjects(clause)?;
            let before = current_speed(draft, objects[0]).ok_or(NOTHING_MOVES)?;
            speed(draft, &objects, value / before)?;
        }
        Property::Height => {
            let (value, _) = clause.take_measure_or_plain(Dimension::Length).ok_or("how high? \"jump 30 cm\", \"drop it from 1 m\"")?;
            for object in draft.subjects(clause)? {
                let rising = draft.spec.objects[object].velocity_m_s[2];
                if rising > 0.0 {
                    let was = rising * rising / (2.0 * draft.gravity_for_heights_m_s2());
                    set_jump(draft, object, was, value);
                } else {
                    super::place::raise(draft, object, value)?;
                }
            }
        }
        Property::Hardness | Property::Size | Property::Distance | Property::FieldOfView => return Err("how much?".to_owned()),
    }
    Ok(())
}

/// "vase is softer", or "vase is less heavy" as asked.
fn comparative(name: String, scale: Scale, more: &str, less: &str) -> String {
    format!("{name} is {}", if scale.ratio > 1.0 { more } else { less })
}

fn stiffness(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    for object in draft.subjects(clause)? {
        let name = draft.name(object);
        let (before, note) = young_pa(draft, object)?;
        let after = say::tidy(before * scale.ratio);
        *draft.young_pa(object)? = Auto::Value(after);
        let words = comparative(name, scale, "stiffer", "softer");
        draft.gloss.push(format!("{words}: Young's modulus {}{note} to {}", say::pressure(before), say::pressure(after)));
    }
    Ok(())
}

/// Young's modulus of an object, resolved where it is automatic, and a note that says so.
pub fn young_pa(draft: &mut Draft, object: usize) -> Result<(f64, &'static str), Refusal> {
    let path = format!("object.{}.material.young_pa", draft.name(object));
    Ok(match *draft.young_pa(object)? {
        Auto::Value(value) => (value, ""),
        Auto::Auto => match draft.resolved(&path) {
            Some(value) => (value, " (automatic until now)"),
            None => (YOUNG_BEFORE_RUN_PA, " (taken for the automatic one, which is known after a run)"),
        },
    })
}

fn set_density(draft: &mut Draft, object: usize, density_kg_m3: f64) {
    if let Some(density) = draft.material(object).density_mut() {
        *density = say::tidy(density_kg_m3);
    }
}

fn set_young(clause: &mut Clause, draft: &mut Draft, young_pa: f64) -> Result<(), Refusal> {
    for object in draft.subjects(clause)? {
        *draft.young_pa(object)? = Auto::Value(say::tidy(young_pa));
        let line = format!("{} has a Young's modulus of {}", draft.name(object), say::pressure(young_pa));
        draft.gloss.push(line);
    }
    Ok(())
}

/// A preset by its name; "elastic" alone is the automatic stiffness of things of no named material.
pub fn material(name: &'static str, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    // "as soft as jelly", "the stiffness of rubber": that property alone.
    let like = clause.has(|s| *s == Sense::As) || clause.has(|s| matches!(s, Sense::Property(_)));
    let times = clause.has(|s| matches!(s, Sense::Factor(_)));
    let only = if like { clause.take_scale(&[Property::Stiffness, Property::Hardness, Property::Density]) } else { None };
    let preset = presets::material(name).map(|preset| preset.material.clone());
    let part = super::hold::take_part(clause).map(super::hold::region_of);
    let objects = draft.subjects(clause)?;
    // Beside a motion the time is the motion's: "push the jelly vase at 1 s".
    let moves = clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(verb) if !is_light(verb, clause)));
    let at_s = if moves || only.is_some() { None } else { super::motion::moment(clause, draft, objects[0])? };
    for object in objects {
        let line = match (only, &preset) {
            (Some(scale), Some(preset)) => resemble(draft, object, name, preset, scale, times)?,
            // "The elastic vase jumps" says what it is.
            (_, None) if name == "elastic" && part.is_none() && at_s.is_none() && draft.material(object).kind() == "elastic" => {
                format!("{} is elastic", draft.name(object))
            }
            (_, preset) => become_stuff(draft, object, part, at_s, (name, &preset.clone().or_else(|| Material::of_kind(name)).unwrap_or_default())),
        };
        draft.gloss.push(line);
    }
    Ok(())
}

/// An object, or a part of its height, is of some stuff, from the start or from a time on.
fn become_stuff(
    draft: &mut Draft,
    object: usize,
    part: Option<(&'static str, Region, &'static str)>,
    at_s: Option<f64>,
    (name, stuff): (&str, &Material),
) -> String {
    let owner = draft.name(object);
    let who = part.map_or(owner.clone(), |(_, _, said)| format!("{said} of {owner}"));
    let part = part.map(|(stem, region, _)| part_of(draft, object, stem, region));
    let described = format!("{name}: {}", say::material(stuff));
    let Some(at_s) = at_s else {
        match part {
            Some(index) => draft.object(object).parts[index].material = stuff.clone(),
            None => *draft.material(object) = stuff.clone(),
        }
        return format!("{who} is made of {described}");
    };
    let part = part.map(|index| draft.spec.objects[object].parts[index].name.clone());
    let at_s = say::tidy(at_s);
    let same = |e: &&mut Event| e.object == owner && e.part == part && e.at_s == Some(at_s) && e.material.is_some();
    match draft.spec.events.iter_mut().find(same) {
        Some(event) => event.material = Some(stuff.clone()),
        None => {
            let event = draft.free_name("change", |spec, name| spec.events.iter().any(|e| e.name == name));
            draft.spec.events.push(Event { part, material: Some(stuff.clone()), ..Event::at(&event, &owner, at_s) });
        }
    }
    format!("{who} turns into {described}, at {}", say::seconds(at_s))
}

/// The part of an object that has a region, made of the object's own stuff where there was none.
fn part_of(draft: &mut Draft, object: usize, stem: &str, region: Region) -> usize {
    let thing = draft.object(object);
    if let Some(index) = thing.parts.iter().position(|part| part.region == region) {
        return index;
    }
    let taken = |name: &str| thing.parts.iter().any(|part| part.name == name);
    let name = (1..).map(|n| if n == 1 { stem.to_owned() } else { format!("{stem}{n}") }).find(|name| !taken(name)).unwrap_or_default();
    let material = thing.material.clone();
    thing.parts.push(Part { name, region, material });
    thing.parts.len() - 1
}

/// One property of a preset: "as soft as jelly", "twice the density of foam".
fn resemble(draft: &mut Draft, object: usize, name: &str, preset: &Material, scale: Scale, times: bool) -> Result<String, Refusal> {
    let ratio = if times { scale.ratio } else { 1.0 };
    let share = if times { format!("{} times ", say::short(ratio)) } else { String::new() };
    if scale.property == Property::Density {
        let density = say::tidy(preset.density_kg_m3() * ratio);
        set_density(draft, object, density);
        return Ok(format!("{} has {share}the density of {name}: {} kg/m³", draft.name(object), say::short(density)));
    }
    let Some(Auto::Value(young)) = preset.young_pa() else { return Err(format!("{name} has no stiffness of its own")) };
    let young = say::tidy(young * ratio);
    *draft.young_pa(object)? = Auto::Value(young);
    Ok(format!("{} has {share}the stiffness of {name}: Young's modulus {}", draft.name(object), say::pressure(young)))
}

fn height(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let gravity = draft.gravity_for_heights_m_s2();
    for object in draft.subjects(clause)? {
        let rising = draft.spec.objects[object].velocity_m_s[2];
        let gap = draft.gap_m(object);
        if rising > 0.0 {
            let rise = rising * rising / (2.0 * gravity);
            set_jump(draft, object, rise, rise * scale.ratio);
        } else if gap > 1e-3 {
            super::place::raise(draft, object, gap * scale.ratio)?;
        } else if scale.ratio > 1.0 {
            let usual = super::motion::JUMP_HEIGHTS * draft.facts(object).height_m();
            set_jump(draft, object, 0.0, usual * scale.ratio);
        } else {
            return Err(format!("{} neither jumps nor drops, so it cannot be lower", draft.name(object)));
        }
    }
    Ok(())
}

fn set_jump(draft: &mut Draft, object: usize, before_m: f64, after_m: f64) {
    let up = (2.0 * draft.gravity_for_heights_m_s2() * after_m).sqrt();
    draft.set_speed_along(object, DVec3::Z, up);
    let from = if before_m > 0.0 { format!(" instead of {}", say::metres(before_m)) } else { String::new() };
    let line = format!("{} jumps {}{from}: {} up", draft.name(object), say::metres(after_m), say::speed(up));
    draft.gloss.push(line);
}

const NOTHING_MOVES: &str = "nothing moves yet that could be faster or slower: \"push it forward\", \"make it jump\"";

/// Whether the newest turn was about a push: then "harder" speaks of it, and not of the material.
fn pushed_last(draft: &Draft) -> bool {
    draft.context.previous_spec.is_some_and(|before| {
        let now = draft.context.spec;
        let velocities = |spec: &phystalk::spec::Spec| spec.objects.iter().map(|o| o.velocity_m_s).collect::<Vec<_>>();
        before.events != now.events || velocities(before) != velocities(now) || before.forces != now.forces
    })
}

/// Whether there is anything whose speed could change.
pub fn has_speed(draft: &Draft, objects: &[usize]) -> bool {
    objects.iter().any(|o| current_speed(draft, *o).is_some())
}

/// The speed that "faster" speaks of: what the newest turn changed, else the initial velocity, else the last push, else the spin.
fn current_speed(draft: &Draft, object: usize) -> Option<f64> {
    let thing = &draft.spec.objects[object];
    match target(draft, object)? {
        Target::Velocity => Some(DVec3::from_array(thing.velocity_m_s).length()),
        Target::Event(i) => draft.spec.events[i].push_m_s.map(|p| DVec3::from_array(p).length()),
        Target::Force(i) => draft.spec.forces[i].strength().map(|(strength, _)| strength),
        Target::Spin => Some(DVec3::from_array(thing.spin_rad_s).length()),
    }
}

/// What a change of speed concerns.
enum Target {
    Velocity,
    Event(usize),
    Force(usize),
    Spin,
}

fn target(draft: &Draft, object: usize) -> Option<Target> {
    let thing = &draft.spec.objects[object];
    let moves = thing.velocity_m_s != [0.0; 3];
    let spins = thing.spin_rad_s != [0.0; 3];
    let event = draft.spec.events.iter().rposition(|e| e.object == thing.name && e.push_m_s.is_some());
    let force = draft.spec.forces.iter().rposition(|f| f.object == thing.name && f.strength().is_some());
    if let Some(before) = draft.context.previous_spec {
        let was = before.objects.iter().find(|o| o.name == thing.name);
        let now = &draft.context.spec;
        if let Some(i) = event.filter(|_| before.events != now.events) {
            return Some(Target::Event(i));
        }
        if let Some(i) = force.filter(|_| before.forces != now.forces) {
            return Some(Target::Force(i));
        }
        if moves && was.is_some_and(|w| w.velocity_m_s != thing.velocity_m_s) {
            return Some(Target::Velocity);
        }
        if spins && was.is_some_and(|w| w.spin_rad_s != thing.spin_rad_s) {
            return Some(Target::Spin);
        }
    }
    if moves {
        return Some(Target::Velocity);
    }
    event.map(Target::Event).or(force.map(Target::Force)).or(spins.then_some(Target::Spin))
}

/// Multiplies the speed that is spoken of.
pub fn speed(draft: &mut Draft, objects: &[usize], ratio: f64) -> Result<(), Refusal> {
    let mut any = false;
    for &object in objects {
        let name = draft.name(object);
        let Some(before) = current_speed(draft, object) else { continue };
        let Some(target) = target(draft, object) else { continue };
        let scaled = |v: [f64; 3]| say::tidy3(DVec3::from_array(v) * ratio);
        let line = match target {
            Target::Velocity => {
                draft.object(object).velocity_m_s = scaled(draft.spec.objects[object].velocity_m_s);
                format!("{name} starts at {} instead of {}", say::speed(before * ratio), say::speed(before))
            }
            Target::Event(i) => {
                let event = &mut draft.spec.events[i];
                event.push_m_s = event.push_m_s.map(scaled);
                format!("{} of {name} gives {} instead of {}", event.name, say::speed(before * ratio), say::speed(before))
            }
            Target::Force(i) => {
                let force = &mut draft.spec.forces[i];
                let unit = force.strength().map_or("", |(_, unit)| unit);
                match force.constant_m_s2() {
                    Some(acceleration) => force.set_constant(scaled(acceleration)),
                    None => force.scale(ratio),
                }
                format!("{} of {name} has {} {unit} instead of {} {unit}", force.name, say::short(before * ratio), say::short(before))
            }
            Target::Spin => {
                draft.object(object).spin_rad_s = scaled(draft.spec.objects[object].spin_rad_s);
                format!("{name} spins at {} instead of {}", say::turns(before * ratio), say::turns(before))
            }
        };
        draft.gloss.push(line);
        any = true;
    }
    if any { Ok(()) } else { Err(NOTHING_MOVES.to_owned()) }
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

fn duration(scale: Scale, clause: &mut Clause, draft: &mut Draft) {
    let before = draft.duration_s();
    // "2 seconds longer"
    let by = clause.take_measure(Dimension::Time).map(|(t, _)| t).or_else(|| clause.take_for());
    let after = match by {
        Some(by) if scale.compared => before + by * scale.sign,
        Some(by) => by,
        None => before * scale.ratio,
    };
    // Whole frames.
    let fps = f64::from(draft.spec.time.fps.max(1));
    let after = say::tidy((after * fps).round().max(1.0) / fps);
    draft.spec.time.duration_s = Auto::Value(after);
    draft.gloss.push(format!("it lasts {} instead of {}", say::seconds(after), say::seconds(before)));
}

fn set_fps(draft: &mut Draft, fps: f64) -> Result<(), Refusal> {
    if !(1.0..=1000.0).contains(&fps) {
        return Err("frames a second: from 1 to 1000".to_owned());
    }
    draft.spec.time.fps = fps.round() as u32;
    draft.gloss.push(format!("{} frames a second", fps.round()));
    Ok(())
}

/// Whether a verb is light beside a material or an adjective: "turn it into jelly", "put it on the moon".
pub fn is_light(verb: Verb, clause: &Clause) -> bool {
    let says = |pick: &dyn Fn(&Sense) -> bool| clause.phrases().iter().any(|p| pick(&p.sense));
    let into = says(&|s| *s == Sense::Preposition(Preposition::Into));
    let material = says(&|s| matches!(s, Sense::Material(_) | Sense::Unbuilt(_)));
    let pose = says(&|s| matches!(s, Sense::Pose(_)));
    let property = says(&|s| matches!(s, Sense::Property(p) if *p != Property::Height));
    let place = says(&|s| matches!(s, Sense::Gravity(_) | Sense::Surface(_)));
    let directed = clause.has(|s| matches!(s, Sense::Direction(_) | Sense::Measure(..)));
    match verb {
        Verb::Turn => (material && (into || !directed)) || property || pose,
        Verb::Move => ((material || place || pose) && !directed) || property,
        Verb::Lift => property,
        _ => false,
    }
}
