//! One clause, understood: which families of verbs and adjectives read it, and in which order.

pub mod adjust;
pub mod amend;
pub mod amounts;
pub mod camera;
pub mod course;
pub mod fate;
pub mod fields;
pub mod hold;
pub mod motion;
pub mod pace;
pub mod parts;
pub mod place;
pub mod scenery;
pub mod stuff;
pub mod turns;
pub mod when;
pub mod world;

use super::clause::Clause;
use super::draft::{Draft, Refusal};
use super::numbers::Dimension;
use super::sense::{Field, Preposition, Property, Sense, Unbuilt, Verb};
use phystalk::spec::presets;

/// Understands one clause. What it changed stands in the draft; what it did not take is left in the clause.
pub fn understand(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    refuse_unbuilt(clause, draft)?;
    if clause.has(|s| *s == Sense::Condition) {
        return Err("conditions are not built yet, but for \"when it lands\": give a time, as in \"at 0.5 s\" and \"until 1 s\"".to_owned());
    }
    if turns::understand(clause, draft)? {
        return Ok(());
    }
    let stuff = |s: &Sense| if let Sense::Material(name) = s { Some(*name) } else { None };
    // "Onto the stone floor", "a wooden box" say nothing of the thing.
    if let Some(name) = clause.take_before(|s| *s == Sense::Ground, stuff) {
        draft.gloss.push(format!("that the ground is of {name} is not heeded: \"slippery\" and \"bouncier\" set its friction and its restitution"));
    }
    let firm = |s: &Sense| {
        if let Sense::Quality(Property::Stiffness | Property::Hardness | Property::Density | Property::Size, ..) = s { Some(()) } else { None }
    };
    if clause.take_before(|s| *s == Sense::Ground, firm).is_some() {
        draft
            .gloss
            .push("how hard or large the ground is is not heeded: \"slippery\" and \"bouncier\" set its friction and its restitution".to_owned());
    }
    let scenery = |s: &Sense| matches!(s, Sense::Scenery(_));
    if let Some(name) = clause.take_before(scenery, stuff) {
        draft.gloss.push(format!("that what is put there is of {name} is not heeded: it has friction and restitution only"));
    }
    refuse_places(clause, draft)?;
    refuse_negative(clause, draft)?;
    world::understand(clause, draft);
    if scenery::remove(clause, draft)? {
        return Ok(());
    }
    if scenery::is_put(clause) {
        return scenery::put(clause, draft);
    }
    if let Some(course) = clause.take(|s| if let Sense::Course(course) = s { Some(*course) } else { None }) {
        return course::lead(course, clause, draft);
    }
    if denied(clause, draft)? {
        return hold::cancel(clause, draft);
    }
    if world::turn_gravity(clause, draft) {
        return Ok(());
    }
    if parts::is_about_borders(clause) {
        return parts::correct(clause, draft).map(|_| ());
    }
    if camera::is_about_camera(clause) {
        return camera::understand(clause, draft);
    }
    let material = stuff::take_role(clause, draft)?;
    // A pose first: a drop goes by the lowest point of the turned thing.
    let pose = clause.take(|s| match s {
        Sense::Pose(pose) => Some(*pose),
        _ => None,
    });
    if let Some(pose) = pose {
        place::pose(pose, clause, draft)?;
    }
    if let Some(role) = material {
        stuff::material(role, clause, draft)?;
    }
    if let Some(proxy) = clause.take(|s| if let Sense::Proxy(proxy) = s { Some(*proxy) } else { None }) {
        stuff::proxy(proxy, clause, draft)?;
    }
    verbs(clause, draft)?;
    stuff::solve_as(clause, draft)?;
    if !place::take_rise(clause, draft)? {
        adjust::understand(clause, draft)?;
    }
    if !amend::end(clause, draft)? {
        world::time(clause, draft)?;
    }
    let corrects = draft.corrects || clause.has(|s| *s == Sense::Instead);
    let directed = amend::lacks_motion(clause);
    let amended = amend::understand(clause, draft)?;
    if corrects
        && clause.has(|s| matches!(s, Sense::View(_)))
        && draft.context.previous_spec.is_some_and(|before| before.forces != draft.context.spec.forces)
    {
        return Err("what comes from there? \"wind from the right\", \"look from the right\"".to_owned());
    }
    if clause.has(|s| matches!(s, Sense::View(_))) {
        camera::understand(clause, draft)?;
    }
    clause.take_sense(&Sense::Instead);
    if !amended && directed {
        return Err("which motion goes that way? \"push it to the left\"".to_owned());
    }
    Ok(())
}

/// Refuses what would fill a place: ice to be made of, and water to fall into, of which there is none here.
fn refuse_places(clause: &Clause, draft: &Draft) -> Result<(), Refusal> {
    let phrases = clause.phrases();
    let before = |i: usize| phrases[..i].iter().rfind(|p| !matches!(p.sense, Sense::Article | Sense::Quality(..) | Sense::Filler)).map(|p| &p.sense);
    let moved =
        phrases.iter().any(|p| matches!(p.sense, Sense::Verb(Verb::Drop | Verb::Fall | Verb::Throw | Verb::Push(_) | Verb::Pull | Verb::Lift)));
    for (i, phrase) in phrases.iter().enumerate() {
        let words = draft.words(phrase.span.clone());
        match (&phrase.sense, before(i)) {
            (Sense::Surface(_), lead) if is_stuff(&words, lead, clause) => {
                return Err(format!(
                    "{words} is a surface, not yet a material: \"on {words}\"; \"freeze it\" makes a solid of the shape that it has"
                ));
            }
            (Sense::Material(name), Some(Sense::Preposition(Preposition::Into | Preposition::In))) if moved => {
                let kind = presets::material(name).map(|p| p.material.kind());
                if kind.is_some_and(|kind| !matches!(kind, "elastic" | "rigid" | "plastic" | "muscle")) {
                    return Err(format!("there is no {words} here that it could go into; \"turn it into {words}\" makes it of {words}"));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether the name of a surface stands for what a thing is of: "make it ice", not "on ice" and not "the floor is ice".
fn is_stuff(words: &str, lead: Option<&Sense>, clause: &Clause) -> bool {
    let noun = matches!(words.to_lowercase().as_str(), "ice" | "carpet" | "sandpaper");
    let under = matches!(lead, Some(Sense::Preposition(Preposition::On | Preposition::Along | Preposition::To) | Sense::Unknown | Sense::Limit));
    matches!(lead, Some(Sense::Preposition(Preposition::Into | Preposition::Of))) || noun && !under && !clause.has(|s| *s == Sense::Ground)
}

/// Refuses lengths and amounts below zero where nothing has another way: a drop "from -1 m", "-5 kPa".
fn refuse_negative(clause: &Clause, draft: &Draft) -> Result<(), Refusal> {
    let moved = clause.phrases().iter().any(|p| matches!(p.sense, Sense::Verb(Verb::Move | Verb::Lift)));
    let below = clause.phrases().iter().find(|p| match p.sense {
        Sense::Measure(q, _) if q.value < 0.0 => match q.dimension {
            Dimension::Length => !moved,
            Dimension::Speed => false,
            _ => matches!(q.dimension, Dimension::Pressure | Dimension::Density | Dimension::Viscosity | Dimension::Tension | Dimension::Time),
        },
        Sense::At(t) | Sense::For(t) | Sense::Until(t) => t < 0.0,
        Sense::Span(from, _) => from < 0.0,
        _ => false,
    });
    match below {
        Some(phrase) => {
            let instead = match phrase.sense {
                Sense::Measure(q, _) if q.dimension == Dimension::Length => {
                    "heights and distances are said with their way, \"30 cm down\", \"1 m to the right\""
                }
                Sense::Measure(q, _) if q.dimension != Dimension::Time => "less of it is \"softer\", \"lighter\", \"20 % less\"",
                _ => "times count from the start on",
            };
            Err(format!("{} is below zero: {instead}", draft.words(phrase.span.clone())))
        }
        None => Ok(()),
    }
}

/// The verbs, in their order.
fn verbs(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    while let Some(verb) = next_verb(clause) {
        match verb {
            light if adjust::is_light(light, clause) => {}
            Verb::Fall if place::falls_by_itself(clause, draft) => {}
            Verb::Fall | Verb::Drop => place::drop(clause, draft)?,
            Verb::Topple => place::topple(clause, draft)?,
            // "A tornado that lifts it up": the swirl does.
            Verb::Lift if clause.phrases().iter().any(|p| p.sense == Sense::Verb(Verb::Field(Field::Swirl))) => {}
            Verb::Lift => place::lift(clause, draft)?,
            Verb::Move => place::shift(clause, draft)?,
            Verb::Turn | Verb::Tilt => place::turn(verb, clause, draft)?,
            Verb::Reset => place::reset(clause, draft)?,
            Verb::Pin if clause.has(|s| *s == Sense::Verb(Verb::Field(Field::Spring))) => {}
            Verb::Pin => hold::pin(clause, draft)?,
            Verb::Hang => course::hang(clause, draft)?,
            Verb::Release => hold::release(clause, draft)?,
            Verb::Rest | Verb::Stop => hold::cancel(clause, draft)?,
            // "Sway in the wind" is what wind does.
            Verb::Field(Field::Sway | Field::Shake) if clause.phrases().iter().any(|p| p.sense == Sense::Verb(Verb::Blow)) => {}
            Verb::Field(field) => fields::understand(field, clause, draft)?,
            Verb::Change(fate) => fate::understand(fate, clause, draft)?,
            _ => motion::understand(verb, clause, draft)?,
        }
    }
    Ok(())
}

/// The next verb that is not about time or the camera.
fn next_verb(clause: &mut Clause) -> Option<Verb> {
    clause.take_verb(|v| !matches!(v, Verb::Run | Verb::Look | Verb::Zoom(_) | Verb::Orbit))
}

/// Whether the clause denies something: "don't spin", "stop the wind". A denial of anything else is refused, so that
/// nobody gets the opposite of what was said.
fn denied(clause: &mut Clause, draft: &Draft) -> Result<bool, Refusal> {
    if clause.has(|s| *s == Sense::Negation) {
        let first = clause.left().find(|p| p.sense != Sense::Filler).map(|p| p.sense.clone());
        if hold::can_deny(clause) && (first == Some(Sense::Negation) || clause.left().filter(|p| matches!(p.sense, Sense::Verb(_))).count() == 1) {
            clause.take_sense(&Sense::Negation);
            return Ok(true);
        }
        let word = clause.phrases().iter().find(|p| p.sense == Sense::Negation).map(|p| draft.words(p.span.clone())).unwrap_or_default();
        return Err(format!(
            "\"{word}\" is understood before a motion only, as in \"don't spin\" and \"no wind\": say what is wanted instead, \"stiffer\", \"of jelly\", \
             or \"undo\""
        ));
    }
    let stops = clause.has(|s| matches!(s, Sense::Verb(Verb::Stop)));
    if stops {
        clause.take_verb(|v| v == Verb::Stop);
    }
    Ok(stops || clause.has(|s| matches!(s, Sense::Verb(Verb::Rest))))
}

/// Refuses by name what later versions build. A word that only describes an object that is named ("the wooden vase") is
/// said, and the rest of the clause holds.
fn refuse_unbuilt(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let unbuilt: Vec<(Unbuilt, String, bool)> = clause
        .phrases()
        .iter()
        .enumerate()
        .filter_map(|(i, phrase)| match phrase.sense {
            Sense::Unbuilt(what) => {
                let describes = is_quality(what) && matches!(clause.phrases().get(i + 1).map(|p| &p.sense), Some(Sense::Objects(_)));
                Some((what, draft.words(phrase.span.clone()), describes))
            }
            _ => None,
        })
        .collect();
    for (what, words, describes) in unbuilt {
        let reason = refusal(what, &words);
        if !describes {
            return Err(reason);
        }
        draft.gloss.push(reason);
    }
    Ok(())
}

/// Whether a word that is not built yet says what a thing is like, and not what is done.
fn is_quality(what: Unbuilt) -> bool {
    !matches!(what, Unbuilt::Filling | Unbuilt::Front | Unbuilt::Mover | Unbuilt::Pendulum)
}

/// Why something is not there yet, and what is.
pub fn refusal(what: Unbuilt, words: &str) -> Refusal {
    let names: Vec<String> =
        phystalk::spec::presets::MATERIALS.iter().filter(|p| p.material.kind() == "elastic").map(|p| p.name.to_owned()).collect();
    let elastic = format!("elastic ones are: {}", names.join(", "));
    // "Liquid" says itself what it is.
    let is = |kind: &str| if kind.ends_with(words) { String::new() } else { format!("{words} is {kind}: ") };
    match what {
        Unbuilt::Liquid => format!("{words} is not built yet; liquids are: water, honey, lava, and elastic stuff: rubber, jelly"),
        Unbuilt::Rigid => format!("{}this one is not built yet; rigid stuff is: wood, steel, stone, glass, plastic", is("rigid")),
        Unbuilt::Plastic => format!("{words} is not built yet; what keeps dents is: clay, dough"),
        Unbuilt::Viscoplastic => format!("{words} is not built yet; thick stuff is: mud, jam"),
        Unbuilt::Grains => format!("{words} is not built yet; grains are: sand, dry soil, snow"),
        Unbuilt::Gas => format!("{}gases are not built; {elastic}", is("a gas")),
        Unbuilt::Muscle => format!("{words}: things that move themselves are not built yet; jumps, pushes, throws and spins are"),
        Unbuilt::Heat => format!("{words}: heat is not built yet; {elastic}"),
        Unbuilt::Deform => format!("{words}: only pushes, pulls, fields and pins move things; \"softer\" and \"push it\" make it wobble"),
        Unbuilt::Look => format!("{words}: colours and light are not built yet; motion, material, world and camera are"),
        Unbuilt::Scene => format!("{words}: changing the size or number of things is not built yet"),
        Unbuilt::Filling => {
            format!("{words}: nothing is filled or poured on yet, and no inside is of other stuff; \"the lower half is water\" makes a part of it")
        }
        Unbuilt::Front => format!("{words}: a part changes as one; \"the top melts at 0.5 s, the lower half melts at 1 s\" is one after the other"),
        Unbuilt::Mover => {
            format!(
                "{words}: what is put around stands still and holds nothing; \"put a ball in front of it, then push it forward\" lets it run into one"
            )
        }
        Unbuilt::Pendulum => format!("{words}: \"hang it from the top and push it to the left\" swings so"),
        Unbuilt::Playback => format!("{words}: playback is not part of a simulation; \"at 200 fps\" gives more frames a second"),
    }
}
