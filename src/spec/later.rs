//! What the language of specs has room for and this version does not do. It is refused by name, so
//! that nobody takes it for a misspelling.

use serde_json::Value;

use super::error::{SpecError, SpecErrorKind};

/// Everything to come, with the words that are refused for it.
pub(super) fn all() -> impl Iterator<Item = (&'static str, String)> {
    let said = |place: &str, name: &str| if place.is_empty() { name.to_owned() } else { format!("{place}.{name}") };
    KEYS.iter().chain(WORDS).map(move |(place, name, what)| (*what, said(place, name)))
}

/// Keys to come: where, which, what they mean.
const KEYS: &[(&str, &str, &str)] = &[("", "look", "looks that change over time"), ("event", "shatter", "shattering")];

/// Words to come: where, which, what they mean.
const WORDS: &[(&str, &str, &str)] = &[
    ("object.select", "segment", "selecting a segment"),
    ("object.select", "union", "combining selections"),
    ("object.select", "all_of", "combining selections"),
    ("object.select", "any_of", "combining selections"),
    ("object.select", "not", "combining selections"),
    ("collider.shape", "scene", "colliders made from the scene"),
];

/// What a key that is not known here will once mean.
pub(super) fn key(pattern: &str, key: &str) -> Option<&'static str> {
    KEYS.iter().find(|(place, name, _)| *place == pattern && *name == key).map(|(.., what)| *what)
}

/// What a word that is not known here will once mean.
pub(super) fn word(pattern: &str, word: &str) -> Option<&'static str> {
    WORDS.iter().find(|(place, name, _)| *place == pattern && *name == word).map(|(.., what)| *what)
}

/// What a form that is not known here will once mean.
pub(super) fn value(pattern: &str, value: &Value) -> Option<&'static str> {
    match (pattern, value) {
        ("object.select", Value::Array(_)) => Some("combining selections"),
        ("object.select", Value::Object(table)) if table.len() > 1 => Some("combining selections"),
        _ => None,
    }
}

/// The refusal.
pub(super) fn error(path: &str, what: &str, built: &str) -> SpecError {
    let error = SpecError::new(SpecErrorKind::NotBuilt, path, format!("not built yet: {what}"));
    if built.is_empty() { error } else { error.allowed(built) }
}
