//! What is wrong with a spec or an edit, said so that it can be put right.

use std::fmt;

use serde::Serialize;
use serde_json::Value;

/// The kinds of trouble, for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpecErrorKind {
    /// The file cannot be read or written.
    File,
    /// Not TOML or JSON.
    Syntax,
    /// A key, name or word that is not known.
    Unknown,
    /// A value of another type.
    Type,
    /// A value outside its range.
    Range,
    /// Something required is not there.
    Missing,
    /// Two entries of one name, or one value given twice.
    Duplicate,
    /// Values that contradict each other.
    Conflict,
    /// Written for a newer format.
    Newer,
    /// Part of the language of specs, but not built yet.
    NotBuilt,
}

/// One fault of a spec: where, what, what is allowed, and the nearest name where one is near.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error)]
pub struct SpecError {
    /// The kind of trouble.
    pub kind: SpecErrorKind,
    /// Dotted path, entries of lists by name; empty for the whole.
    pub path: Box<str>,
    /// Line of the TOML text, from 1, where it came from one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// What is wrong, the value included.
    pub message: Box<str>,
    /// What is allowed there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub allowed: Option<Box<str>>,
    /// The name that was probably meant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<Box<str>>,
}

impl SpecError {
    /// A fault at a path.
    pub(super) fn new(kind: SpecErrorKind, path: impl fmt::Display, message: impl Into<Box<str>>) -> SpecError {
        SpecError { kind, path: path.to_string().into(), line: None, message: message.into(), allowed: None, nearest: None }
    }

    /// Adds what is allowed.
    pub(super) fn allowed(mut self, allowed: impl Into<Box<str>>) -> SpecError {
        self.allowed = Some(allowed.into());
        self
    }

    /// An unknown word among known ones.
    pub(super) fn unknown<'a>(path: impl fmt::Display, what: &str, word: &str, known: impl IntoIterator<Item = &'a str>) -> SpecError {
        let known: Vec<&str> = known.into_iter().collect();
        let list = if known.is_empty() { "nothing here".to_owned() } else { known.join(", ") };
        let mut error = SpecError::new(SpecErrorKind::Unknown, path, format!("unknown {what} `{}`", shorten(word))).allowed(list);
        error.nearest = nearest(word, known).map(Into::into);
        error
    }
}

impl fmt::Display for SpecError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(out, "line {line}: ")?;
        }
        if !self.path.is_empty() {
            write!(out, "{}: ", self.path)?;
        }
        out.write_str(&self.message)?;
        if let Some(nearest) = &self.nearest {
            write!(out, "; did you mean `{nearest}`?")?;
        }
        if let Some(allowed) = &self.allowed {
            let start = match (self.kind, &self.nearest) {
                (SpecErrorKind::NotBuilt, _) => "; built",
                (_, Some(_)) => " Allowed",
                (_, None) => "; allowed",
            };
            write!(out, "{start}: {allowed}")?;
        }
        Ok(())
    }
}

/// The known name that is most like `word`, if any is near enough to have been meant.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word: String = word.chars().take(64).flat_map(char::to_lowercase).collect();
    let close = |name: &str| {
        let likeness = strsim::normalized_damerau_levenshtein(&word, name);
        // "young" is meant as "young_pa": a unit left out, or a word begun.
        let begun = word.len() >= 3 && (name.starts_with(&word) || word.starts_with(name));
        if begun { likeness.max(0.75) } else { likeness }
    };
    let best = known.into_iter().map(|name| (close(name), name)).fold(None, |best: Option<(f64, &str)>, next| match best {
        Some(best) if best.0 >= next.0 => Some(best),
        _ => Some(next),
    })?;
    (best.0 >= 0.5).then_some(best.1)
}

/// A value as a message shows it: one line, no longer than it is worth.
pub(super) fn show(value: &Value) -> String {
    match value {
        Value::Object(table) if table.len() > 4 => "a table".to_owned(),
        Value::Null => "nothing".to_owned(),
        other => shorten(&super::canonical::inline(other)),
    }
}

/// At most sixty characters, control characters escaped.
pub(super) fn shorten(text: &str) -> String {
    let mut short: String =
        text.chars().take(60).flat_map(|c| if c.is_control() { c.escape_default().collect::<Vec<_>>() } else { vec![c] }).collect();
    if text.chars().count() > 60 {
        short.push('…');
    }
    short
}
