//! What the language of specs has room for and this version does not do. It is refused by name, so
//! that nobody takes it for a misspelling.

use serde_json::Value;

use super::error::{SpecError, SpecErrorKind};

/// Kinds of material to come, and the presets and parameters that belong to them.
const MATERIALS: &[(&str, &[&str])] = &[
    ("rigid bodies", &["rigid", "wood", "steel", "stone", "glass"]),
    ("muscles", &["muscle", "activation", "fibre"]),
    ("plastic materials", &["plastic", "dough", "clay", "yield_stress_pa", "hardening_pa"]),
    ("viscoplastic materials", &["viscoplastic", "mud", "jam"]),
    ("sand", &["sand", "dry_soil", "friction_angle_deg", "cohesion_pa"]),
    ("snow", &["snow", "theta_c", "theta_s", "hardening"]),
    ("liquids", &["liquid", "water", "honey", "lava", "viscosity_pa_s", "surface_tension_n_m", "solver", "gamma", "stiffness", "exponent"]),
];

/// Everything to come, with the words that are refused for it.
pub(super) fn all() -> impl Iterator<Item = (&'static str, String)> {
    let materials = MATERIALS.iter().map(|(what, words)| (*what, words.join(", ")));
    materials.chain(
        KEYS.iter().chain(WORDS).map(|(place, name, what)| (*what, if place.is_empty() { (*name).to_owned() } else { format!("{place}.{name}") })),
    )
}

/// Keys to come: where, which, what they mean.
const KEYS: &[(&str, &str, &str)] = &[
    ("", "look", "looks that change over time"),
    ("object", "part", "parts of another material in one object"),
    ("event", "when", "events that wait for a condition"),
    ("event", "shatter", "shattering"),
    ("event", "freeze", "freezing"),
    ("event", "release", "releasing"),
    ("event", "material", "a change of material at an instant"),
    ("object.material", "friction", "friction of a body of its own"),
    ("object.material", "restitution", "restitution of a body of its own"),
];

/// Words to come: where, which, what they mean.
const WORDS: &[(&str, &str, &str)] = &[
    ("object.select", "segment", "selecting a segment"),
    ("object.select", "ids", "selecting by ids"),
    ("object.select", "union", "combining selections"),
    ("object.select", "all_of", "combining selections"),
    ("object.select", "any_of", "combining selections"),
    ("object.select", "not", "combining selections"),
    ("collider.shape", "scene", "colliders made from the scene"),
    ("collider.shape", "capsule", "capsule colliders"),
];

/// What a key that is not known here will once mean.
pub(super) fn key(pattern: &str, key: &str) -> Option<&'static str> {
    let named = KEYS.iter().find(|(place, name, _)| *place == pattern && *name == key).map(|(.., what)| *what);
    named.or_else(|| if pattern == "object.material" { material(key) } else { None })
}

/// What a word that is not known here will once mean.
pub(super) fn word(pattern: &str, word: &str) -> Option<&'static str> {
    let named = WORDS.iter().find(|(place, name, _)| *place == pattern && *name == word).map(|(.., what)| *what);
    named.or_else(|| if matches!(pattern, "object.material.kind" | "object.material") { material(word) } else { None })
}

/// What a form that is not known here will once mean.
pub(super) fn value(pattern: &str, value: &Value) -> Option<&'static str> {
    match (pattern, value) {
        ("object.select", Value::Array(items)) if items.iter().all(Value::is_number) => Some("selecting by ids"),
        ("object.select", Value::Array(_)) => Some("combining selections"),
        ("object.select", Value::Object(table)) if table.len() > 1 => Some("combining selections"),
        _ => None,
    }
}

/// The family of materials to come that a kind, a preset or a parameter belongs to: "water" is
/// one of the liquids.
pub fn material(word: &str) -> Option<&'static str> {
    MATERIALS.iter().find(|(_, words)| words.contains(&word)).map(|(what, _)| *what)
}

/// The refusal.
pub(super) fn error(path: &str, what: &str, built: &str) -> SpecError {
    let error = SpecError::new(SpecErrorKind::NotBuilt, path, format!("not built yet: {what}"));
    if built.is_empty() { error } else { error.allowed(built) }
}
