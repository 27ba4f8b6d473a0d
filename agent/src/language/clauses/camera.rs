//! The camera: sides, distance, field of view, orbit.

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Direction, Preposition, Property, Sense, Verb, View};
use glam::{DQuat, DVec3};
use phystalk::spec::{Auto, Camera};
use phystalk::world::ballistics;

/// Seen from a side, the camera stands so much above the level, degrees; what "from above" leaves to the vertical, and
/// "from below" to the ground.
const SIDE_ELEVATION_DEG: f64 = 12.0;
const ABOVE_ELEVATION_DEG: f64 = 80.0;
const BELOW_ELEVATION_DEG: f64 = 2.0;
/// An orbit that nobody gave, degrees a second.
pub const ORBIT_DEG_S: f64 = 45.0;
/// "Move the camera to the left" and nothing more, degrees about the target.
pub const STEP_DEG: f64 = 30.0;

/// Height of the film that a focal length goes with: 24 mm, of 36 mm by 24 mm.
const FILM_M: f64 = 0.024;
/// Share of the half-picture that what moves may fill.
const FILL: f64 = 0.95;
/// How far a way is followed, in longest sides of the object.
const FAR_SIZES: f64 = 2.5;

/// Whether a clause is about the camera, whatever its verb.
pub fn is_about_camera(clause: &Clause) -> bool {
    let verbs = clause.has(|s| matches!(s, Sense::Verb(Verb::Look | Verb::Zoom(_) | Verb::Orbit)));
    let object = clause.has(|s| matches!(s, Sense::Objects(_)));
    let moves = clause.has(|s| matches!(s, Sense::Verb(Verb::Throw | Verb::Jump | Verb::Push(_) | Verb::Pull | Verb::Fall | Verb::Drop)));
    let closer = clause.has(|s| matches!(s, Sense::Quality(Property::Distance | Property::FieldOfView, ..) | Sense::Property(Property::FieldOfView)));
    let from_away = clause.has(|s| *s == Sense::Direction(Direction::Away))
        && clause.has(|s| matches!(s, Sense::Measure(q, Some(Preposition::From | Preposition::At)) if q.dimension == Dimension::Length))
        && !clause.has(|s| matches!(s, Sense::Verb(_)));
    verbs || from_away || clause.has(|s| *s == Sense::Camera || *s == Sense::View(View::Auto)) || (closer && !moves && !object)
}

/// Where the camera stands, about its target: distance, azimuth counter-clockwise from +x, elevation; radians.
#[derive(Clone, Copy)]
struct Around {
    distance_m: f64,
    azimuth: f64,
    elevation: f64,
}

impl Around {
    fn of(camera: &Camera) -> Around {
        let out = DVec3::from_array(camera.eye_m) - DVec3::from_array(camera.target_m);
        let distance_m = out.length().max(1e-3);
        Around { distance_m, azimuth: out.y.atan2(out.x), elevation: (out.z / distance_m).clamp(-1.0, 1.0).asin() }
    }

    fn eye(self, target_m: [f64; 3]) -> DVec3 {
        let out = DQuat::from_rotation_z(self.azimuth) * DVec3::new(self.elevation.cos(), 0.0, self.elevation.sin());
        DVec3::from_array(target_m) + self.distance_m * out
    }
}

/// Reads everything that concerns the camera.
pub fn understand(clause: &mut Clause, draft: &mut Draft) -> Result<(), Refusal> {
    if clause.take_sense(&Sense::View(View::Auto)) || (clause.has(|s| *s == Sense::Camera) && clause.take_verb(|v| v == Verb::Reset).is_some()) {
        clause.take_sense(&Sense::Camera);
        draft.spec.camera = Auto::Auto;
        draft.gloss.push("the camera places itself".to_owned());
        return Ok(());
    }
    let mut camera = draft.camera();
    let mut around = Around::of(&camera);
    let mut said = Vec::new();
    clause.take_sense(&Sense::Camera);
    clause.take_sense(&Sense::Instead);
    let looks = clause.take_verb(|v| v == Verb::Look).is_some();
    let named = clause.take(|s| match s {
        Sense::Objects(objects) => objects.first().copied(),
        _ => None,
    });
    let object = named.unwrap_or(0);
    if looks && let Some(object) = named {
        let facts = draft.facts(object);
        let middle =
            (DVec3::from_array(facts.low_m) + DVec3::from_array(facts.high_m)) / 2.0 + DVec3::from_array(draft.spec.objects[object].offset_m);
        camera.target_m = say::tidy3(middle);
        said.push(format!("looks at {}", facts.name));
    }
    let turned = views(clause, draft, object, &mut around, &mut said);
    let asked = clause.has(|s| matches!(s, Sense::Measure(..) | Sense::Factor(_)));
    field_of_view(clause, &mut camera, &mut said);
    let before_m = around.distance_m;
    distance(clause, &mut around, &mut said);
    // Nobody who says "from above and closer" wants half of it: a number is what goes nearer than that.
    let least_m = least_distance(draft, &camera, around);
    if !asked && around.distance_m < least_m && (turned || before_m > 1.01 * least_m) {
        around.distance_m = least_m;
        said.retain(|words| !words.ends_with(" away"));
        said.push(format!("is {} away, as near as it holds all that is predicted to move", say::metres(least_m)));
    }
    orbit(clause, draft.duration_s(), &mut camera, &mut around, &mut said);
    step(clause, &mut around, &mut said);
    if said.is_empty() {
        return Err("what about the camera? \"from above\", \"closer\", \"orbit\", \"wider\", \"reset the camera\"".to_owned());
    }
    let mut eye = around.eye(camera.target_m);
    let floor = draft.context.facts.ground_m + 0.02 * around.distance_m;
    if eye.z < floor {
        eye.z = floor;
        said.push("stays over the ground".to_owned());
    }
    camera.eye_m = say::tidy3(eye);
    draft.spec.camera = Auto::Value(camera);
    draft.gloss.push(format!("the camera {}", said.join(", ")));
    Ok(())
}

/// The nearest that a camera which looks from there at its target holds all objects on their predicted ways.
fn least_distance(draft: &Draft, camera: &Camera, around: Around) -> f64 {
    let out = Around { distance_m: 1.0, ..around }.eye([0.0; 3]);
    let right = (-out).cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
    let up = right.cross(-out);
    let [width, height] = draft.spec.output.size.unwrap_or([16, 9]).map(f64::from);
    let half = FILL * (camera.fov_deg.to_radians() / 2.0).tan();
    let target = DVec3::from_array(camera.target_m);
    let needed = |point: DVec3| {
        let p = point - target;
        (p.dot(right).abs() * height / width).max(p.dot(up).abs()) / half + p.dot(out)
    };
    (0..draft.spec.objects.len()).flat_map(|object| corners(draft, object)).map(needed).fold(0.0, f64::max)
}

/// Corners of the boxes around an object where it is farthest out on its predicted way.
fn corners(draft: &Draft, object: usize) -> Vec<DVec3> {
    let facts = draft.facts(object);
    let (low, high) = (DVec3::from_array(facts.low_m), DVec3::from_array(facts.high_m));
    let far_m = FAR_SIZES * (high - low).max_element();
    let way = ballistics::predict(&draft.spec, object, &facts, draft.context.facts.ground_m, draft.duration_s()).points;
    let start = way.first().copied().unwrap_or_default();
    let near = way.into_iter().filter(|shift| (*shift - start).truncate().length() <= far_m);
    let (least, most) = near.fold((start, start), |(least, most), shift| (least.min(shift), most.max(shift)));
    let (low, high) = (low + least, high + most);
    (0..8).map(|k| DVec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] }))).collect()
}

/// "from above", "from the left", "from behind and above". Whether there was a side.
fn views(clause: &mut Clause, draft: &Draft, object: usize, around: &mut Around, said: &mut Vec<String>) -> bool {
    let views = clause.take_all(|s| match s {
        Sense::View(view) => Some(*view),
        _ => None,
    });
    if views.is_empty() || draft.spec.objects.is_empty() {
        return false;
    }
    let frame = draft.frame(object);
    let level: DVec3 = views.iter().filter_map(|v| frame.side(*v)).map(|side| side.with_z(0.0)).sum();
    if let Some(level) = level.try_normalize() {
        around.azimuth = level.y.atan2(level.x);
        around.elevation = SIDE_ELEVATION_DEG.to_radians();
        if views.contains(&View::Above) {
            around.elevation = 45f64.to_radians();
        }
    } else if views.contains(&View::Above) {
        around.elevation = ABOVE_ELEVATION_DEG.to_radians();
    }
    if views.contains(&View::Below) {
        around.elevation = BELOW_ELEVATION_DEG.to_radians();
    }
    let names: Vec<String> = views
        .iter()
        .map(|view| {
            match view {
                View::Front => "in front",
                View::Back => "behind",
                View::Left => "on the left",
                View::Right => "on the right",
                View::Above => "above",
                View::Below | View::Auto => "near the ground",
            }
            .to_owned()
        })
        .collect();
    said.push(format!("stands {}", say::list(&names)));
    true
}

/// "closer", "at 2 m", "zoom out", "twice as far".
fn distance(clause: &mut Clause, around: &mut Around, said: &mut Vec<String>) {
    let before = around.distance_m;
    let zoom = clause.take_verb(|v| matches!(v, Verb::Zoom(_)));
    let scale = clause.take_scale(&[Property::Distance]);
    let length = clause.take_measure(Dimension::Length);
    if length.is_some() {
        clause.take_sense(&Sense::Direction(Direction::Away));
    }
    let sign = match zoom {
        Some(Verb::Zoom(sign)) => -sign,
        _ => scale.map_or(0.0, |s| s.sign),
    };
    let by = |lead: Option<Preposition>| lead == Some(Preposition::By) || (lead.is_none() && sign != 0.0);
    around.distance_m = match (length, scale, zoom) {
        (Some((length, lead)), ..) if by(lead) => before + sign * length,
        (Some((length, _)), ..) => length,
        (None, Some(scale), _) => before * scale.ratio,
        (None, None, Some(_)) => {
            let factor = clause.take(|s| match s {
                Sense::Factor(factor) => Some(*factor),
                _ => None,
            });
            let degrees = clause.take_all(|s| match s {
                Sense::Degree(degree) => Some(*degree),
                _ => None,
            });
            before * factor.unwrap_or_else(|| 1.5f64.powf(degrees.iter().product())).powf(sign)
        }
        (None, None, None) => return,
    };
    around.distance_m = around.distance_m.max(0.05 * before).max(1e-3);
    said.push(format!("is {} away", say::metres(around.distance_m)));
}

/// "wider", "field of view 60 degrees".
fn field_of_view(clause: &mut Clause, camera: &mut Camera, said: &mut Vec<String>) {
    let Some(scale) = clause.take_scale(&[Property::FieldOfView]) else { return };
    // A lens is told by its focal length.
    let lens = |focal_m: f64| 2.0 * (FILM_M / 2.0 / focal_m.max(1e-4)).atan().to_degrees();
    let given = clause
        .take_measure(Dimension::Angle)
        .map(|(a, _)| a.to_degrees())
        .or_else(|| clause.take_measure(Dimension::Length).map(|(l, _)| lens(l)))
        .or_else(|| clause.take_measure(Dimension::Plain).map(|(v, _)| v));
    if given.is_none() && !scale.asked {
        return;
    }
    camera.fov_deg = say::tidy(given.unwrap_or(camera.fov_deg * scale.ratio).clamp(5.0, 120.0));
    said.push(format!("sees {}° from top to bottom", say::short(camera.fov_deg)));
}

/// "orbit", "orbit clockwise at 30 deg/s", "go around it by 90 degrees".
fn orbit(clause: &mut Clause, duration_s: f64, camera: &mut Camera, around: &mut Around, said: &mut Vec<String>) {
    // "rotate the camera around the vase"
    let around_it =
        clause.has(|s| *s == Sense::Preposition(Preposition::Around)) && clause.take_verb(|v| matches!(v, Verb::Turn | Verb::Move)).is_some();
    if clause.take_verb(|v| matches!(v, Verb::Orbit)).is_none() && !around_it {
        return;
    }
    let sign = match clause.take_directions().first() {
        Some(Direction::Clockwise | Direction::Left | Direction::ScreenLeft) => -1.0,
        _ => 1.0,
    };
    if let Some((angle, _)) = clause.take_measure(Dimension::Angle) {
        around.azimuth += sign * angle;
        said.push(format!("goes round by {}°", say::short(sign * angle.to_degrees())));
        return;
    }
    let ratio = clause.take_scale(&[Property::Speed]).map_or(1.0, |s| s.ratio);
    // "orbit once", "twice": in the time that it runs
    let times = clause.take(|s| match s {
        Sense::Factor(times) => Some(360.0 * times / duration_s),
        _ => None,
    });
    let rate = clause.take_measure(Dimension::AngularSpeed).map(|(w, _)| w.to_degrees()).or(times);
    let usual = if camera.orbit_deg_s == 0.0 { ORBIT_DEG_S } else { camera.orbit_deg_s.abs() };
    camera.orbit_deg_s = say::tidy(sign * rate.unwrap_or(usual * ratio));
    said.push(format!("goes round at {}° a second", say::short(camera.orbit_deg_s)));
}

/// "move the camera to the left", "camera up by 20 degrees".
fn step(clause: &mut Clause, around: &mut Around, said: &mut Vec<String>) {
    let verb = clause.take_verb(|v| matches!(v, Verb::Move | Verb::Turn | Verb::Tilt | Verb::Lift));
    let mut directions = clause.take_directions();
    directions.extend(clause.take_scale(&[Property::Height]).map(|s| if s.ratio > 1.0 { Direction::Up } else { Direction::Down }));
    if directions.is_empty() {
        if verb == Some(Verb::Turn)
            && let Some((angle, _)) = clause.take_measure(Dimension::Angle)
        {
            around.azimuth += angle;
            said.push(format!("goes round by {}°", say::short(angle.to_degrees())));
        } else if verb == Some(Verb::Lift) {
            around.elevation = (around.elevation + STEP_DEG.to_radians() / 2.0).min(ABOVE_ELEVATION_DEG.to_radians());
            said.push("stands higher".to_owned());
        }
        return;
    }
    let angle = clause.take_measure(Dimension::Angle).map_or(STEP_DEG.to_radians(), |(a, _)| a);
    for direction in directions {
        let words = match direction {
            // To its own left is clockwise about what it looks at, seen from above.
            Direction::Left | Direction::Sideways | Direction::ScreenLeft | Direction::Clockwise => {
                around.azimuth -= angle;
                "goes to the left"
            }
            Direction::Right | Direction::ScreenRight | Direction::Anticlockwise => {
                around.azimuth += angle;
                "goes to the right"
            }
            Direction::Up => {
                around.elevation = (around.elevation + angle / 1.5).min(ABOVE_ELEVATION_DEG.to_radians());
                "stands higher"
            }
            Direction::Down => {
                around.elevation = (around.elevation - angle / 1.5).max(BELOW_ELEVATION_DEG.to_radians());
                "stands lower"
            }
            Direction::Forward | Direction::Towards => {
                around.distance_m /= 1.5;
                "comes closer"
            }
            Direction::Backward | Direction::Away => {
                around.distance_m *= 1.5;
                "goes further away"
            }
            Direction::Axis(..) => continue,
        };
        said.push(words.to_owned());
    }
}
