//! What a change means, in plain words.

use serde_json::Value;

use super::diff::{length, ratio, vector};
use super::{Auto, Axis, Change, Material, Spec, presets};

/// Comparatives of a quantity: "half as STIFF", "10 % STIFFER", "10 % SOFTER".
struct Scale {
    key: &'static str,
    as_much: &'static str,
    more: &'static str,
    less: &'static str,
}

const SCALES: &[Scale] = &[
    Scale { key: "young_pa", as_much: "stiff", more: "stiffer", less: "softer" },
    Scale { key: "at_least", as_much: "stiff", more: "stiffer", less: "softer" },
    Scale { key: "density_kg_m3", as_much: "heavy", more: "heavier", less: "lighter" },
    Scale { key: "viscosity_pa_s", as_much: "thick", more: "thicker", less: "thinner" },
    Scale { key: "surface_tension_n_m", as_much: "strong a skin", more: "more surface tension", less: "less surface tension" },
    Scale { key: "yield_stress_pa", as_much: "much force before it yields", more: "more before it yields", less: "less before it yields" },
    Scale { key: "cohesion_pa", as_much: "cohesive", more: "more cohesive", less: "less cohesive" },
    Scale { key: "friction_angle_deg", as_much: "steep a heap", more: "steeper heaps", less: "flatter heaps" },
    Scale { key: "hardening", as_much: "much hardening", more: "more hardening", less: "less hardening" },
    Scale { key: "weaken", as_much: "strong afterwards", more: "stronger afterwards", less: "weaker afterwards" },
    Scale { key: "duration_s", as_much: "long", more: "longer", less: "shorter" },
    Scale { key: "fps", as_much: "many frames", more: "more frames", less: "fewer frames" },
    Scale { key: "cells_across", as_much: "fine", more: "finer", less: "coarser" },
    Scale { key: "substeps_most", as_much: "patient", more: "more patient", less: "less patient" },
    Scale { key: "metres_per_unit", as_much: "big", more: "bigger", less: "smaller" },
    Scale { key: "friction", as_much: "rough", more: "rougher", less: "smoother" },
    Scale { key: "restitution", as_much: "bouncy", more: "bouncier", less: "less bouncy" },
    Scale { key: "fov_deg", as_much: "wide a view", more: "wider view", less: "narrower view" },
    Scale { key: "push_m_s", as_much: "hard", more: "harder", less: "less hard" },
    Scale { key: "acceleration_m_s2", as_much: "strong", more: "stronger", less: "weaker" },
    Scale { key: "drag_per_s", as_much: "much hold", more: "more hold", less: "less hold" },
    Scale { key: "linear_per_s", as_much: "thick", more: "thicker", less: "thinner" },
    Scale { key: "quadratic_per_m", as_much: "thick", more: "thicker", less: "thinner" },
    Scale { key: "strength_m_s2", as_much: "strong", more: "stronger", less: "weaker" },
    Scale { key: "speed_m_s", as_much: "fast", more: "faster", less: "slower" },
    Scale { key: "speed_rad_s", as_much: "fast", more: "faster", less: "slower" },
    Scale { key: "stiffness_per_s2", as_much: "stiff", more: "stiffer", less: "softer" },
    Scale { key: "damping_per_s", as_much: "damped", more: "more damped", less: "less damped" },
    Scale { key: "gust", as_much: "gusty", more: "gustier", less: "steadier" },
    Scale { key: "turbulence", as_much: "rough", more: "rougher", less: "calmer" },
    Scale { key: "velocity_m_s", as_much: "fast", more: "faster", less: "slower" },
    Scale { key: "spin_rad_s", as_much: "fast a spin", more: "faster spin", less: "slower spin" },
    Scale { key: "neighbours", as_much: "many neighbours", more: "more neighbours", less: "fewer neighbours" },
];

/// A few plain words for a change, where there are any.
pub(super) fn gloss(change: &Change, from: &Spec, to: &Spec) -> Option<String> {
    match (&change.from, &change.to) {
        (None, Some(entry)) => added(change, entry, to),
        (Some(_), None) => None,
        (Some(before), Some(after)) => special(change, before, after, from, to).or_else(|| scaled(change.path.rsplit('.').next()?, before, after)),
        (None, None) => None,
    }
}

/// Quantities that only grow or shrink.
fn scaled(key: &str, before: &Value, after: &Value) -> Option<String> {
    let scale = SCALES.iter().find(|scale| scale.key == key)?;
    let (zero_before, zero_after) = (size(before) == Some(0.0), size(after) == Some(0.0));
    match ratio(before, after) {
        // "Not strong a skin at all" is no English.
        _ if zero_after && scale.as_much.contains(' ') => Some("none at all".to_owned()),
        _ if zero_after => Some(format!("not {} at all", scale.as_much)),
        _ if zero_before => None,
        Some(ratio) if ratio < 0.0 => Some(match compared(-ratio, scale) {
            Some(words) => format!("the other way, {words}"),
            None => "the other way".to_owned(),
        }),
        Some(ratio) => compared(ratio, scale),
        None => None,
    }
}

fn compared(ratio: f64, scale: &Scale) -> Option<String> {
    let percent = ((ratio - 1.0).abs() * 100.0).round();
    if percent == 0.0 {
        None
    } else if (0.8..=1.25).contains(&ratio) {
        Some(format!("{percent} % {}", if ratio > 1.0 { scale.more } else { scale.less }))
    } else {
        Some(format!("{} as {}", times(ratio), scale.as_much))
    }
}

fn special(change: &Change, before: &Value, after: &Value, from: &Spec, to: &Spec) -> Option<String> {
    let key = change.path.rsplit('.').next()?;
    let auto = (before == "auto", after == "auto");
    let words = match (key, auto) {
        ("young_pa", (_, true)) => "stiffness chosen by the program".to_owned(),
        ("young_pa", _) if after.is_object() => "firmer where its weight asks for it".to_owned(),
        ("young_pa", (true, _)) => "stiffness given".to_owned(),
        ("young_pa", _) if before.is_object() => "stiffness given, also where its weight asks for more".to_owned(),
        ("duration_s", (_, true)) => "until it has settled".to_owned(),
        ("duration_s", (true, _)) => "length given".to_owned(),
        ("camera", (_, true)) => "the camera places itself".to_owned(),
        ("camera", (true, _)) => "seen from a place of its own".to_owned(),
        ("gravity_m_s2", _) => gravity(before, after)?,
        ("offset_m", _) => moved(before, after, forward(change, to))?,
        ("velocity_m_s", _) if size(after) == Some(0.0) => "starts at rest".to_owned(),
        ("velocity_m_s" | "push_m_s", _) if ratio(before, after).is_none() => going(after, forward(change, to))?,
        ("spin_rad_s", _) if size(after) == Some(0.0) => "does not spin".to_owned(),
        ("height_m", (false, false)) => {
            let rise = after.as_f64()? - before.as_f64()?;
            format!("{} m {}", short(rise.abs()), if rise > 0.0 { "higher" } else { "lower" })
        }
        ("poisson", _) => if after.as_f64()? > before.as_f64()? { "keeps its volume more" } else { "gives way in volume more" }.to_owned(),
        ("at_s", _) => if after.as_f64()? > before.as_f64()? { "later" } else { "earlier" }.to_owned(),
        ("orbit_deg_s", _) => if after.as_f64()? == 0.0 { "the camera stands still" } else { "the camera goes round" }.to_owned(),
        ("eye_m", _) => nearer(from, to)?,
        ("material", _) => format!("becomes {}", stuff(after)?),
        ("solver", _) => if after == "sph" { "solved by particles" } else { "solved on the grid" }.to_owned(),
        ("when", _) => "on impact".to_owned(),
        ("rest", _) => if after == "stress_free" { "the captured pose is free of stress" } else { "it stands as captured" }.to_owned(),
        ("seed", _) => "another sample of the same".to_owned(),
        _ => return None,
    };
    Some(words)
}

/// An entry that was not there before.
fn added(change: &Change, entry: &Value, to: &Spec) -> Option<String> {
    let forward = forward(change, to);
    let vector = |key: &str| entry.get(key);
    if change.path.starts_with("event.") {
        return happening(entry, forward);
    }
    if let Some(acceleration) = vector("acceleration_m_s2") {
        return Some(match acceleration.as_str() {
            Some(_) => "driven by an expression".to_owned(),
            None => format!("drawn {}", towards(acceleration, forward)?),
        });
    }
    if change.path.starts_with("force.") {
        return field(entry, forward);
    }
    // A part, or a material where there was none.
    match change.path.rsplit('.').next() {
        Some("material") => Some(format!("becomes {}", stuff(entry)?)),
        _ => Some(format!("of {}", stuff(vector("material")?)?)),
    }
}

/// What an event does, and when.
fn happening(event: &Value, forward: Axis) -> Option<String> {
    let when = match event.get("at_s").and_then(Value::as_f64) {
        Some(at_s) => format!("at {} s", short(at_s)),
        None => "on impact".to_owned(),
    };
    let what = if let Some(push) = event.get("push_m_s") {
        format!("pushed {}", going(push, forward)?)
    } else if let Some(velocity) = event.get("velocity_m_s") {
        going(velocity, forward).map_or("stopped".to_owned(), |way| format!("sent {way}"))
    } else if let Some(material) = event.get("material") {
        format!("becomes {}", stuff(material)?)
    } else if let Some(share) = event.get("weaken").and_then(Value::as_f64) {
        format!("{} as strong", times(share))
    } else if event.get("freeze").is_some() {
        "freezes".to_owned()
    } else {
        "let go".to_owned()
    };
    Some(format!("{what} {when}"))
}

/// A material by its preset's name, else by its kind.
fn stuff(material: &Value) -> Option<String> {
    let known: Material = serde_json::from_value(material.clone()).ok()?;
    let preset = presets::MATERIALS.iter().find(|preset| preset.material == known).map(|preset| preset.name);
    Some(preset.unwrap_or(known.kind()).to_owned())
}

/// A force that is a field.
fn field(entry: &Value, forward: Axis) -> Option<String> {
    let number = |field: &Value, key: &str| field.get(key).and_then(Value::as_f64);
    if let Some(wind) = entry.get("wind") {
        return Some(format!("blown {}", going(wind.get("velocity_m_s")?, forward)?));
    }
    if let Some(drag) = entry.get("drag") {
        let thick = number(drag, "linear_per_s").unwrap_or(0.0) + number(drag, "quadratic_per_m").unwrap_or(0.0);
        return Some(format!("slowed by what it moves through, {}", short(thick)));
    }
    if let Some(vortex) = entry.get("vortex") {
        return Some(format!("swirled round at {} m/s", short(number(vortex, "speed_m_s")?)));
    }
    if let Some(attractor) = entry.get("attractor") {
        let strength = number(attractor, "strength_m_s2")?;
        let way = if strength < 0.0 { "pushed away from" } else { "drawn to" };
        return Some(format!("{way} a point with {} m/s²", short(strength.abs())));
    }
    if entry.get("explosion").is_some() {
        return Some(format!("blown apart at {} s", short(number(entry, "from_s").unwrap_or(0.0))));
    }
    if let Some(spring) = entry.get("spring") {
        let along = spring.get("path_m").is_some();
        return Some(format!("drawn {} by a spring", if along { "along a path" } else { "to a place" }));
    }
    entry.get("motor").and_then(|motor| Some(format!("turned at {} rad/s", short(number(motor, "speed_rad_s")?))))
}

/// "moon gravity, a sixth".
fn gravity(before: &Value, after: &Value) -> Option<String> {
    let strength = size(after)?;
    if strength == 0.0 {
        return Some("no gravity".to_owned());
    }
    let downward = vector(after)?.get(2).is_some_and(|z| (z + strength).abs() < 1e-9 * strength);
    let place = presets::GRAVITY.iter().find(|preset| downward && (preset.m_s2 - strength).abs() < 5e-3);
    let share = ratio(before, after).filter(|ratio| *ratio > 0.0).map(times);
    match (place, share) {
        (Some(place), Some(share)) => Some(format!("{} gravity, {share}", place.name)),
        (Some(place), None) => Some(format!("{} gravity", place.name)),
        (None, Some(share)) => Some(format!("{share} the gravity")),
        (None, None) => Some("gravity points elsewhere".to_owned()),
    }
}

/// "0.5 m higher".
fn moved(before: &Value, after: &Value, forward: Axis) -> Option<String> {
    let difference: Vec<f64> = vector(after)?.iter().zip(vector(before)?).map(|(after, before)| after - before).collect();
    let words = match towards(&Value::from(difference.clone()), forward)?.as_str() {
        "up" => "higher".to_owned(),
        "down" => "lower".to_owned(),
        words => format!("further {words}"),
    };
    Some(format!("starts {} m {words}", short(length(&difference))))
}

/// "up at 3 m/s".
fn going(velocity: &Value, forward: Axis) -> Option<String> {
    Some(format!("{} at {} m/s", towards(velocity, forward)?, short(size(velocity)?)))
}

/// The main directions of a vector, seen by an object: forward, back, left, right, up, down.
fn towards(value: &Value, forward: Axis) -> Option<String> {
    let v = vector(value).filter(|v| v.len() == 3)?;
    let total = length(&v);
    if total == 0.0 {
        return None;
    }
    let front = match forward {
        Axis::MinusX => [-1.0, 0.0],
        Axis::PlusY => [0.0, 1.0],
        Axis::MinusY => [0.0, -1.0],
        Axis::PlusX | Axis::PlusZ | Axis::MinusZ => [1.0, 0.0],
    };
    let parts = [
        (v[0] * front[0] + v[1] * front[1], "forward", "back"),
        (v[1] * front[0] - v[0] * front[1], "to the left", "to the right"),
        (v[2], "up", "down"),
    ];
    // A third of the length is 20 degrees off an axis: less than that goes without saying.
    let words: Vec<&str> =
        parts.iter().filter(|(part, ..)| part.abs() > total / 3.0).map(|(part, ahead, behind)| if *part > 0.0 { *ahead } else { *behind }).collect();
    Some(words.join(" and "))
}

/// Which way the object of a change faces.
fn forward(change: &Change, to: &Spec) -> Axis {
    let named = |name: &str| to.objects.iter().find(|object| object.name == name).map(|object| object.forward);
    let entry = change.to.as_ref().and_then(|entry| entry.get("object")).and_then(Value::as_str);
    let event =
        change.path.strip_prefix("event.").and_then(|rest| rest.split('.').next()).and_then(|name| to.events.iter().find(|event| event.name == name));
    let object = change.path.strip_prefix("object.").and_then(|rest| rest.split('.').next());
    entry.or(event.map(|event| event.object.as_str())).or(object).and_then(named).unwrap_or(Axis::PlusX)
}

/// The camera's way to its target, before and after.
fn nearer(from: &Spec, to: &Spec) -> Option<String> {
    let distance = |spec: &Spec| match &spec.camera {
        Auto::Value(camera) => Some(length(&[0, 1, 2].map(|axis| camera.eye_m[axis] - camera.target_m[axis]))),
        Auto::Auto => None,
    };
    let ratio = distance(to)? / distance(from)?;
    let words = match ratio {
        ratio if ratio < 0.98 => "the camera comes closer",
        ratio if ratio > 1.02 => "the camera steps back",
        _ => "the camera goes round",
    };
    Some(words.to_owned())
}

/// A number, or a vector's length.
fn size(value: &Value) -> Option<f64> {
    value.as_f64().map(f64::abs).or_else(|| vector(value).map(|vector| length(&vector)))
}

/// A ratio in words: "half", "a sixth", "twice", "3 times", "0.38 times".
pub(super) fn times(ratio: f64) -> String {
    const FRACTIONS: [&str; 9] = ["half", "a third", "a quarter", "a fifth", "a sixth", "a seventh", "an eighth", "a ninth", "a tenth"];
    let inverse = 1.0 / ratio;
    let near = |value: f64| (value / value.round() - 1.0).abs() < 0.02;
    if (1.9..10.5).contains(&inverse) && near(inverse) {
        FRACTIONS[inverse.round() as usize - 2].to_owned()
    } else if near(ratio) && ratio.round() == 2.0 {
        "twice".to_owned()
    } else if ratio > 2.5 && near(ratio) {
        format!("{} times", ratio.round())
    } else {
        format!("{} times", short(ratio))
    }
}

/// Two digits that count.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (1.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
