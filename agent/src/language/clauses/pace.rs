//! How fast, how high, how long: what "faster", "higher" and "longer" speak of.

use super::super::clause::{Clause, Scale};
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use glam::DVec3;
use phystalk::spec::Auto;

/// Why nothing can be faster.
pub const NOTHING_MOVES: &str = "nothing moves yet that could be faster or slower: \"push it forward\", \"make it jump\"";

pub fn height(scale: Scale, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
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

pub fn set_jump(draft: &mut Draft, object: usize, before_m: f64, after_m: f64) {
    let up = (2.0 * draft.gravity_for_heights_m_s2() * after_m).sqrt();
    draft.set_speed_along(object, DVec3::Z, up);
    let from = if before_m > 0.0 { format!(" instead of {}", say::metres(before_m)) } else { String::new() };
    let line = format!("{} jumps {}{from}: {} up", draft.name(object), say::metres(after_m), say::speed(up));
    draft.gloss.push(line);
}

/// Whether the newest turn was about a push: then "harder" speaks of it, and not of the material.
pub fn pushed_last(draft: &Draft) -> bool {
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
pub fn current_speed(draft: &Draft, object: usize) -> Option<f64> {
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

pub fn duration(scale: Scale, clause: &mut Clause, draft: &mut Draft) {
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

pub fn set_fps(draft: &mut Draft, fps: f64) -> Result<(), Refusal> {
    if !(1.0..=1000.0).contains(&fps) {
        return Err("frames a second: from 1 to 1000".to_owned());
    }
    draft.spec.time.fps = fps.round() as u32;
    draft.gloss.push(format!("{} frames a second", fps.round()));
    Ok(())
}
