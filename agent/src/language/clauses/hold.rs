//! Holding and letting go, stopping and taking back: pins, "no spin", "stop it at 1 s".

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Part, Pose, Sense, Verb};
use super::parts::{self, Portion};
use super::when::When;
use phystalk::spec::{Event, Force, Pin, Region, Until};

/// "hold the base", "pin the top from 0.2 s to 1 s".
pub fn pin(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let named = parts::take_all(clause);
    clause.take_sense(&Sense::Ground);
    clause.take_directions();
    let span = clause.take(|s| match s {
        Sense::Span(from, to) => Some((*from, *to)),
        _ => None,
    });
    let from_s = span.map(|s| s.0).or_else(|| clause.take_at()).unwrap_or(0.0);
    let until = span.map(|s| s.1).or_else(|| clause.take_until()).or_else(|| clause.take_for().map(|f| from_s + f));
    let to_s = until.map_or(Until::End, |to| Until::Time(say::tidy(to)));
    for (&object, part) in objects.iter().flat_map(|object| named.iter().map(move |part| (object, *part))) {
        let whole = Portion { stem: "hold", region: Region::Above(0.0), said: "all", chosen: None };
        let Portion { stem, region, said, chosen } = part.map_or(whole, |part| parts::portion(draft, object, part));
        let object = draft.name(object);
        let chosen = chosen.map_or(String::new(), |chosen| format!(" ({chosen})"));
        let same = draft.spec.pins.iter_mut().find(|p| p.object == object && p.region == region);
        match same {
            Some(pin) => (pin.from_s, pin.to_s) = (from_s, to_s),
            None => {
                let name = draft.plain_name(stem, |spec, name| spec.pins.iter().any(|p| p.name == name));
                draft.spec.pins.push(Pin { name, object: object.clone(), region, from_s, to_s, path: Vec::new() });
            }
        }
        let until = until.map_or("to the end".to_owned(), |to| format!("to {}", say::seconds(to)));
        draft.gloss.push(format!("{said} of {object}{chosen} is held from {} {until}", say::seconds(from_s)));
    }
    Ok(())
}

/// "let go at 1 s", "let go".
pub fn release(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let part = parts::take(clause);
    let when = When::take(clause, draft, objects[0])?;
    for &object in &objects {
        let name = draft.name(object);
        if let Some(part) = part {
            release_part(part, when, draft, object)?;
            continue;
        }
        let frozen = draft.spec.events.iter().any(|e| super::stuff::freezes(e, &name));
        if !frozen && !draft.spec.pins.iter().any(|p| p.object == name) {
            return Err(format!("nothing holds {name}: \"hold the base\" does"));
        }
        match when {
            When::At(at) if !frozen => {
                for pin in draft.spec.pins.iter_mut().filter(|p| p.object == name && p.from_s < at) {
                    pin.to_s = Until::Time(at);
                }
            }
            When::At(_) | When::Impact => draft.happen(object, None, when, "release", |event| event.release = true, |event| event.release),
            // "Hold it for half a second, then let go": it is let go then.
            When::Start if held_for_a_while(draft, &name) => continue,
            When::Start => {
                draft.spec.pins.retain(|p| p.object != name);
                draft.spec.events.retain(|e| !(e.object == name && (e.freeze || e.release)));
                draft.gloss.push(format!("nothing holds {name} any more"));
                continue;
            }
        }
        draft.gloss.push(format!("{name} is let go{}", when.said()));
    }
    Ok(())
}

/// Whether all that holds an object began in this request, and ends at a time.
fn held_for_a_while(draft: &Draft, name: &str) -> bool {
    let mut pins = draft.spec.pins.iter().filter(|p| p.object == name).peekable();
    pins.peek().is_some() && pins.all(|p| p.to_s != Until::End && !draft.context.spec.pins.contains(p))
}

/// "let go of the top at 1 s": what holds that part, and nothing else.
fn release_part(part: Part, when: When, draft: &mut Draft, object: usize) -> Result<(), Refusal> {
    let name = draft.name(object);
    let Portion { region, said, .. } = parts::portion(draft, object, part);
    let others = draft.spec.pins.iter().any(|p| p.object == name && p.region != region);
    let Some(at) = draft.spec.pins.iter().position(|p| p.object == name && p.region == region) else {
        return Err(format!("nothing holds {said} of {name}"));
    };
    match when {
        When::At(at_s) => draft.spec.pins[at].to_s = Until::Time(at_s),
        When::Start => {
            draft.spec.pins.remove(at);
        }
        When::Impact if others => return Err(format!("an impact lets go of all that holds {name}; one hold ends at a time, \"at 1 s\"")),
        When::Impact => draft.happen(object, None, when, "release", |event| event.release = true, |event| event.release),
    }
    draft.gloss.push(format!("{said} of {name} is let go{}", when.said()));
    Ok(())
}

/// "stop spinning", "no jump", "don't push it", "remove the wind", "stop it at 1 s", "stand still". The word that
/// denies is taken already.
pub fn cancel(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let verb = clause.take_verb(|v| !matches!(v, Verb::Stop));
    if matches!(verb, Some(Verb::Orbit | Verb::Look | Verb::Zoom(_))) || clause.has(|s| *s == Sense::Camera) {
        clause.take_sense(&Sense::Camera);
        let mut camera = draft.camera();
        camera.orbit_deg_s = 0.0;
        draft.spec.camera = phystalk::spec::Auto::Value(camera);
        draft.gloss.push("the camera stands still".to_owned());
        return Ok(());
    }
    let nothing = verb.is_none()
        && clause.phrases().iter().any(|p| {
            matches!(p.sense, Sense::Property(_) | Sense::Camera | Sense::Quality(..) | Sense::Gravity(_) | Sense::Surface(_) | Sense::Unknown)
                || p.sense == Sense::Verb(Verb::Stop)
                    && !draft.words(p.span.clone()).to_lowercase().starts_with("stop")
                    && draft.words(p.span.clone()) != "halt"
        });
    if nothing {
        return Err(
            "what is to end is a motion, a wind or a hold, \"stop the wind\", \"no spin\"; things stay, and \"undo\" takes a turn back".to_owned()
        );
    }
    let objects = draft.subjects(clause)?;
    clause.take_directions();
    let at_s = clause.take_at().map(say::tidy);
    for &object in &objects {
        let name = draft.name(object);
        if let (Some(at_s), Some(verb)) = (at_s, verb) {
            end(verb, at_s, draft, &name)?;
            continue;
        }
        let said = match verb {
            Some(Verb::Jump | Verb::Throw | Verb::Somersault) => {
                draft.object(object).velocity_m_s[2] = 0.0;
                draft.spec.events.retain(|e| e.object != name || !(e.name.starts_with("jump") || e.name.starts_with("throw")));
                "does not jump"
            }
            Some(Verb::Push(_) | Verb::Move) => {
                let up = draft.spec.objects[object].velocity_m_s[2];
                draft.object(object).velocity_m_s = [0.0, 0.0, up];
                draft.spec.events.retain(|e| e.object != name || !e.name.starts_with("push"));
                "is not pushed"
            }
            Some(Verb::Pull | Verb::Blow) => {
                draft.spec.forces.retain(|f| f.object != name || !f.name.starts_with(stem(verb.unwrap_or(Verb::Pull))));
                if verb == Some(Verb::Blow) { "has no wind" } else { "is pulled by nothing" }
            }
            Some(Verb::Field(field)) => {
                draft.spec.forces.retain(|f| f.object != name || !f.name.starts_with(stem(Verb::Field(field))));
                "is free of that"
            }
            Some(Verb::Spin | Verb::Roll) => {
                draft.object(object).spin_rad_s = [0.0; 3];
                "does not spin"
            }
            Some(Verb::Turn | Verb::Tilt | Verb::Topple) => {
                draft.object(object).rotate_deg = [0.0; 3];
                "is not turned"
            }
            Some(Verb::Fall | Verb::Drop | Verb::Lift) => {
                draft.set_gap_m(object, 0.0);
                "starts on what is below it"
            }
            Some(Verb::Pin | Verb::Hang) => {
                draft.spec.pins.retain(|p| p.object != name);
                "is held by nothing"
            }
            None if at_s.is_some() => {
                let at_s = at_s.unwrap_or_default();
                let event = draft.free_name("stop", |spec, name| spec.events.iter().any(|e| e.name == name));
                draft.spec.events.push(Event { velocity_m_s: Some([0.0; 3]), ..Event::at(&event, &name, at_s) });
                "is stopped"
            }
            None | Some(Verb::Rest) => {
                rest(draft, object);
                "stands still"
            }
            Some(Verb::Change(fate)) => {
                let part = parts::take(clause).map(|part| parts::portion(draft, object, part).stem);
                let brings = |e: &Event| e.object == name && part.is_none_or(|part| e.part.as_deref() == Some(part)) && super::fate::is_of(fate, e);
                if !draft.spec.events.iter().any(brings) {
                    return Err(format!("no event does that to {name}; \"undo\" takes back what is so from the start"));
                }
                draft.spec.events.retain(|e| !brings(e));
                "keeps its stuff"
            }
            Some(_) => return Err("that cannot be stopped; \"undo that\" takes the newest turn back".to_owned()),
        };
        let at = at_s.map_or(String::new(), |at| format!(" at {}", say::seconds(at)));
        draft.gloss.push(format!("{name} {said}{at}"));
    }
    Ok(())
}

/// What the forces are called that a verb makes; a pull is any.
fn stem(verb: Verb) -> &'static str {
    match verb {
        Verb::Blow => "wind",
        Verb::Field(field) => super::fields::stem(field),
        _ => "",
    }
}

/// "stop the wind at 1 s": what lasts ends then. Of what is over at once there is nothing to end.
fn end(verb: Verb, at_s: f64, draft: &mut Draft, name: &str) -> Result<(), Refusal> {
    match verb {
        Verb::Pull | Verb::Blow | Verb::Field(_) => {
            let lasts = |f: &&mut Force| f.object == name && f.name.starts_with(stem(verb)) && f.from_s < at_s;
            let mut ended = Vec::new();
            for force in draft.spec.forces.iter_mut().filter(lasts) {
                force.to_s = Until::Time(at_s);
                ended.push(force.name.clone());
            }
            if ended.is_empty() {
                return Err(format!("nothing like that acts on {name} before {}", say::seconds(at_s)));
            }
            draft.gloss.push(format!("{} of {name} ends at {}", say::list(&ended), say::seconds(at_s)));
        }
        Verb::Pin => {
            for pin in draft.spec.pins.iter_mut().filter(|p| p.object == name && p.from_s < at_s) {
                pin.to_s = Until::Time(at_s);
            }
            draft.gloss.push(format!("{name} is let go at {}", say::seconds(at_s)));
        }
        Verb::Rest | Verb::Push(_) | Verb::Move | Verb::Fall => {
            let event = draft.free_name("stop", |spec, name| spec.events.iter().any(|e| e.name == name));
            draft.spec.events.push(Event { velocity_m_s: Some([0.0; 3]), ..Event::at(&event, name, at_s) });
            draft.gloss.push(format!("{name} is stopped at {}", say::seconds(at_s)));
        }
        _ => {
            return Err(
                "at a time winds, pulls, fields and holds end, and \"stop it at 1 s\" takes its speed; that one cannot be ended alone".to_owned()
            );
        }
    }
    Ok(())
}

/// No speed, no spin, no pushes, no pulls.
fn rest(draft: &mut Draft, object: usize) {
    let name = draft.name(object);
    let thing = draft.object(object);
    (thing.velocity_m_s, thing.spin_rad_s) = ([0.0; 3], [0.0; 3]);
    draft.spec.events.retain(|e| e.object != name);
    draft.spec.forces.retain(|f| f.object != name);
}

/// Whether a denial in this clause has something that it can deny: "don't spin", "no wind".
pub fn can_deny(clause: &Clause) -> bool {
    let mut senses = clause.left().map(|p| &p.sense).filter(|s| **s != Sense::Filler);
    let after = senses.by_ref().skip_while(|s| **s != Sense::Negation).nth(1);
    matches!(after, Some(Sense::Verb(_)))
        && !clause.has(|s| matches!(s, Sense::Quality(..) | Sense::Strength(_) | Sense::Degree(_) | Sense::Pose(Pose::UpsideDown)))
        && !clause.has(|s| matches!(s, Sense::Measure(q, _) if q.dimension != Dimension::Time))
}
