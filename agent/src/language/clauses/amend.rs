//! A direction, a side, a time or a speed alone, right after a turn that had another: "no, to the right", "at 1 s instead",
//! "at 3 m/s", "no, from the right", "no, until 2 s". What the newest turn made gets it and keeps the rest.

use super::super::clause::Clause;
use super::super::directions::Heading;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::Sense;
use super::motion::take_side;
use super::turns::{event_again, force_again};
use super::when::When;
use glam::DVec3;
use phystalk::spec::{Acceleration, Event, Force, Spec, Until};

/// Whether the clause was such a correction.
pub fn understand(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let Some(before) = draft.context.previous_spec else { return Ok(false) };
    let other = draft.corrects || clause.has(|s| *s == Sense::Instead);
    let heads = clause.has(|s| match s {
        Sense::Direction(_) => true,
        Sense::View(_) => other,
        Sense::Measure(quantity, _) => matches!(quantity.dimension, Dimension::Speed | Dimension::Acceleration),
        _ => false,
    });
    if clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(_))) {
        return Ok(false);
    }
    if heads {
        let pushed = pushes(clause, draft, before)?;
        return if pushed { Ok(true) } else { forces(clause, draft, before) };
    }
    if clause.has(|s| matches!(s, Sense::At(_))) { times(clause, draft, before) } else { Ok(false) }
}

/// "No, until 2 s", "no, for 2 s": until when lasts what the newest turn made. Whether it was so.
pub fn end(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let Some(before) = draft.context.previous_spec.filter(|_| draft.corrects && !draft.undone) else { return Ok(false) };
    let lasts = |s: &Sense| matches!(s, Sense::Until(_) | Sense::For(_));
    if clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(_))) || !clause.has(lasts) {
        return Ok(false);
    }
    let ends = |to_s: Until| matches!(to_s, Until::Time(_));
    let forces = draft.spec.forces.iter_mut().filter(|f| ends(f.to_s) && newer(&before.forces, *f)).map(|f| (f.from_s, &mut f.to_s, f.name.clone()));
    let pins = draft.spec.pins.iter_mut().filter(|p| ends(p.to_s) && newer(&before.pins, *p)).map(|p| (p.from_s, &mut p.to_s, p.name.clone()));
    let mut ending: Vec<(f64, &mut Until, String)> = forces.chain(pins).collect();
    let [(from_s, to_s, name)] = &mut ending[..] else { return Ok(false) };
    let end_s = clause.take_until().or_else(|| clause.take_for().map(|f| *from_s + f)).map(say::tidy).unwrap_or_default();
    if end_s <= *from_s {
        return Err("that ends before it begins".to_owned());
    }
    **to_s = Until::Time(end_s);
    let line = format!("{name} lasts until {}", say::seconds(end_s));
    draft.gloss.push(line);
    Ok(true)
}

/// Whether the newest turn made an entry, or changed it.
fn newer<T: PartialEq>(before: &[T], entry: &T) -> bool {
    !before.contains(entry)
}

/// Where the clause wants something to go: a direction, or away from a side.
fn take_heading(clause: &mut Clause, draft: &Draft, object: usize) -> Result<Option<Heading>, Refusal> {
    let mut directions = clause.take_directions();
    directions.extend(take_side(clause));
    if directions.is_empty() { Ok(None) } else { Ok(Some(draft.frame(object).heading(&directions).ok_or("those directions cancel out")?)) }
}

/// Another way, speed or time of the newest push, or of the velocity at the start.
fn pushes(clause: &mut Clause, draft: &mut Draft, before: &Spec) -> Result<bool, Refusal> {
    let now = draft.context.spec;
    for (index, thing) in now.objects.iter().enumerate() {
        let event = now.events.iter().find(|e| e.object == thing.name && e.push_m_s.is_some() && newer(&before.events, *e));
        let was = before.objects.iter().find(|o| o.name == thing.name).map_or(DVec3::ZERO, |o| DVec3::from_array(o.velocity_m_s));
        let velocity = DVec3::from_array(thing.velocity_m_s);
        let changed = (velocity - was).try_normalize().unwrap_or(DVec3::ZERO);
        let old = match event {
            Some(event) => DVec3::from_array(event.push_m_s.unwrap_or_default()),
            None => velocity.dot(changed) * changed,
        };
        if old == DVec3::ZERO || event.is_some_and(|e| !draft.undone && !draft.spec.events.iter().any(|d| d.name == e.name)) {
            continue;
        }
        let heading = take_heading(clause, draft, index)?;
        let speed = clause.take_measure(Dimension::Speed).map_or(old.length(), |(v, _)| v);
        let unit = heading.as_ref().map_or(old.normalize(), |h| h.unit);
        // A jump to the left is a jump still.
        let rises = old.z > 0.9 * old.length() && unit.z.abs() < 0.1;
        let new = if rises { old + 0.5 * old.length() * unit } else { unit * speed };
        let way = heading.map_or(String::new(), |h| format!(" {}", h.said));
        let line = match event {
            Some(event) => {
                let Some(event) = event_again(draft, event) else { continue };
                event.push_m_s = Some(say::tidy3(new));
                if let Some(at_s) = clause.take_at() {
                    (event.at_s, event.when) = (Some(say::tidy(at_s)), None);
                }
                let at = event.at_s.map_or(String::new(), |at_s| format!(" at {}", say::seconds(at_s)));
                format!("{} of {} goes{way}{at}: {} more", event.name, thing.name, say::speed(new.length()))
            }
            None => {
                draft.object(index).velocity_m_s = say::tidy3(velocity - old + new);
                format!("{} goes{way}: {} at the start", thing.name, say::speed(new.length()))
            }
        };
        clause.take_sense(&Sense::Instead);
        draft.gloss.push(line);
        return Ok(true);
    }
    Ok(false)
}

/// Another way or strength of the wind or the pull that the newest turn made, where it made one.
fn forces(clause: &mut Clause, draft: &mut Draft, before: &Spec) -> Result<bool, Refusal> {
    let now = draft.context.spec;
    let directed = |f: &&Force| newer(&before.forces, *f) && (f.wind.is_some() || f.constant_m_s2().is_some());
    let made: Vec<&Force> = now.forces.iter().filter(directed).collect();
    let [force] = made[..] else { return Ok(false) };
    let Some(index) = now.objects.iter().position(|o| o.name == force.object) else { return Ok(false) };
    let heading = take_heading(clause, draft, index)?;
    let wind = force.wind.as_ref().map(|w| DVec3::from(w.velocity_m_s));
    let old = wind.or_else(|| force.constant_m_s2().map(DVec3::from)).unwrap_or(DVec3::ZERO);
    let dimension = if wind.is_some() { Dimension::Speed } else { Dimension::Acceleration };
    let amount = clause.take_measure(dimension).map_or(old.length(), |(v, _)| v);
    let new = say::tidy3(heading.as_ref().map_or(old.normalize_or_zero(), |h| h.unit) * amount);
    let Some(again) = force_again(draft, force) else { return Ok(false) };
    match &mut again.wind {
        Some(wind) => wind.velocity_m_s = new,
        None => again.acceleration_m_s2 = Some(Acceleration::Constant(new)),
    }
    clause.take_sense(&Sense::Instead);
    let way = heading.map_or(String::new(), |h| format!(" {}", h.said));
    let amount = if wind.is_some() { say::speed(amount) } else { say::acceleration(amount) };
    draft.gloss.push(format!("{} on {} goes{way}: {amount}", force.name, force.object));
    Ok(true)
}

/// Another time of what the newest turn made: an event, a force, the end of a hold; a velocity at the start becomes a push.
fn times(clause: &mut Clause, draft: &mut Draft, before: &Spec) -> Result<bool, Refusal> {
    let now = draft.context.spec;
    let events: Vec<&Event> = now.events.iter().filter(|e| newer(&before.events, *e)).collect();
    let forces: Vec<&Force> = now.forces.iter().filter(|f| newer(&before.forces, *f)).collect();
    let let_go = |name: &str| before.pins.iter().any(|p| p.name == name);
    let pins: Vec<&str> = now.pins.iter().filter(|p| newer(&before.pins, *p) && let_go(&p.name)).map(|p| p.name.as_str()).collect();
    let names = || events.iter().map(|e| &e.name).chain(forces.iter().map(|f| &f.name)).map(String::as_str).chain(pins.iter().copied());
    if names().count() > 1 {
        let names: Vec<String> = names().map(str::to_owned).collect();
        return Err(format!("which of them? the turn before made {}: say it whole, \"push it left at 2 s\"", say::list(&names)));
    }
    let Some(at_s) = clause.left().find_map(|p| if let Sense::At(at_s) = p.sense { Some(say::tidy(at_s)) } else { None }) else { return Ok(false) };
    let line = if let [event] = events[..] {
        let Some(event) = event_again(draft, event) else { return Ok(false) };
        (event.at_s, event.when) = (Some(at_s), None);
        format!("{} of {} comes at {}", event.name, event.object, say::seconds(at_s))
    } else if let [force] = forces[..] {
        let Some(force) = force_again(draft, force) else { return Ok(false) };
        if let Until::Time(to_s) = &mut force.to_s {
            *to_s = say::tidy(*to_s + at_s - force.from_s);
        }
        force.from_s = at_s;
        format!("{} on {} begins at {}", force.name, force.object, say::seconds(at_s))
    } else if let [name] = pins[..] {
        let Some(pin) = draft.spec.pins.iter_mut().find(|p| p.name == name && p.from_s < at_s) else { return Ok(false) };
        pin.to_s = Until::Time(at_s);
        format!("{name} of {} is let go at {}", pin.object, say::seconds(at_s))
    } else {
        let put_off = later(clause, draft, before, at_s)?;
        if !put_off && draft.corrects {
            return Err("the turn before made nothing that has a time: \"push it left at 2 s\", \"melt at 2 s\"".to_owned());
        }
        return Ok(put_off);
    };
    clause.take_at();
    clause.take_sense(&Sense::Instead);
    draft.gloss.push(line);
    Ok(true)
}

/// "Jump", "no, at 1 s": the velocity that the newest turn gave comes as a push then.
fn later(clause: &mut Clause, draft: &mut Draft, before: &Spec, at_s: f64) -> Result<bool, Refusal> {
    if draft.undone || !(draft.corrects || clause.has(|s| *s == Sense::Instead)) {
        return Ok(false);
    }
    let now = draft.context.spec;
    let mut any = false;
    for (index, thing) in now.objects.iter().enumerate() {
        let was = before.objects.iter().find(|o| o.name == thing.name).map_or(DVec3::ZERO, |o| DVec3::from_array(o.velocity_m_s));
        let given = DVec3::from_array(thing.velocity_m_s) - was;
        if given == DVec3::ZERO {
            continue;
        }
        draft.object(index).velocity_m_s = say::tidy3(was);
        let stem = if given.z > 0.5 * given.length() { "jump" } else { "push" };
        draft.push_at(index, When::At(at_s), given, stem);
        draft.gloss.push(format!("{} gets its {} at {}", thing.name, say::speed(given.length()), say::seconds(at_s)));
        any = true;
    }
    if any {
        clause.take_at();
        clause.take_sense(&Sense::Instead);
    }
    Ok(any)
}

/// Whether a clause says where to and not what goes there.
pub fn lacks_motion(clause: &Clause) -> bool {
    clause.has(|s| matches!(s, Sense::Direction(_))) && !clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(_)))
}
