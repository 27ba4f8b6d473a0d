//! Leading a thing along a course, and hanging it up: pins that move, and pins above.

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Course, Part, Property, Sense, Verb, View};
use super::motion::lasts;
use super::parts::{self, Portion};
use super::place;
use glam::{DVec2, DVec3};
use phystalk::spec::{Pin, Until};
use std::f64::consts::TAU;

/// Radius of a course that nobody measured, in longest sides of the object.
const RADIUS_SIZES: f64 = 0.4;
/// A round of it, seconds.
const ROUND_S: f64 = 2.0;
/// Points of a round: a polygon that nobody sees the corners of.
const POINTS: usize = 32;
/// Rounds at most, as many as a path has points for: what lasts longer stands still then.
const ROUNDS: usize = phystalk::spec::limits::PIN_PATH as usize / POINTS;

/// "move it in a circle", "lead the top along an eight of 20 cm": a part of it is held and led, the base unless one is named.
pub fn lead(course: Course, clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    clause.take_verb(|v| matches!(v, Verb::Move | Verb::Push(_) | Verb::Pull | Verb::Pin | Verb::Lift | Verb::Orbit));
    let objects = draft.subjects(clause)?;
    let part = parts::take(clause).unwrap_or(Part::Base);
    let radius = clause.take_measure_or_plain(Dimension::Length).map(|(l, _)| l);
    let scale = clause.take_scale(&[Property::Size, Property::Speed]);
    let (ratio, pace) = match scale {
        Some(scale) if scale.property == Property::Speed => (1.0, scale.ratio),
        Some(scale) => (scale.ratio, 1.0),
        None => (1.0, 1.0),
    };
    let at_s = clause.take_at();
    let (from_s, to_s) = lasts(clause, at_s)?;
    for &object in &objects {
        let name = draft.name(object);
        let radius_m = say::tidy(radius.unwrap_or(RADIUS_SIZES * ratio * draft.size_m(object)));
        let round_s = ROUND_S / pace;
        let ends_s = if let Until::Time(to) = to_s { to } else { draft.duration_s().max(from_s + round_s) };
        let rounds = (((ends_s - from_s) / round_s).ceil().max(1.0) as usize).min(ROUNDS);
        let frame = draft.frame(object);
        let axes = [frame.forward(), DVec3::Z.cross(frame.forward())];
        let path = (1..=rounds * POINTS).map(|i| {
            let share = i as f64 / POINTS as f64;
            let at = radius_m * along(course, share.fract());
            let [x, y, z] = say::tidy3(axes[0] * at.x + axes[1] * at.y);
            [say::tidy(from_s + share * round_s), x, y, z]
        });
        let Portion { region, said, .. } = parts::portion(draft, object, part);
        let path = path.collect();
        draft.spec.pins.retain(|p| !(p.object == name && p.name.starts_with("course")));
        let pin = draft.plain_name("course", |spec, name| spec.pins.iter().any(|p| p.name == name));
        draft.spec.pins.push(Pin { name: pin, object: name.clone(), region, from_s, to_s, path });
        let times = if rounds == 1 { "once".to_owned() } else { format!("{rounds} times") };
        draft.gloss.push(format!(
            "{said} of {name} is led along {} of {}, {times}, {} a round",
            called(course),
            say::metres(radius_m),
            say::seconds(round_s)
        ));
    }
    Ok(())
}

/// "hang it from the ceiling": held by its top, clear of what is below it.
pub fn hang(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let objects = draft.subjects(clause)?;
    let part = parts::take(clause).unwrap_or(Part::Top);
    clause.take_sense(&Sense::Overhead);
    // "By the top", "from above"
    clause.take_sense(&Sense::View(View::Above));
    let at_s = clause.take_at();
    let (from_s, to_s) = lasts(clause, at_s)?;
    let height = clause.take_measure_or_plain(Dimension::Length).map(|(l, _)| l);
    for &object in &objects {
        let name = draft.name(object);
        let gap_m = height.unwrap_or(place::LIFT_HEIGHTS * draft.facts(object).height_m());
        draft.set_gap_m(object, gap_m.max(draft.gap_m(object)));
        let Portion { region, said, .. } = parts::portion(draft, object, part);
        draft.spec.pins.retain(|p| !(p.object == name && p.region == region));
        let pin_name = draft.free_name("hook", |spec, name| spec.pins.iter().any(|p| p.name == name));
        draft.spec.pins.push(Pin { name: pin_name, object: name.clone(), region, from_s, to_s, path: Vec::new() });
        draft.gloss.push(format!("{name} hangs by {said}, {} above what is below it", say::metres(draft.gap_m(object))));
    }
    Ok(())
}

/// Where a round of unit radius is at a share of it, from where it begins: x ahead, y to the left.
fn along(course: Course, share: f64) -> DVec2 {
    let (sin, cos) = (TAU * share).sin_cos();
    match course {
        // Its middle is to the left of where it begins.
        Course::Circle => DVec2::new(sin, 1.0 - cos),
        // Gerono's: crosses itself where it begins.
        Course::Eight => DVec2::new(sin, sin * cos),
        Course::Square => {
            let corner = |k: usize| [DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::ONE, DVec2::new(0.0, 1.0)][k % 4] * 2.0;
            let edge = 4.0 * share;
            corner(edge as usize).lerp(corner(edge as usize + 1), edge.fract())
        }
    }
}

fn called(course: Course) -> &'static str {
    match course {
        Course::Circle => "a circle",
        Course::Eight => "an eight",
        Course::Square => "a square",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn courses_close_and_keep_their_size() {
        for course in [Course::Circle, Course::Eight, Course::Square] {
            assert!(along(course, 0.0).length() < 1e-12 && along(course, 1.0 - 1e-12).length() < 1e-9, "{course:?}");
            let far = (0..64).map(|i| along(course, f64::from(i) / 64.0).x.abs()).fold(0.0, f64::max);
            assert!((1.0..=2.0).contains(&far), "{course:?} {far}");
        }
    }
}
