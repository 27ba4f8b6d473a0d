//! What stands around: "put a wall on the left", "add a ball 1 m in front of it", "remove the table".

use super::super::clause::Clause;
use super::super::directions;
use super::super::directions::Heading;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Direction, Scenery, Sense, Verb, View};
use glam::DVec3;
use phystalk::spec::{BoxShape, CapsuleShape, Collider, ColliderShape, PlaneShape, SphereShape};

/// How far off a thing is put that nobody measured, in longest sides of the object.
const GAP_SIZES: f64 = 0.5;
/// Edge of a block, height of a post and diameter of a ball, in longest sides of the object.
const BLOCK_SIZES: f64 = 0.5;
/// Radius of a post.
const POST_SIZES: f64 = 0.08;

/// Whether the clause puts something there.
pub fn is_put(clause: &Clause) -> bool {
    clause.has(|s| matches!(s, Sense::Scenery(_))) && !clause.has(|s| *s == Sense::Negation || *s == Sense::Verb(Verb::Stop))
}

/// "put a wall on the left", "a ball 1 m in front of it".
pub fn put(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    let things = clause.take_all(|s| match s {
        Sense::Scenery(thing) => Some(*thing),
        _ => None,
    });
    clause.take_verb(|v| v == Verb::Move);
    let objects = draft.subjects(clause)?;
    let length = clause.take_measure_or_plain(Dimension::Length).map(|(l, _)| l);
    let mut wanted = clause.take_directions();
    wanted.extend(clause.take_all(|s| match s {
        Sense::View(view) => whereabouts(*view),
        _ => None,
    }));
    clause.take_sense(&Sense::Ground);
    let [object] = objects[..] else { return Err("beside which one? \"put a wall to the left of the vase\"".to_owned()) };
    let assumed = if wanted.is_empty() { " (no side said)" } else { "" };
    if wanted.is_empty() {
        wanted.push(Direction::Forward);
    }
    let heading = draft.frame(object).heading(&wanted).ok_or("those directions cancel out")?;
    if heading.unit.z.abs() > 1e-6 {
        return Err("it stands beside things: \"put a wall on the left\", \"a ball in front of it\"".to_owned());
    }
    for thing in things {
        let gap_m = say::tidy(length.unwrap_or(GAP_SIZES * draft.size_m(object)));
        let collider = Collider {
            name: draft.plain_name(stem(thing), |spec, name| spec.colliders.iter().any(|c| c.name == name)),
            shape: shape(thing, draft, object, &heading, gap_m),
            friction: 0.3,
            restitution: 0.0,
        };
        let line = format!(
            "a {} stands {} off, {}{assumed} as {} sees it; it is not drawn",
            stem(thing),
            say::metres(gap_m),
            heading.said,
            draft.name(object)
        );
        draft.gloss.push(line);
        draft.spec.colliders.push(collider);
    }
    Ok(())
}

/// "remove the table", "no wall". Whether the clause was that.
pub fn remove(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let denied = clause.has(|s| *s == Sense::Negation || *s == Sense::Verb(Verb::Stop));
    let noun = clause
        .left()
        .find(|p| matches!(p.sense, Sense::Ground | Sense::Scenery(_)))
        .map(|p| (p.sense.clone(), draft.words(p.span.clone()).to_lowercase()));
    let other = clause
        .has(|s| matches!(s, Sense::Verb(verb) if *verb != Verb::Stop) || matches!(s, Sense::Property(_) | Sense::Quality(..) | Sense::Surface(_)));
    let Some((sense, noun)) = noun.filter(|_| denied && !other) else { return Ok(false) };
    let stem = match sense {
        Sense::Scenery(thing) => stem(thing).to_owned(),
        _ => noun.trim_start_matches("the ").to_owned(),
    };
    let gone: Vec<String> =
        draft.spec.colliders.iter().map(|c| c.name.clone()).filter(|name| name.trim_end_matches(|c: char| c.is_ascii_digit()) == stem).collect();
    if gone.is_empty() {
        let there: Vec<String> = draft.spec.colliders.iter().map(|c| c.name.clone()).collect();
        let there = if there.is_empty() {
            "nothing but the ground is there, and it stays".to_owned()
        } else {
            format!("there is: {}; the ground stays", say::list(&there))
        };
        return Err(format!("{noun}: {there}"));
    }
    clause.take_verb(|v| v == Verb::Stop);
    clause.take_sense(&Sense::Negation);
    clause.take_sense(&sense);
    draft.spec.colliders.retain(|c| !gone.contains(&c.name));
    let pictured = if sense == Sense::Ground { "; its picture stays" } else { "" };
    draft.gloss.push(format!("{} is not there any more{pictured}", say::list(&gone)));
    Ok(true)
}

/// Where a thing is that stands on a side.
fn whereabouts(view: View) -> Option<Direction> {
    directions::from_side(view).map(|goes| match goes {
        Direction::Forward => Direction::Backward,
        Direction::Backward => Direction::Forward,
        Direction::Left => Direction::Right,
        Direction::Right => Direction::Left,
        other => other,
    })
}

/// What it is called in a spec.
fn stem(thing: Scenery) -> &'static str {
    match thing {
        Scenery::Wall => "wall",
        Scenery::Block => "block",
        Scenery::Ball => "ball",
        Scenery::Post => "post",
    }
}

/// A thing whose near side is `gap_m` from the object's own, on what the object stands on.
fn shape(thing: Scenery, draft: &Draft, object: usize, heading: &Heading, gap_m: f64) -> ColliderShape {
    let facts = draft.facts(object);
    let (low, high) = (DVec3::from_array(facts.low_m), DVec3::from_array(facts.high_m));
    let size_m = draft.size_m(object);
    let start = DVec3::from_array(facts.centre_m) + DVec3::from_array(draft.spec.objects[object].offset_m);
    // From the middle to the object's side that way.
    let reach = (0.5 * (high - low) * heading.unit.abs()).element_sum();
    let side = (start + heading.unit * (reach + gap_m)).with_z(facts.support_m);
    let edge = BLOCK_SIZES * size_m;
    let behind = |depth: f64, height: f64| say::tidy3(side + heading.unit * depth + DVec3::Z * height);
    match thing {
        Scenery::Wall => ColliderShape::Plane(PlaneShape { point_m: say::tidy3(side), normal: say::tidy3(-heading.unit) }),
        Scenery::Block => {
            // It is aligned with the axes: its middle is as far off as its extent that way asks for.
            let depth = 0.5 * edge * heading.unit.abs().element_sum();
            ColliderShape::Box(BoxShape { centre_m: behind(depth, 0.5 * edge), size_m: [say::tidy(edge); 3] })
        }
        Scenery::Ball => ColliderShape::Sphere(SphereShape { centre_m: behind(0.5 * edge, 0.5 * edge), radius_m: say::tidy(0.5 * edge) }),
        Scenery::Post => {
            let radius_m = say::tidy(POST_SIZES * size_m);
            ColliderShape::Capsule(CapsuleShape { from_m: behind(radius_m, 0.0), to_m: behind(radius_m, size_m), radius_m })
        }
    }
}
