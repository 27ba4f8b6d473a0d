//! Fields: wind, swirls, blasts, drag of air and water, swinging and shaking, motors.

use super::super::clause::{Clause, HARD};
use super::super::directions::Heading;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Direction, Field, Property, Sense, Verb};
use super::motion::{axis_name, lasts, strength, take_side};
use glam::DVec3;
use phystalk::spec::expression::{Kind, parse};
use phystalk::spec::{Acceleration, Attractor, Auto, Drag, Explosion, Force, Motor, Spring, Until, Vortex, Wind};
use std::f64::consts::TAU;

/// Speed of a wind that nobody gave, for an object of one metre: it slides at the default friction, and bends.
const WIND_M_S: f64 = 6.0;
/// Speed of a swirl that nobody gave, for an object of one metre.
const SWIRL_M_S: f64 = 3.0;
/// How fast matter follows the air of a swirl, and how many times its weight one that lifts pulls at what stands.
const SWIRL_PER_S: f64 = 2.0;
const LIFTS: f64 = 1.5;
/// Speed of a blast that nobody gave, for an object of one metre.
const BLAST_M_S: f64 = 5.0;
/// Pull towards the middle that nobody gave.
const ATTRACT_M_S2: f64 = 10.0;
/// Of a thing in air, much as of a beach ball: it falls at 4 m/s in the end.
const AIR_PER_M: f64 = 0.6;
/// Of a thing in water.
const WATER_PER_S: f64 = 4.0;
/// Acceleration and angular speed of a swing that nobody gave: once a second, a third of a metre wide.
const SWAY: (f64, f64) = (6.0, TAU);
/// Of shaking: five times a second.
const SHAKE: (f64, f64) = (30.0, 5.0 * TAU);
/// Stiffness of a spring that nobody gave: about one swing a second.
const SPRING_PER_S2: f64 = 40.0;
/// How far gusts go from the mean of a gusty wind, as a share of it.
const GUSTY: f64 = 0.5;

/// Reads one verb of a field with all that belongs to it.
pub fn understand(field: Field, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    // "swing it to and fro" says it twice.
    while clause.take_verb(|v| v == Verb::Field(field)).is_some() {}
    let objects = draft.subjects(clause)?;
    // "It explodes into sand at 0.5 s": the time was that of the sand too.
    let said = clause.phrases().iter().find_map(|p| if let Sense::At(time) = p.sense { Some(time) } else { None });
    let at_s = clause.take_at().or(said.filter(|_| field == Field::Explode));
    // A blast is over at once: "for 2 s" is how long the run lasts.
    let span = if field == Field::Explode { (at_s.unwrap_or(0.0), Until::End) } else { lasts(clause, at_s)? };
    let aimed = matches!(field, Field::Swirl | Field::Motor | Field::Sway | Field::Shake);
    if clause.has(|s| matches!(s, Sense::View(_))) && !clause.has(|s| *s == Sense::Verb(Verb::Look)) {
        return Err(
            "that has no side that it comes from; \"push it from below\" and \"wind from the left\" have, and \"hang it from the top\" holds it so"
                .to_owned(),
        );
    }
    if !aimed && clause.has(|s| matches!(s, Sense::Direction(Direction::Towards | Direction::Away))) {
        return Err("that goes to or from its own middle; \"pull it towards the camera\" moves it there".to_owned());
    }
    if clause.has(|s| *s == Sense::Overhead) {
        return Err("\"hang it from the top and push it to the left\" swings it so".to_owned());
    }
    let lifts = field == Field::Swirl && clause.phrases().iter().any(|p| p.sense == Sense::Verb(Verb::Lift));
    let ask = Ask {
        lifts,
        speed: clause.take_measure(Dimension::Speed).map(|(v, _)| v),
        rate: clause.take_measure(Dimension::AngularSpeed).map(|(w, _)| w),
        acceleration: clause.take_measure(Dimension::Acceleration).map(|(a, _)| a),
        directions: if aimed { clause.take_directions() } else { Vec::new() },
        strength: strength(Verb::Field(field), clause, draft)?.0,
    };
    for &object in &objects {
        one(field, &ask, span, draft, object)?;
    }
    Ok(())
}

/// What a clause says of a field.
struct Ask {
    lifts: bool,
    speed: Option<f64>,
    rate: Option<f64>,
    acceleration: Option<f64>,
    directions: Vec<Direction>,
    strength: f64,
}

impl Ask {
    /// -1 where it goes clockwise.
    fn turn(&self) -> f64 {
        if self.directions.iter().any(|d| matches!(d, Direction::Clockwise | Direction::Right)) { -1.0 } else { 1.0 }
    }
}

fn one(field: Field, ask: &Ask, span: (f64, Until), draft: &mut Draft, object: usize) -> Result<(), Refusal> {
    let (name, size_m) = (draft.name(object), draft.size_m(object));
    let radius_m = say::tidy(0.5 * size_m);
    // Amounts that are not given follow the object's size by Froude's rule.
    let speed = |usual: f64| say::tidy(ask.speed.unwrap_or(usual * ask.strength * size_m.sqrt()));
    let when = said_span(span);
    match field {
        Field::Swirl => {
            let speed_m_s = ask.turn() * speed(SWIRL_M_S);
            let lift_m_s = if ask.lifts { say::tidy(LIFTS * draft.gravity_for_heights_m_s2() / SWIRL_PER_S) } else { 0.0 };
            let vortex = Vortex { centre_m: Auto::Auto, axis: [0.0, 0.0, 1.0], speed_m_s, radius_m, lift_m_s, drag_per_s: SWIRL_PER_S };
            put(draft, &name, "swirl", span, |force| force.vortex = Some(vortex));
            let axis = axis_name(DVec3::Z * speed_m_s.signum());
            let lift = if ask.lifts { format!(", and up at {}, which lifts it", say::speed(lift_m_s)) } else { String::new() };
            draft.gloss.push(format!("air swirls round {name} at {}, about {axis}{lift}{when}", say::speed(speed_m_s.abs())));
        }
        Field::Explode => {
            let speed_m_s = speed(BLAST_M_S);
            let explosion = Explosion { centre_m: Auto::Auto, speed_m_s, radius_m };
            put(draft, &name, "blast", span, |force| force.explosion = Some(explosion));
            draft.gloss.push(format!("{name} is blown out from its middle at {}: {}", say::seconds(span.0), say::speed(speed_m_s)));
        }
        Field::Attract => {
            let strength_m_s2 = say::tidy(ask.acceleration.unwrap_or(ATTRACT_M_S2 * ask.strength));
            let attractor = Attractor { centre_m: Auto::Auto, strength_m_s2, radius_m, falloff: 0.0 };
            put(draft, &name, "attract", span, |force| force.attractor = Some(attractor));
            draft.gloss.push(format!("{name} is drawn to its middle with {}{when}", say::acceleration(strength_m_s2)));
        }
        Field::Air | Field::Water => {
            let air = field == Field::Air;
            let (linear_per_s, quadratic_per_m) =
                if air { (0.0, say::tidy(AIR_PER_M * ask.strength)) } else { (say::tidy(WATER_PER_S * ask.strength), 0.0) };
            put(draft, &name, "drag", span, |force| force.drag = Some(Drag { linear_per_s, quadratic_per_m }));
            let ends = if air { format!(": falls end at {}", say::speed((9.81 / quadratic_per_m).sqrt())) } else { String::new() };
            draft.gloss.push(format!("{} slows {name}{ends}{when}", if air { "air" } else { "water" }));
        }
        Field::Sway | Field::Shake => {
            let (usual, angular) = if field == Field::Sway { SWAY } else { SHAKE };
            let amount = say::tidy(ask.acceleration.unwrap_or(usual * ask.strength));
            let angular = say::tidy(ask.rate.unwrap_or(angular));
            // "Left and right" is along one line.
            let line = ask.directions.first().copied().unwrap_or(Direction::Sideways);
            let heading = draft.frame(object).heading(&[line]).ok_or("a direction is needed")?;
            let acceleration_m_s2 = to_and_fro(heading.unit, amount, angular, span.0);
            let stem = if field == Field::Sway { "swing" } else { "shake" };
            put(draft, &name, stem, span, |force| force.acceleration_m_s2 = Some(Acceleration::Expression(acceleration_m_s2)));
            let times = match say::short(angular / TAU).as_str() {
                "1" => "once".to_owned(),
                times => format!("{times} times"),
            };
            draft.gloss.push(format!("{name} is driven to and fro, {times} a second, with {}{when}", say::acceleration(amount)));
        }
        Field::Spring => {
            let start = DVec3::from_array(draft.facts(object).centre_m) + DVec3::from_array(draft.spec.objects[object].offset_m);
            // A stronger one swings faster, and comes to rest in as many swings.
            let stiffness_per_s2 = say::tidy(SPRING_PER_S2 * ask.strength);
            let damping_per_s = say::tidy(0.3 * stiffness_per_s2.sqrt());
            let spring = Spring { to_m: Some(say::tidy3(start)), path_m: Vec::new(), stiffness_per_s2, damping_per_s };
            put(draft, &name, "spring", span, |force| force.spring = Some(spring));
            let swings = say::short(stiffness_per_s2.sqrt() / TAU);
            draft.gloss.push(format!("{name} is on a spring that draws it to where it starts: {swings} swings a second{when}"));
        }
        Field::Motor => {
            let speed_rad_s = say::tidy(ask.turn() * ask.rate.unwrap_or(TAU * ask.strength));
            let motor = Motor { centre_m: Auto::Auto, axis: [0.0, 0.0, 1.0], speed_rad_s, rate_per_s: 5.0 };
            put(draft, &name, "motor", span, |force| force.motor = Some(motor));
            draft.gloss.push(format!("{name} is kept turning, {}{when}", say::turns(speed_rad_s)));
        }
    }
    Ok(())
}

/// An acceleration along a line, as an expression. What starts from rest comes back: a sine in place of the cosine
/// would carry it off.
fn to_and_fro(unit: DVec3, amount: f64, angular: f64, from_s: f64) -> String {
    let [x, y, z] = say::tidy3(unit * amount);
    let time = if from_s == 0.0 { "t".to_owned() } else { format!("(t - {from_s})") };
    let text = format!("vec3({x}, {y}, {z}) * cos({angular} * {time})");
    // In the form in which specs hold it.
    parse(&text, Kind::Vector).map(|tree| tree.to_string()).unwrap_or(text)
}

/// Wind, as moving air.
pub fn wind(clause: &mut Clause, draft: &mut Draft, objects: &[usize], at_s: Option<f64>) -> Result<(), Refusal> {
    let speed = clause.take_measure(Dimension::Speed).map(|(v, _)| v);
    // "A light breeze" weighs nothing, and "a short gust" is not how long the run lasts.
    let light = clause.take(|s| matches!(s, Sense::Quality(Property::Density, sign, _) if *sign < 0.0).then_some(1.0 / HARD)).unwrap_or(1.0);
    if clause.has(|s| matches!(s, Sense::Quality(Property::Duration, ..))) {
        return Err("how long does it blow? \"a gust from the left at 1 s for 0.3 s\"".to_owned());
    }
    let from_start = clause.has(|s| matches!(s, Sense::Span(..)));
    let timed = at_s.is_some() || clause.has(|s| matches!(s, Sense::For(_) | Sense::Until(_) | Sense::Span(..)));
    let span = lasts(clause, at_s)?;
    let gust = if clause.take_sense(&Sense::Gusty) { GUSTY } else { 0.0 };
    let mut directions = clause.take_directions();
    directions.extend(take_side(clause));
    let (strength, scale) = strength(Verb::Blow, clause, draft)?;
    let strength = light * strength;
    for &object in objects {
        let name = draft.name(object);
        // "A stronger wind" is one that is there, made stronger.
        let blows = draft.spec.forces.iter_mut().rev().find(|f| f.object == name && f.wind.is_some());
        if let Some(force) = blows.filter(|_| scale.is_some_and(|s| s.compared) && directions.is_empty() && speed.is_none()) {
            let before = force.strength().map_or(0.0, |(s, _)| s);
            if let Some(wind) = &mut force.wind {
                wind.velocity_m_s = say::tidy3(DVec3::from(wind.velocity_m_s) * strength);
                wind.gust = wind.gust.max(gust);
            }
            draft.gloss.push(format!("the wind on {name} has {} instead of {}", say::speed(before * strength), say::speed(before)));
            continue;
        }
        // One that nobody describes again is the one that blows: "the wind only for the first second".
        let blows = draft.spec.forces.iter_mut().rev().find(|f| f.object == name && f.wind.is_some());
        if let Some(force) = blows.filter(|_| scale.is_none() && strength == 1.0 && directions.is_empty() && speed.is_none()) {
            if timed {
                // "Until 1 s" says nothing of when it begins.
                (force.from_s, force.to_s) = if span.0 == 0.0 && !from_start { (force.from_s, span.1) } else { span };
            }
            if let Some(wind) = &mut force.wind {
                (wind.gust, wind.turbulence) = (wind.gust.max(gust), wind.turbulence.max(0.5 * gust));
            }
            let span = (force.from_s, force.to_s);
            draft.gloss.push(format!("the wind on {name} blows as it did{}", said_span(span)));
            continue;
        }
        if scale.is_some_and(|s| s.compared && s.sign < 0.0) && directions.is_empty() && speed.is_none() {
            return Err(format!("no wind blows on {name} that could be less: \"a gentle wind from the left\""));
        }
        let assumed = if directions.is_empty() { " (no direction said)" } else { "" };
        let wanted = if directions.is_empty() { &[Direction::Forward][..] } else { &directions };
        let blew = draft.spec.forces.iter().rev().find(|f| f.object == name).and_then(|f| f.wind.as_ref()).map(|w| DVec3::from(w.velocity_m_s));
        let (heading, assumed) = match blew.and_then(DVec3::try_normalize).filter(|_| directions.is_empty()) {
            Some(unit) => (Heading { unit, said: "the way it blew".to_owned() }, ""),
            None => (draft.frame(object).heading(wanted).ok_or("those directions cancel out")?, assumed),
        };
        let speed = speed.unwrap_or(WIND_M_S * strength * draft.size_m(object).sqrt());
        let velocity_m_s = say::tidy3(heading.unit * speed);
        let wind = Wind { velocity_m_s, drag_per_s: 1.0, gust, turbulence: 0.5 * gust, eddy_m: 0.3 };
        put(draft, &name, "wind", span, |force| force.wind = Some(wind));
        let gusts = if gust > 0.0 { " in gusts" } else { "" };
        draft.gloss.push(format!("wind blows on {name} {}{assumed} at {}{gusts}{}", heading.said, say::speed(speed), said_span(span)));
    }
    Ok(())
}

/// Adds a force, or replaces the object's own of that kind that begins at the same time.
fn put(draft: &mut Draft, object: &str, stem: &str, (from_s, to_s): (f64, Until), fill: impl FnOnce(&mut Force)) {
    let same = |f: &&mut Force| f.object == object && f.from_s == from_s && f.name.starts_with(stem);
    let known = draft.spec.forces.iter_mut().find(same).map(|f| f.name.clone());
    let name = known.clone().unwrap_or_else(|| draft.free_name(stem, |spec, name| spec.forces.iter().any(|f| f.name == name)));
    let mut force = Force::new(&name, object, from_s, to_s);
    fill(&mut force);
    match draft.spec.forces.iter_mut().find(|f| Some(&f.name) == known.as_ref()) {
        Some(old) => *old = force,
        None => draft.spec.forces.push(force),
    }
}

/// " from 0.5 s to 1 s"; nothing where it is all the time.
fn said_span((from_s, to_s): (f64, Until)) -> String {
    match to_s {
        Until::End if from_s == 0.0 => String::new(),
        Until::End => format!(" from {} on", say::seconds(from_s)),
        Until::Time(to) => format!(" from {} to {}", say::seconds(from_s), say::seconds(to)),
    }
}

/// What the forces of a field are called.
pub fn stem(field: Field) -> &'static str {
    match field {
        Field::Swirl => "swirl",
        Field::Explode => "blast",
        Field::Attract => "attract",
        Field::Air | Field::Water => "drag",
        Field::Sway => "swing",
        Field::Shake => "shake",
        Field::Motor => "motor",
        Field::Spring => "spring",
    }
}
