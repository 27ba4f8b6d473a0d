//! What speaks of the newest turn as a whole: "no, the other way", "again", "more", "a bit less".

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::say;
use super::super::sense::{Field, Sense, TurnWord, Verb};
use glam::DVec3;
use phystalk::spec::{Acceleration, Auto, Event, Force, Object, Spec, Young};

const NOTHING: &str = "there is no turn before this one that it could speak of";

/// How the newest turn's change is to be continued.
#[derive(Clone, Copy)]
enum Follow {
    /// Its opposite instead.
    Opposite,
    /// The same share on top: exponent of the ratio, multiple of a difference.
    On(f64),
}

/// Reads a word about the newest turn; whether there was one.
pub fn understand(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    if clause.take_sense(&Sense::Turn(TurnWord::OtherWay)) {
        // "Reverse the wind": the one that blows, whichever turn made it.
        let lasting = |v: Verb| matches!(v, Verb::Blow | Verb::Pull | Verb::Spin | Verb::Roll | Verb::Field(_));
        if let Some(verb) = clause.take_verb(lasting) {
            return reverse(verb, clause, draft).map(|()| true);
        }
        // "push it the other way": the verb repeats what is turned round.
        clause.take_all(|s| matches!(s, Sense::Verb(_) | Sense::Negation).then_some(()));
        return follow(draft, Follow::Opposite).map(|()| true);
    }
    let alone = !clause.has(|s| matches!(s, Sense::Verb(_) | Sense::Quality(..) | Sense::Property(_) | Sense::Gravity(_) | Sense::Material(_)));
    if clause.take_sense(&Sense::Turn(TurnWord::Again)) {
        // "jump again", "again but softer": the word adds nothing to what is asked beside it.
        if !alone || draft.context.previous_spec.is_none() {
            return if alone { Err(NOTHING.to_owned()) } else { Ok(false) };
        }
        return follow(draft, Follow::On(1.0)).map(|()| true);
    }
    if !alone {
        return Ok(false);
    }
    let change = clause.take(|s| match s {
        Sense::Change(change) => Some(*change),
        _ => None,
    });
    let Some(change) = change else { return Ok(false) };
    let degrees = clause.take_all(|s| match s {
        Sense::Degree(degree) => Some(*degree),
        _ => None,
    });
    let share = degrees.iter().product::<f64>() * if change > 0.0 { 1.0 } else { -0.5 };
    follow(draft, Follow::On(share)).map(|()| true)
}

/// Turns round what there is of a wind, a pull, a field or a spin.
fn reverse(verb: Verb, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    clause.take_sense(&Sense::Negation);
    for object in draft.subjects(clause)? {
        let name = draft.name(object);
        let spin = draft.spec.objects[object].spin_rad_s;
        if matches!(verb, Verb::Spin | Verb::Roll) && spin != [0.0; 3] {
            draft.object(object).spin_rad_s = say::tidy3(-DVec3::from(spin));
            draft.gloss.push(format!("{name} spins the other way"));
            continue;
        }
        let stem = match verb {
            Verb::Blow => "wind",
            Verb::Pull => "pull",
            Verb::Field(Field::Motor) | Verb::Spin => "motor",
            Verb::Field(Field::Swirl) => "swirl",
            _ => return Err("that has no other way; \"reverse the wind\" and \"spin it the other way\" have".to_owned()),
        };
        let mut turned = Vec::new();
        for force in draft.spec.forces.iter_mut().filter(|f| f.object == name && f.name.starts_with(stem)) {
            match (force.constant_m_s2(), &mut force.wind) {
                (Some(a), _) => force.acceleration_m_s2 = Some(Acceleration::Constant(say::tidy3(-DVec3::from(a)))),
                (None, Some(wind)) => wind.velocity_m_s = say::tidy3(-DVec3::from(wind.velocity_m_s)),
                (None, None) => force.scale(-1.0),
            }
            turned.push(force.name.clone());
        }
        if turned.is_empty() {
            return Err(format!("there is no {stem} on {name} that could go the other way"));
        }
        draft.gloss.push(format!("{} of {name}: the other way", say::list(&turned)));
    }
    Ok(())
}

/// Continues, value by value, what led from the spec before the newest turn to the present one.
fn follow(draft: &mut Draft, how: Follow) -> Result<(), Refusal> {
    let before: &Spec = draft.context.previous_spec.ok_or(NOTHING)?;
    let now: &Spec = draft.context.spec;
    let mut said = Vec::new();
    for thing in &now.objects {
        let index = draft.spec.objects.iter().position(|o| o.name == thing.name);
        if let (Some(index), Some(was)) = (index, before.objects.iter().find(|o| o.name == thing.name)) {
            object(draft, index, thing, was, how, &mut said);
        }
    }
    for event in &now.events {
        let changed = before.events.iter().find(|e| e.name == event.name) != Some(event);
        if changed
            && let Some(push) = event.push_m_s
            && !(matches!(how, Follow::Opposite) && turned(push) == push)
            && let Some(event) = event_again(draft, event)
        {
            event.push_m_s = Some(match how {
                Follow::Opposite => turned(push),
                Follow::On(_) => along(DVec3::ZERO, DVec3::from_array(push), how, true),
            });
            said.push(format!("{} of {}", event.name, event.object));
        }
    }
    for force in &now.forces {
        let changed = before.forces.iter().find(|f| f.name == force.name) != Some(force);
        if changed && let Some(again) = force_again(draft, force) {
            match force.constant_m_s2() {
                Some(a) => again.set_constant(along(DVec3::ZERO, DVec3::from_array(a), how, true)),
                None => again.scale(along(DVec3::ZERO, DVec3::X, how, true)[0]),
            }
            said.push(format!("{} of {}", force.name, force.object));
        }
    }
    let (was, is) = (before.world.ground, now.world.ground);
    scalar((was.friction, is.friction), how, &mut draft.spec.world.ground.friction, |v| format!("friction {}", say::short(v)), &mut said);
    let (was, is) = (DVec3::from_array(before.world.gravity_m_s2).length(), DVec3::from_array(now.world.gravity_m_s2).length());
    let mut strength = is;
    scalar((was, is), how, &mut strength, |v| format!("gravity {}", say::acceleration(v)), &mut said);
    if strength != is {
        super::world::set_gravity(draft, strength);
    }
    if let (Auto::Value(was), Auto::Value(is)) = (before.time.duration_s, now.time.duration_s) {
        let mut duration = is;
        scalar((was, is), how, &mut duration, |v| format!("it lasts {}", say::seconds(v)), &mut said);
        draft.spec.time.duration_s = Auto::Value(duration);
    }
    if said.is_empty() {
        return Err("the newest turn changed nothing that has another way or a more and less".to_owned());
    }
    let words = match how {
        Follow::Opposite => "the other way",
        Follow::On(share) if share > 0.0 => "more of it",
        Follow::On(_) => "less of it",
    };
    draft.gloss.push(format!("{words}: {}", say::list(&said)));
    Ok(())
}

/// An event of the newest turn in the spec that is being made. Where that turn was taken back it comes again; where
/// this request removed it it is gone.
pub fn event_again<'a>(draft: &'a mut Draft, event: &Event) -> Option<&'a mut Event> {
    if draft.undone && !draft.spec.events.iter().any(|e| e.name == event.name) {
        draft.spec.events.push(event.clone());
    }
    draft.spec.events.iter_mut().find(|e| e.name == event.name)
}

/// The same of a force.
pub fn force_again<'a>(draft: &'a mut Draft, force: &Force) -> Option<&'a mut Force> {
    if draft.undone && !draft.spec.forces.iter().any(|f| f.name == force.name) {
        draft.spec.forces.push(force.clone());
    }
    draft.spec.forces.iter_mut().find(|f| f.name == force.name)
}

fn object(draft: &mut Draft, index: usize, now: &Object, was: &Object, how: Follow, said: &mut Vec<String>) {
    let name = now.name.clone();
    let mut vector = |was: [f64; 3], is: [f64; 3], rate: bool, what: &str| -> [f64; 3] {
        if was == is {
            return is;
        }
        let after = match along(DVec3::from_array(was), DVec3::from_array(is), how, rate) {
            // Nobody jumps or throws into the ground.
            after if what == "velocity" && matches!(how, Follow::Opposite) && is[2] > 0.0 => [after[0], after[1], is[2]],
            after => after,
        };
        said.push(format!("{what} of {name} ({}, {}, {})", say::short(after[0]), say::short(after[1]), say::short(after[2])));
        after
    };
    let velocity = if matches!(how, Follow::Opposite) && turned(now.velocity_m_s) == now.velocity_m_s {
        now.velocity_m_s
    } else {
        vector(was.velocity_m_s, now.velocity_m_s, true, "velocity")
    };
    let spin = vector(was.spin_rad_s, now.spin_rad_s, true, "spin");
    let offset = vector(was.offset_m, now.offset_m, false, "offset");
    let rotate = vector(was.rotate_deg, now.rotate_deg, false, "rotation");
    let thing = draft.object(index);
    (thing.velocity_m_s, thing.spin_rad_s, thing.offset_m, thing.rotate_deg) = (velocity, spin, offset, rotate);
    let path = format!("object.{name}.material.young_pa");
    if let (Some(young_was), Some(young_is)) = (was.material.young_pa(), now.material.young_pa())
        && let Some(is) = young_is.given_pa()
    {
        let was = young_was.given_pa().or_else(|| draft.resolved(&path)).unwrap_or(is);
        let mut young = is;
        scalar((was, is), how, &mut young, |v| format!("Young's modulus of {name} {}", say::pressure(v)), said);
        if let Some(target) = draft.material(index).young_pa_mut() {
            *target = if let Young::AtLeast(_) = young_is { Young::AtLeast(young) } else { Young::Value(young) };
        }
    }
    let (was, is) = (was.material.density_kg_m3(), now.material.density_kg_m3());
    if let Some(density) = draft.material(index).density_mut() {
        scalar((was, is), how, density, |v| format!("density of {name} {} kg/m³", say::short(v)), said);
    }
}

/// The other way of a velocity: what goes up does so still.
fn turned(velocity: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = velocity;
    say::tidy3(DVec3::new(-x, -y, if z > 0.0 { z } else { -z }))
}

/// A vector that went from `was` to `is`. Of a rate the changed part is turned round or grown by half for each share;
/// of a place the step is taken the other way or once more.
fn along(was: DVec3, is: DVec3, how: Follow, rate: bool) -> [f64; 3] {
    let step = is - was;
    let unit = step.try_normalize().unwrap_or(DVec3::ZERO);
    let part = is.dot(unit) * unit;
    let after = match (how, rate) {
        (Follow::Opposite, true) => is - 2.0 * part,
        (Follow::Opposite, false) => was - step,
        (Follow::On(share), true) => is + part * (1.5f64.powf(share) - 1.0),
        (Follow::On(share), false) => is + step * share,
    };
    say::tidy3(after)
}

/// A positive number that went from `was` to `is`, by its ratio.
fn scalar((was, is): (f64, f64), how: Follow, target: &mut f64, say: impl Fn(f64) -> String, said: &mut Vec<String>) {
    if was == is || was <= 0.0 || is <= 0.0 {
        return;
    }
    *target = say::tidy(match how {
        Follow::Opposite => was * was / is,
        Follow::On(share) => is * (is / was).powf(share),
    });
    said.push(say(*target));
}
