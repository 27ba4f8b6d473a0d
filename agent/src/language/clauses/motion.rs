//! Verbs that give a speed: jump, push, throw, spin, roll, pull, blow.
//!
//! A verb sets the part of the initial velocity that it speaks of and leaves the rest, so that nothing piles up and
//! "make it jump and push it left" does both. With a time it becomes an event. Amounts that are not given follow the
//! object's size by Froude's rule (speed ~ sqrt(length)), so that small things do not shoot out of the picture.

use super::super::clause::{Clause, HARD, Scale, qualifies};
use super::super::directions::from_side;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Direction, Property, Sense, Verb};
use super::when::When;
use glam::DVec3;
use phystalk::spec::{ColliderShape, Force, Until};
use std::f64::consts::TAU;

/// Height of a jump that nobody gave, in heights of the object.
pub const JUMP_HEIGHTS: f64 = 0.4;
/// Speed of a push that nobody gave, for an object of one metre: it slides 0.8 m at the default friction of 0.15.
pub const PUSH_M_S: f64 = 1.5;
/// Speed of a throw that nobody gave, for an object of one metre: 45 degrees up, it flies 0.8 m.
pub const THROW_M_S: f64 = 2.8;
/// A spin that nobody gave: one turn a second.
const SPIN_RAD_S: f64 = TAU;
/// A pull that nobody gave: it moves the object from rest at the default friction, slowly enough to be watched.
pub const PULL_M_S2: f64 = 3.0;

/// Reads one verb of motion with all that belongs to it.
pub fn understand(verb: Verb, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    // "The wind blows" says it twice.
    while verb == Verb::Blow && clause.take_verb(|v| v == Verb::Blow).is_some() {}
    let objects = draft.subjects(clause)?;
    let when = When::take(clause, draft, objects[0])?;
    match verb {
        Verb::Jump => return jump(clause, draft, &objects, when),
        Verb::Throw => return throw(clause, draft, &objects, when),
        Verb::Push(strength) if !lasting(clause) => return push(strength, clause, draft, &objects, when),
        _ => {}
    }
    let at_s = when.time_s(draft, objects[0])?;
    match verb {
        Verb::Somersault => somersault(clause, draft, &objects, at_s),
        Verb::Spin | Verb::Roll => spin(verb, clause, draft, &objects, at_s),
        Verb::Blow if !clause.has(is_acceleration) => super::fields::wind(clause, draft, &objects, at_s),
        Verb::Push(_) => pull(Verb::Pull, clause, draft, &objects, at_s),
        _ => pull(verb, clause, draft, &objects, at_s),
    }
}

/// Whether a push goes on for a while, or is told by its acceleration.
fn lasting(clause: &Clause) -> bool {
    clause.has(|s| matches!(s, Sense::For(_) | Sense::Span(..) | Sense::Until(_)) || is_acceleration(s))
}

/// How strong a verb is to be: adverbs and adjectives together, 1 where there are none.
pub fn strength(verb: Verb, clause: &mut Clause, draft: &mut Draft) -> Result<(f64, Option<Scale>), Refusal> {
    let scale = clause.take_scale(qualifies(verb)).or_else(|| clause.take_more(verb));
    if let Some(scale) = scale.filter(|s| s.compared) {
        draft.compare(scale.property, scale.ratio > 1.0, clause)?;
    }
    let adverbs = clause.take_vigour();
    let hard = match scale {
        // "hard" is an adverb here, not a material; "very hard" is hard twice over.
        Some(scale) if scale.property == Property::Hardness && !scale.compared => HARD.powf(scale.ratio.log2()),
        Some(scale) => scale.ratio,
        None => 1.0,
    };
    Ok((adverbs * hard, scale))
}

fn jump(clause: &mut Clause, draft: &mut Draft, objects: &[usize], when: When) -> Result<(), Refusal> {
    let height = clause.take_measure_or_plain(Dimension::Length).map(|(h, _)| h);
    let heights = clause.take_heights();
    let speed = clause.take_measure(Dimension::Speed).map(|(v, _)| v);
    clause.take(|s| (*s == Sense::Factor(1.0)).then_some(()));
    let mut directions = clause.take_directions();
    directions.retain(|d| !matches!(d, Direction::Up | Direction::Axis(2, true)));
    if directions.contains(&Direction::Down) {
        return Err("a jump goes up; \"drop it from 1 m\" goes down".to_owned());
    }
    let (strength, scale) = strength(Verb::Jump, clause, draft)?;
    let gravity = draft.gravity_for_heights_m_s2();
    for &object in objects {
        let rising = draft.spec.objects[object].velocity_m_s[2].max(0.0);
        let usual = JUMP_HEIGHTS * draft.facts(object).height_m();
        // "higher" starts from the jump that is there.
        let from = if scale.is_some_and(|s| s.compared) && rising > 0.0 && when == When::Start { rising * rising / (2.0 * gravity) } else { usual };
        let rise = match (height.or(heights.map(|n| n * draft.facts(object).height_m())), speed) {
            (Some(height), _) => height.abs(),
            (None, Some(speed)) => speed * speed / (2.0 * gravity),
            (None, None) => from * strength,
        };
        let up = (2.0 * gravity * rise).sqrt();
        let aside = draft.frame(object).heading(&directions).map(|h| (h.unit.with_z(0.0).normalize_or_zero(), h.said));
        let name = draft.name(object);
        let under = if (gravity - 9.81).abs() < 1e-6 { String::new() } else { format!(" under {}", say::acceleration(gravity)) };
        let also = aside.as_ref().map(|(_, said)| format!(", {said} at {}", say::speed(up / 2.0))).unwrap_or_default();
        match when {
            When::At(_) | When::Impact => {
                let velocity = up * DVec3::Z + aside.map_or(DVec3::ZERO, |(unit, _)| unit * up / 2.0);
                draft.push_at(object, when, velocity, "jump");
                let (said, up, rise) = (when.said(), say::speed(up), say::metres(rise));
                draft.gloss.push(format!("{name} jumps{said}: {up} up, enough for {rise}{under}{also}"));
            }
            When::Start => {
                draft.set_speed_along(object, DVec3::Z, up);
                if let Some((unit, _)) = aside {
                    draft.set_speed_along(object, unit, up / 2.0);
                }
                let high = draft.gap_m(object);
                let from = if high > 1e-3 {
                    format!(" (it starts {} up: \"put it back\" stands it on the ground)", say::metres(high))
                } else {
                    String::new()
                };
                draft.gloss.push(format!("{name} jumps: {} up, enough for {}{under}{also}{from}", say::speed(up), say::metres(rise)));
            }
        }
    }
    draft.aloft = true;
    Ok(())
}

/// A jump with one turn about a level axis until it lands.
fn somersault(clause: &mut Clause, draft: &mut Draft, objects: &[usize], at_s: Option<f64>) -> Result<(), Refusal> {
    if at_s.is_some() {
        return Err(LATER_SPIN.to_owned());
    }
    let backward = clause.take_directions().contains(&Direction::Backward);
    jump(clause, draft, objects, When::Start)?;
    let gravity = draft.gravity_for_heights_m_s2();
    for &object in objects {
        let flight_s = 2.0 * draft.spec.objects[object].velocity_m_s[2] / gravity;
        let rate = TAU / flight_s.max(0.1) * if backward { -1.0 } else { 1.0 };
        let axis = DVec3::Z.cross(draft.frame(object).forward());
        draft.object(object).spin_rad_s = say::tidy3(axis * rate);
        let line = format!("{} turns over once on the way: {}", draft.name(object), say::turns(rate));
        draft.gloss.push(line);
    }
    Ok(())
}

fn push(strength_of_word: f64, clause: &mut Clause, draft: &mut Draft, objects: &[usize], when: When) -> Result<(), Refusal> {
    let off_edge = clause.take_sense(&Sense::Edge);
    let speed = clause.take_measure_or_plain(Dimension::Speed).map(|(v, _)| v);
    let mut directions = clause.take_directions();
    directions.extend(take_side(clause));
    let (strength, scale) = strength(Verb::Push(0.0), clause, draft)?;
    if scale.is_some_and(|s| s.compared) && directions.is_empty() && speed.is_none() && when == When::Start && super::pace::has_speed(draft, objects)
    {
        return super::pace::speed(draft, objects, strength);
    }
    let replace = clause.take_sense(&Sense::Instead);
    for &object in objects {
        // "Kick it very hard" is no harder than "very hard"; a factor that is said holds as said.
        let said_so = scale.is_some_and(|s| s.compared);
        let vigour = if said_so { strength } else { (strength * HARD.powf(strength_of_word)).clamp(HARD.powi(-2), HARD.powi(2)) };
        let usual = PUSH_M_S * draft.size_m(object).sqrt() * vigour;
        let assumed = if directions.is_empty() { " (no direction said)" } else { "" };
        let wanted = if directions.is_empty() { &[Direction::Forward][..] } else { &directions };
        let heading = draft.frame(object).heading(wanted).ok_or("those directions cancel out")?;
        let mut speed = speed.unwrap_or(usual);
        if off_edge {
            speed = speed.max(speed_to_edge(draft, object, heading.unit)?);
        }
        let name = draft.name(object);
        let said = format!("{name} is pushed {}{assumed}", heading.said);
        match when {
            When::At(_) | When::Impact => {
                draft.push_at(object, when, heading.unit * speed, "push");
                draft.gloss.push(format!("{said}{}: {} more", when.said(), say::speed(speed)));
            }
            When::Start => {
                if replace {
                    let up = draft.spec.objects[object].velocity_m_s[2];
                    draft.object(object).velocity_m_s = [0.0, 0.0, up];
                }
                draft.set_speed_along(object, heading.unit, speed);
                draft.gloss.push(format!("{said}: {} at the start", say::speed(speed)));
            }
        }
    }
    Ok(())
}

/// The speed that carries an object over the edge of the box it stands on, against friction, with a third to spare.
fn speed_to_edge(draft: &Draft, object: usize, unit: DVec3) -> Result<f64, Refusal> {
    let facts = draft.facts(object);
    let centre = DVec3::from_array(facts.centre_m);
    let reach = draft.spec.colliders.iter().find_map(|collider| {
        let ColliderShape::Box(shape) = collider.shape else { return None };
        let half = DVec3::from_array(shape.size_m) / 2.0;
        let away = centre - DVec3::from_array(shape.centre_m);
        let below = (shape.centre_m[2] + half.z - facts.support_m).abs() < 0.05 && away.x.abs() < half.x && away.y.abs() < half.y;
        let edge =
            |axis: usize| if unit[axis].abs() < 1e-6 { f64::INFINITY } else { (half[axis] - away[axis] * unit[axis].signum()) / unit[axis].abs() };
        below.then(|| (edge(0).min(edge(1)), collider.friction))
    });
    let (distance_m, friction) = reach.ok_or("it stands on no table here that it could be pushed off")?;
    Ok(1.3 * (2.0 * friction * draft.gravity_m_s2() * distance_m).sqrt())
}

fn throw(clause: &mut Clause, draft: &mut Draft, objects: &[usize], when: When) -> Result<(), Refusal> {
    let length = clause.take_measure(Dimension::Length);
    let high = clause.has(|s| matches!(s, Sense::Quality(Property::Height, ..) | Sense::Direction(Direction::Up)));
    let speed = clause.take_measure_or_plain(Dimension::Speed).map(|(v, _)| v);
    let elevation = clause.take_measure(Dimension::Angle).map(|(a, _)| a);
    let mut directions = clause.take_directions();
    let (strength, _) = strength(Verb::Throw, clause, draft)?;
    let (up, down) = (directions.contains(&Direction::Up), directions.contains(&Direction::Down));
    if up && down {
        return Err("those directions cancel out".to_owned());
    }
    directions.retain(|d| !matches!(d, Direction::Up | Direction::Down));
    let straight_up = up && directions.is_empty();
    let straight_down = down && directions.is_empty();
    let assumed = if directions.is_empty() && !up && !down { " (no direction said)" } else { "" };
    if directions.is_empty() {
        directions.push(Direction::Forward);
    }
    let gravity = draft.gravity_for_heights_m_s2();
    let elevation = match elevation.unwrap_or(TAU / 8.0) {
        _ if straight_up => TAU / 4.0,
        _ if straight_down => -TAU / 4.0,
        elevation if down => -elevation,
        elevation => elevation,
    };
    for &object in objects {
        let heading = draft.frame(object).heading(&directions).ok_or("those directions cancel out")?;
        let usual = THROW_M_S * draft.size_m(object).sqrt() * strength;
        let speed = match (speed, length) {
            (Some(speed), _) => speed,
            (None, Some((rise, _))) if high || straight_up => (2.0 * gravity * rise).sqrt() / elevation.sin().max(0.05),
            (None, Some(_)) if down => return Err("a throw that goes down has a speed, \"throw it down at 3 m/s\"".to_owned()),
            (None, Some((range, _))) => (gravity * range / (2.0 * elevation).sin().max(0.05)).sqrt(),
            (None, None) => usual,
        };
        let velocity = speed * (elevation.cos() * heading.unit.with_z(0.0).normalize_or_zero() + elevation.sin() * DVec3::Z);
        let way = match (straight_up, straight_down) {
            (true, _) => "up".to_owned(),
            (_, true) => "down".to_owned(),
            _ => format!("{}{assumed} and {} at {}°", heading.said, if down { "down" } else { "up" }, say::short(elevation.abs().to_degrees())),
        };
        let said = format!("{} is thrown {way}: {}", draft.name(object), say::speed(speed));
        match when {
            When::At(_) | When::Impact => {
                draft.push_at(object, when, velocity, "throw");
                draft.gloss.push(format!("{said}{}", when.said()));
            }
            When::Start => {
                draft.object(object).velocity_m_s = say::tidy3(velocity);
                draft.gloss.push(said);
            }
        }
    }
    draft.aloft |= !down;
    Ok(())
}

const LATER_SPIN: &str = "a spin can only be given at the start: events at a time are pushes";

fn spin(verb: Verb, clause: &mut Clause, draft: &mut Draft, objects: &[usize], at_s: Option<f64>) -> Result<(), Refusal> {
    if at_s.is_some() {
        return Err(LATER_SPIN.to_owned());
    }
    let rate = clause.take_measure(Dimension::AngularSpeed).map(|(w, _)| w);
    let directions = clause.take_directions();
    let scale = clause.take_scale(qualifies(Verb::Spin));
    if let Some(scale) = scale.filter(|s| s.compared) {
        draft.compare(scale.property, scale.ratio > 1.0, clause)?;
    }
    let strength_of_adverbs = clause.take_vigour();
    for &object in objects {
        let frame = draft.frame(object);
        let left = frame.unit(Direction::Left);
        // The axis is that of the turn a body makes when it rolls that way; a flat turn is about the vertical.
        let axis = directions.iter().fold(DVec3::ZERO, |axis, direction| {
            axis + match (verb, direction) {
                (Verb::Spin, Direction::Left | Direction::Sideways) | (_, Direction::Anticlockwise) => DVec3::Z,
                (Verb::Spin, Direction::Right) | (_, Direction::Clockwise) => -DVec3::Z,
                (_, Direction::Up | Direction::Down) => DVec3::ZERO,
                (_, Direction::Axis(..)) => frame.unit(*direction),
                (_, direction) => DVec3::Z.cross(frame.unit(*direction)),
            }
        });
        let before = DVec3::from_array(draft.spec.objects[object].spin_rad_s);
        let compared = scale.is_some_and(|s| s.compared) && before != DVec3::ZERO;
        let usual_axis = match verb {
            Verb::Roll => left,
            _ if compared => before.normalize_or(DVec3::Z),
            _ => DVec3::Z,
        };
        let axis = axis.try_normalize().unwrap_or(usual_axis);
        let usual = if compared { before.length() } else { SPIN_RAD_S };
        let rate = rate.unwrap_or(usual * scale.map_or(1.0, |s| s.ratio) * strength_of_adverbs);
        draft.object(object).spin_rad_s = say::tidy3(axis * rate);
        let line = format!("{} spins about {}: {}", draft.name(object), axis_name(axis * rate.signum()), say::turns(rate));
        draft.gloss.push(line);
    }
    Ok(())
}

/// "the vertical, counter-clockwise seen from above", "[0, 1, 0]".
pub fn axis_name(axis: DVec3) -> String {
    if axis.z.abs() > 0.999 {
        let way = if axis.z > 0.0 { "counter-clockwise" } else { "clockwise" };
        return format!("the vertical, {way} seen from above");
    }
    let [x, y, z] = axis.to_array().map(say::short);
    format!("the axis ({x}, {y}, {z})")
}

fn is_acceleration(sense: &Sense) -> bool {
    matches!(sense, Sense::Measure(q, _) if q.dimension == Dimension::Acceleration)
}

/// "from behind" as the direction that something coming from there goes.
pub fn take_side(clause: &mut Clause) -> Option<Direction> {
    clause.take(|s| match s {
        Sense::View(view) => from_side(*view),
        _ => None,
    })
}

/// From when and until when something lasts: "from 0.2 s to 1 s", "at 1 s for 2 s", "until 2 s".
pub fn lasts(clause: &mut Clause, at_s: Option<f64>) -> Result<(f64, Until), Refusal> {
    let span = clause.take(|s| match s {
        Sense::Span(from, to) => Some((*from, *to)),
        _ => None,
    });
    let lasts = clause.take_for();
    let until = clause.take_until();
    let from_s = span.map(|s| s.0).or(at_s).unwrap_or(0.0);
    let to_s = match (span, until, lasts) {
        (Some((_, to)), ..) => Until::Time(to),
        (None, Some(to), _) => Until::Time(to),
        (None, None, Some(lasts)) => Until::Time(say::tidy(from_s + lasts)),
        (None, None, None) => Until::End,
    };
    match to_s {
        Until::Time(to) if to <= from_s => Err("that ends before it begins".to_owned()),
        _ => Ok((from_s, to_s)),
    }
}

/// A constant acceleration over a span of time: a pull, or wind that is given as one.
fn pull(verb: Verb, clause: &mut Clause, draft: &mut Draft, objects: &[usize], at_s: Option<f64>) -> Result<(), Refusal> {
    let acceleration = clause.take_measure(Dimension::Acceleration).map(|(a, _)| a);
    let (from_s, to_s) = lasts(clause, at_s)?;
    let mut directions = clause.take_directions();
    directions.extend(take_side(clause));
    // "Pull it towards the table"
    if directions.is_empty() && clause.take_sense(&Sense::Ground) {
        directions.push(Direction::Down);
    }
    let (strength, _) = strength(Verb::Pull, clause, draft)?;
    let stem = if verb == Verb::Blow { "wind" } else { "pull" };
    for &object in objects {
        let assumed = if directions.is_empty() { " (no direction said)" } else { "" };
        let wanted = if directions.is_empty() { &[Direction::Forward][..] } else { &directions };
        let heading = draft.frame(object).heading(wanted).ok_or("those directions cancel out")?;
        let amount = acceleration.unwrap_or(PULL_M_S2 * strength);
        let name = draft.name(object);
        let acceleration_m_s2 = say::tidy3(heading.unit * amount);
        let same = |f: &&mut Force| f.object == name && f.from_s == from_s && f.name.starts_with(stem);
        match draft.spec.forces.iter_mut().find(same) {
            Some(force) => {
                force.to_s = to_s;
                force.set_constant(acceleration_m_s2);
            }
            None => {
                let force = draft.free_name(stem, |spec, name| spec.forces.iter().any(|f| f.name == name));
                draft.spec.forces.push(Force::constant(&force, &name, from_s, to_s, acceleration_m_s2));
            }
        }
        let until = match to_s {
            Until::End => "to the end".to_owned(),
            Until::Time(to) => format!("to {}", say::seconds(to)),
        };
        let how = if verb == Verb::Blow { "is blown" } else { "is pulled" };
        draft.gloss.push(format!("{name} {how} {}{assumed} with {} from {} {until}", heading.said, say::acceleration(amount), say::seconds(from_s)));
    }
    Ok(())
}
