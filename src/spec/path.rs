//! Dotted paths into a spec, and names.

use serde_json::Value;

use super::limits;

/// The lists of a spec whose entries are addressed by name.
pub const LISTS: [&str; 6] = ["object", "pin", "collider", "force", "event", "expect"];

/// One step of a path into a spec.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step<'a> {
    /// A key of a table, or a component of a vector.
    Key(&'a str),
    /// A list whose entries have names.
    List(&'a str),
    /// An entry of the list before.
    Entry(&'a str),
}

impl<'a> Step<'a> {
    /// As written.
    pub fn text(self) -> &'a str {
        let (Step::Key(text) | Step::List(text) | Step::Entry(text)) = self;
        text
    }
}

/// The steps of a path. The name of a condition is its whole text, dots included.
pub(super) fn steps(path: &str) -> Vec<Step<'_>> {
    let mut steps: Vec<Step<'_>> = Vec::new();
    let mut rest = Some(path);
    while let Some(text) = rest {
        let conditions = steps == [Step::List("expect")];
        let (word, after) = match text.split_once('.') {
            Some((word, after)) if !conditions => (word, Some(after)),
            _ => (text, None),
        };
        let step = match steps.as_slice() {
            [.., Step::List(_)] => Step::Entry(word),
            [] if LISTS.contains(&word) => Step::List(word),
            [Step::List("object"), Step::Entry(_)] if word == "part" => Step::List(word),
            _ => Step::Key(word),
        };
        steps.push(step);
        rest = after;
    }
    steps
}

/// What the schema says of a name.
pub(super) const NAME_PATTERN: &str = "^[a-z0-9_-]{1,64}$";

/// Whether a text may be a name: `[a-z0-9_-]+`.
pub fn is_name(text: &str) -> bool {
    (1..=limits::NAME).contains(&text.len())
        && text.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_' || byte == b'-')
}

/// The name of an object that was given none: the file's name up to its first dot, in `[a-z0-9_-]`.
pub fn name_from_file(file: &str) -> String {
    if let Some(builtin) = file.strip_prefix("builtin:") {
        return name_from_file(builtin);
    }
    let file = super::file_name::decode(file);
    let file = file.to_string_lossy();
    let last = file.rsplit(['/', '\\']).next().unwrap_or_default();
    let stem = last.split('.').find(|part| !part.is_empty()).unwrap_or_default();
    let tidy = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c.to_ascii_lowercase() } else { '_' };
    let name: String = stem.chars().take(limits::NAME).map(tidy).collect();
    if name.is_empty() { "object".to_owned() } else { name }
}

pub(super) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// The path of an entry of a list: by its name, or by its text if it is a condition; by its place
/// only where it has neither.
pub(super) fn entry(list: &str, index: usize, entry: &Value) -> String {
    match entry_name(entry) {
        Some(name) if !name.is_empty() => format!("{list}.{}", super::error::shorten(name)),
        _ => format!("{list}[{}]", index + 1),
    }
}

/// What an entry is called.
pub(super) fn entry_name(entry: &Value) -> Option<&str> {
    entry.get("name").or_else(|| entry.get("that")).and_then(Value::as_str)
}
