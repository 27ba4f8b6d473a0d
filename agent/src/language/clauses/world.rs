//! Worlds, ground and time: gravity, friction, how long it runs.

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::numbers::Dimension;
use super::super::say;
use super::super::sense::{Direction, Sense, Verb};
use glam::DVec3;
use phystalk::spec::{Auto, presets};

/// Places and surfaces: "on the moon", "on ice", "2 g", "no gravity".
pub fn understand(clause: &mut Clause, draft: &mut Draft) {
    let gravity = clause.take(|s| match s {
        Sense::Gravity(strength) => Some(*strength),
        _ => None,
    });
    if let Some(strength) = gravity {
        set_gravity(draft, strength);
    }
    // "at 2 g" with no verb that pulls
    let pulled = clause.has(|s| matches!(s, Sense::Verb(Verb::Pull | Verb::Push(_) | Verb::Blow)));
    if !pulled
        && !clause.has(|s| matches!(s, Sense::Property(_)))
        && let Some((strength, _)) = clause.take_measure(Dimension::Acceleration)
    {
        set_gravity(draft, strength.abs());
    }
    let springy = clause.take(|s| match s {
        Sense::Springy(restitution) => Some(*restitution),
        _ => None,
    });
    if let Some(restitution) = springy {
        super::adjust::set_restitution(draft, restitution);
    }
    let surface = clause.take(|s| match s {
        Sense::Surface(friction) => Some(*friction),
        _ => None,
    });
    if surface.is_some() || springy.is_some() {
        clause.take_sense(&Sense::Ground);
    }
    if let Some(friction) = surface {
        set_all_friction(draft, friction);
    }
    picture(clause, draft);
}

/// The picture's background and size, and the random numbers.
fn picture(clause: &mut Clause, draft: &mut Draft) {
    if let Some(colour) = clause.take(|s| if let Sense::Backdrop(colour) = s { Some(*colour) } else { None }) {
        draft.spec.output.background = colour.to_owned();
        draft.gloss.push(format!("the background is {colour}"));
    }
    if let Some([width, height]) = clause.take(|s| if let Sense::PictureSize(size) = s { Some(*size) } else { None }) {
        draft.spec.output.size = Auto::Value([width, height]);
        draft.gloss.push(format!("pictures of {width} × {height}"));
    }
    if clause.take_sense(&Sense::Reseed) {
        draft.spec.seed = (draft.spec.seed + 1).min(phystalk::spec::limits::SEED);
        draft.gloss.push(format!("seed {}", draft.spec.seed));
    }
}

/// Sets how strong free fall is; its direction stays, downwards where there was none.
pub fn set_gravity(draft: &mut Draft, strength_m_s2: f64) {
    let before = DVec3::from_array(draft.spec.world.gravity_m_s2);
    let direction = before.try_normalize().unwrap_or(-DVec3::Z);
    draft.spec.world.gravity_m_s2 = say::tidy3(direction * strength_m_s2);
    let place = presets::GRAVITY.iter().find(|p| (p.m_s2 - strength_m_s2).abs() < 1e-9 && p.name != "zero").map(|p| match p.name {
        "moon" => ", as on the moon".to_owned(),
        name => format!(", as on {}{}", name[..1].to_uppercase(), &name[1..]),
    });
    let line = match strength_m_s2 {
        0.0 => "no gravity".to_owned(),
        strength => format!("gravity {}{}", say::acceleration(strength), place.unwrap_or_default()),
    };
    draft.gloss.push(line);
}

/// "reverse the gravity", "gravity to the left": where it points. Whether the clause asked for that.
pub fn turn_gravity(clause: &mut Clause, draft: &mut Draft) -> bool {
    let gravity = Sense::Property(super::super::sense::Property::Gravity);
    if !clause.has(|s| *s == gravity) || !clause.has(|s| matches!(s, Sense::Direction(_))) || draft.spec.objects.is_empty() {
        return false;
    }
    let directions: Vec<Direction> = clause.take_directions();
    let Some(heading) = draft.frame(0).heading(&directions) else { return false };
    clause.take_sense(&gravity);
    let strength = clause.take_measure(Dimension::Acceleration).map_or(draft.gravity_for_heights_m_s2(), |(a, _)| a);
    draft.spec.world.gravity_m_s2 = say::tidy3(heading.unit * strength);
    draft.gloss.push(format!("gravity points {}: {}", heading.said, say::acceleration(strength)));
    true
}

/// One friction for the ground and every collider: nobody knows which of them "ice" means.
pub fn set_all_friction(draft: &mut Draft, friction: f64) {
    let friction = say::tidy(friction.max(0.0));
    draft.spec.world.ground.friction = friction;
    for collider in &mut draft.spec.colliders {
        collider.friction = friction;
    }
    let others = if draft.spec.colliders.is_empty() { "" } else { " and of what stands on it" };
    draft.gloss.push(format!("friction of the ground{others}: {}", say::short(friction)));
}

/// How long it runs.
pub fn set_duration(draft: &mut Draft, seconds: f64) -> Result<(), Refusal> {
    if !(seconds > 0.0 && seconds <= 600.0) {
        return Err("how long it runs is more than 0 s and up to 600 s: \"for 3 seconds\"".to_owned());
    }
    draft.spec.time.duration_s = Auto::Value(say::tidy(seconds));
    draft.gloss.push(format!("it lasts {}", say::seconds(seconds)));
    Ok(())
}

/// "for 3 seconds", "simulate until 5 s", "run it for a minute", whatever verb took no time of its own.
pub fn time(clause: &mut Clause, draft: &mut Draft) -> Result<bool, Refusal> {
    let runs = clause.take_verb(|v| v == Verb::Run).is_some();
    let until = clause.take_for().or_else(|| clause.take_until());
    let length = if runs { until.or_else(|| clause.take_measure(Dimension::Time).map(|(t, _)| t)) } else { until };
    match length {
        Some(length) => set_duration(draft, length).map(|()| true),
        None => Ok(false),
    }
}

/// Sets the world that a clause speaks of before any clause is read, without a word: the clause itself says it.
pub fn ahead(clause: &Clause, draft: &mut Draft) {
    for phrase in clause.phrases() {
        if let Sense::Gravity(strength) = phrase.sense {
            let spoken = draft.gloss.len();
            set_gravity(draft, strength);
            draft.gloss.truncate(spoken);
        }
    }
}
