//! Verbs that say how and where an object starts: drop, lift, move, turn, tilt, and poses.

use super::super::clause::{Clause, HARD, qualifies};
use super::super::draft::{Draft, Refusal, rotate_deg, rotation};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Direction, Pose, Preposition, Property, Sense, Verb, View};
use super::stuff;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// A drop that nobody measured, in heights of the object.
pub const DROP_HEIGHTS: f64 = 1.0;
/// A lift that nobody measured.
pub const LIFT_HEIGHTS: f64 = 0.5;
/// A move that nobody measured, in longest sides of the object.
pub const MOVE_SIZES: f64 = 0.5;
/// "Tilt it" and nothing more.
pub const TILT_RAD: f64 = TAU / 24.0;
/// "Turn it" and nothing more.
pub const TURN_RAD: f64 = TAU / 4.0;

/// Whether a word that makes it fall only tells what a jump does by itself: "jump and fall back to the table".
pub fn falls_by_itself(clause: &mut Clause, draft: &Draft) -> bool {
    let asks = clause.has(|s| match s {
        Sense::Measure(quantity, _) => matches!(quantity.dimension, Dimension::Length | Dimension::Plain),
        Sense::Quality(property, ..) => qualifies(Verb::Fall).contains(property),
        _ => false,
    });
    if !draft.aloft || asks {
        return false;
    }
    clause.take_directions();
    clause.take_sense(&Sense::Ground);
    true
}

/// "drop it from 2 m": its lowest point starts so high above what is below it.
pub fn drop(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    if clause.take_at().is_some() {
        return Err("a drop starts at the start; \"hold it\" and \"let go at 1 s\" do it later".to_owned());
    }
    let height = clause.take_measure_or_plain(Dimension::Length).map(|(h, _)| h);
    let heights = clause.take_heights();
    clause.take(|s| matches!(s, Sense::Direction(Direction::Down)).then_some(()));
    clause.take_sense(&Sense::Ground);
    clause.take_sense(&Sense::AboveGround);
    clause.take_sense(&Sense::View(View::Above));
    let scale = clause.take_scale(qualifies(Verb::Fall));
    // "Drop it hard" says nothing of what it is made of.
    let hard = clause.take(|s| matches!(s, Sense::Quality(Property::Hardness, ..)).then_some(HARD)).unwrap_or(1.0);
    let vigour = hard * clause.take_vigour();
    for &object in &objects {
        let before = draft.gap_m(object);
        let usual = match scale {
            Some(scale) if scale.compared && before > 1e-3 => before * scale.ratio,
            _ => DROP_HEIGHTS * draft.facts(object).height_m() * scale.map_or(1.0, |s| s.ratio) * vigour,
        };
        let gap = height.or(heights.map(|n| n * draft.facts(object).height_m())).unwrap_or(usual);
        draft.set_gap_m(object, gap);
        draft.object(object).velocity_m_s[2] = 0.0;
        let floats = if draft.gravity_m_s2() < 1e-6 { "; without gravity it floats there" } else { "" };
        let line = format!("{} drops from {} above what is below it{floats}", draft.name(object), say::metres(gap));
        draft.gloss.push(line);
    }
    draft.aloft = true;
    Ok(())
}

/// "lift it by 20 cm": it starts so much higher; "to 1 m" is over what is below it.
pub fn lift(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let length = clause.take_measure_or_plain(Dimension::Length);
    let directions = clause.take_directions();
    let above = clause.take_sense(&Sense::AboveGround);
    clause.take_sense(&Sense::Ground);
    let heights = clause.take_heights();
    let ratio = clause.take_scale(qualifies(Verb::Lift)).map_or(1.0, |s| s.ratio) * clause.take_vigour();
    for &object in &objects {
        let usual = heights.unwrap_or(LIFT_HEIGHTS * ratio) * draft.facts(object).height_m();
        let absolute = above || matches!(length, Some((_, Some(Preposition::To | Preposition::At))));
        let amount = length.map_or(usual, |(l, _)| l);
        let down = directions.contains(&Direction::Down);
        let gap = if absolute { amount } else { draft.gap_m(object) + if down { -amount } else { amount } };
        raise(draft, object, gap)?;
    }
    draft.aloft = true;
    Ok(())
}

/// Sets how high an object's lowest point starts, and says it.
pub fn raise(draft: &mut Draft, object: usize, gap_m: f64) -> Result<(), Refusal> {
    if gap_m < -1e-6 {
        return Err(format!("{} would start {} inside what it stands on", draft.name(object), say::metres(-gap_m)));
    }
    draft.set_gap_m(object, gap_m);
    let line = format!("{} starts {} above what is below it", draft.name(object), say::metres(gap_m));
    draft.gloss.push(line);
    Ok(())
}

/// "move it 20 cm to the left", "put it on the table".
pub fn shift(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let length = clause.take_measure_or_plain(Dimension::Length).map(|(l, _)| l);
    let vigour = clause.take_vigour();
    let directions = clause.take_directions();
    if clause.take_sense(&Sense::AboveGround)
        && let Some(gap) = length
    {
        return objects.iter().try_for_each(|&object| raise(draft, object, gap));
    }
    if directions.is_empty() && clause.take_sense(&Sense::Ground) {
        return objects.iter().try_for_each(|&object| raise(draft, object, 0.0));
    }
    if directions.is_empty() {
        return Err("where to? \"move it 20 cm to the left\", \"lift it by 10 cm\"".to_owned());
    }
    for &object in &objects {
        let heading = draft.frame(object).heading(&directions).ok_or("those directions cancel out")?;
        let distance = length.unwrap_or(MOVE_SIZES * draft.size_m(object) * vigour);
        let name = draft.name(object);
        if draft.gap_m(object) + heading.unit.z * distance < -1e-6 {
            return Err(format!("{name} would start inside what it stands on"));
        }
        let offset = DVec3::from_array(draft.spec.objects[object].offset_m) + heading.unit * distance;
        draft.object(object).offset_m = say::tidy3(offset);
        draft.gloss.push(format!("{name} starts {} further {}", say::metres(distance), heading.said));
    }
    Ok(())
}

/// "turn it by 90 degrees", "tilt it 20 degrees to the left".
pub fn turn(verb: Verb, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    if verb == Verb::Turn {
        stuff::refuse_unknown(clause, draft)?;
    }
    if clause.take_at().is_some() {
        return Err("a turn is where it starts; \"spin it\" turns it over time".to_owned());
    }
    let angle = clause.take_measure_or_plain(Dimension::Angle);
    // A bare number is in degrees.
    let plain = clause.phrases().iter().all(|p| !matches!(&p.sense, Sense::Measure(q, _) if q.dimension == Dimension::Angle));
    // "turn it around"
    let half_turn = verb == Verb::Turn && clause.take_sense(&Sense::Preposition(Preposition::Around));
    let angle = match angle {
        Some((value, _)) => {
            if plain {
                value.to_radians()
            } else {
                value
            }
        }
        None if half_turn => PI,
        None => {
            if verb == Verb::Tilt {
                TILT_RAD
            } else {
                TURN_RAD
            }
        }
    };
    let angle = angle * clause.take_vigour();
    let directions = clause.take_directions();
    for &object in &objects {
        let frame = draft.frame(object);
        let axis = directions.iter().fold(DVec3::ZERO, |axis, direction| {
            axis + match (verb, direction) {
                (Verb::Turn, Direction::Left | Direction::Sideways) | (_, Direction::Anticlockwise) => DVec3::Z,
                (Verb::Turn, Direction::Right) | (_, Direction::Clockwise) => -DVec3::Z,
                (_, Direction::Up | Direction::Down) => DVec3::ZERO,
                (_, Direction::Axis(..)) => frame.unit(*direction),
                (_, direction) => DVec3::Z.cross(frame.unit(*direction)),
            }
        });
        let usual = if verb == Verb::Tilt { DVec3::Z.cross(frame.forward()) } else { DVec3::Z };
        rotate(draft, object, DMat3::from_axis_angle(axis.try_normalize().unwrap_or(usual), angle));
        let degrees = say::short(angle.abs().to_degrees());
        let line = match frame.heading(&directions).filter(|_| verb == Verb::Tilt && angle > 0.0) {
            Some(heading) => format!("{} leans {} by {degrees}°", draft.name(object), heading.said),
            None => {
                let axis = super::motion::axis_name(axis.try_normalize().unwrap_or(usual) * angle.signum());
                format!("{} is turned by {degrees}° about {axis}", draft.name(object))
            }
        };
        draft.gloss.push(line);
    }
    Ok(())
}

/// "tip it over to the left": it starts leaning a fifth further than where its middle stands over its edge.
pub fn topple(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let directions = clause.take_directions();
    for &object in &objects {
        let frame = draft.frame(object);
        let wanted = if directions.is_empty() { &[Direction::Forward][..] } else { &directions };
        let heading = frame.heading(wanted).ok_or("those directions cancel out")?;
        let axis = DVec3::Z.cross(heading.unit).try_normalize().ok_or("it falls over to a side: \"to the left\", \"forward\"")?;
        let facts = draft.facts(object);
        let half = (DVec3::from_array(facts.high_m) - DVec3::from_array(facts.low_m)) / 2.0;
        let edge_m = half.x * heading.unit.x.abs() + half.y * heading.unit.y.abs();
        let angle = (1.2 * edge_m.atan2(facts.centre_m[2] - facts.low_m[2])).min(TAU / 4.5);
        rotate(draft, object, DMat3::from_axis_angle(axis, angle));
        let assumed = if directions.is_empty() { " (no direction said)" } else { "" };
        let line = format!("{} starts leaning {}{assumed} by {}°, and falls over", draft.name(object), heading.said, say::short(angle.to_degrees()));
        draft.gloss.push(line);
    }
    Ok(())
}

/// "upside down", "on its side", "upright".
pub fn pose(pose: Pose, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let directions = clause.take_directions();
    for &object in &objects {
        let frame = draft.frame(object);
        let upright = rotation(draft.spec.objects[object].rotate_deg).transpose();
        // About its own front, so that it keeps facing where it does; to its right unless a side is said.
        let side = directions.first().map_or(frame.unit(Direction::Right), |d| frame.unit(*d));
        let rotation = match pose {
            Pose::UpsideDown => DMat3::from_axis_angle(frame.forward(), PI),
            Pose::OnItsSide => DMat3::from_axis_angle(DVec3::Z.cross(side).normalize_or(frame.forward()), TAU / 4.0) * upright,
            Pose::Upright => upright,
        };
        rotate(draft, object, rotation);
        let said = match pose {
            Pose::UpsideDown => "is turned upside down",
            Pose::OnItsSide => "lies on its side",
            Pose::Upright => "stands as captured",
        };
        let line = format!("{} {said}, its lowest point {} above what is below it", draft.name(object), say::metres(draft.gap_m(object)));
        draft.gloss.push(line);
    }
    Ok(())
}

/// Turns an object further. Its lowest point stays as high as it was: what stood on the ground still does.
fn rotate(draft: &mut Draft, object: usize, by: DMat3) {
    let gap = draft.gap_m(object);
    let before = rotation(draft.spec.objects[object].rotate_deg);
    draft.object(object).rotate_deg = rotate_deg(by * before);
    if (draft.gap_m(object) - gap).abs() > 1e-6 {
        draft.set_gap_m(object, gap);
    }
}

/// "put it back": where it was captured, at rest.
pub fn reset(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    clause.take_directions();
    clause.take_sense(&Sense::Ground);
    for &object in &objects {
        let name = draft.name(object);
        let thing = draft.object(object);
        (thing.offset_m, thing.rotate_deg) = ([0.0; 3], [0.0; 3]);
        draft.gloss.push(format!("{name} starts where it was captured"));
    }
    Ok(())
}

/// "20 cm higher", "lower it by 10 cm": a length with a word for height and no verb.
pub fn take_rise(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let lengthy = clause.has(|s| matches!(s, Sense::Measure(q, _) if q.dimension == Dimension::Length));
    let height = |s: &Sense| match s {
        Sense::Quality(Property::Height, sign, _) => Some(*sign),
        _ => None,
    };
    if !lengthy || !clause.has(|s| height(s).is_some()) {
        return Ok(false);
    }
    let objects = draft.subjects(clause)?;
    let sign = clause.take(height).unwrap_or(1.0);
    let (length, _) = clause.take_measure(Dimension::Length).unwrap_or((0.0, None));
    for &object in &objects {
        let gap = draft.gap_m(object) + sign * length;
        raise(draft, object, gap)?;
    }
    Ok(true)
}
