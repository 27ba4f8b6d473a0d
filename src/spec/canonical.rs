//! The canonical form of a spec: complete, in the order of the types, `"auto"` as written, floats
//! in their fewest digits. Equal specs have equal text, and the text reads back as the same spec.

use std::fmt::Write as _;

use serde_json::{Map, Value};

use super::Spec;

impl Spec {
    /// The spec as a JSON value, every field present.
    pub fn to_value(&self) -> Value {
        // Nothing in a spec fails to serialise; numbers that are not finite become null.
        serde_json::to_value(self).unwrap_or_default()
    }

    /// The canonical TOML text.
    pub fn to_toml(&self) -> String {
        document(&self.to_value())
    }

    /// BLAKE3 of the canonical form, in hex. Where the scene's own hash is recorded, the path by
    /// which it was found does not count: a spec stays itself when it moves with its scene.
    pub fn hash(&self) -> String {
        let mut value = self.to_value();
        if let Some(scene) = value.get_mut("scene").and_then(Value::as_object_mut)
            && scene.contains_key("blake3")
        {
            scene.shift_remove("file");
        }
        blake3::hash(document(&value).as_bytes()).to_hex().to_string()
    }
}

impl Spec {
    /// One part of a spec as TOML, by its path; entries of lists by name. None where there is no such part.
    pub fn part_to_toml(&self, path: &str) -> Option<String> {
        let mut value = &self.to_value();
        for key in path.split('.') {
            value = match value {
                Value::Array(entries) => entries.iter().find(|e| e["name"] == key)?,
                other => other.get(key)?,
            };
        }
        let mut out = String::new();
        match value {
            Value::Object(_) => section(&mut out, &format!("[{path}]"), path, value),
            Value::Array(entries) if is_section(value) => entries.iter().for_each(|entry| section(&mut out, &format!("[[{path}]]"), path, entry)),
            plain => {
                let _ = writeln!(out, "{path} = {}", inline(plain));
            }
        }
        Some(out.trim().to_owned())
    }
}

/// A whole document: numbers first, then a section for each table and each entry of a list.
fn document(root: &Value) -> String {
    let empty = Map::new();
    let root = root.as_object().unwrap_or(&empty);
    let mut out = String::new();
    for (key, value) in root.iter().filter(|(_, value)| !is_section(value)) {
        assign(&mut out, key, value);
    }
    for (key, value) in root.iter().filter(|(_, value)| is_section(value)) {
        match value {
            Value::Array(entries) => entries.iter().for_each(|entry| section(&mut out, &format!("[[{key}]]"), key, entry)),
            table => section(&mut out, &format!("[{key}]"), key, table),
        }
    }
    out
}

/// Tables and lists of tables get a section of their own.
fn is_section(value: &Value) -> bool {
    match value {
        Value::Object(_) => true,
        Value::Array(entries) => entries.iter().any(Value::is_object),
        _ => false,
    }
}

/// A table's own values on lines of their own, then the lists of tables in it.
fn section(out: &mut String, head: &str, path: &str, table: &Value) {
    let _ = write!(out, "\n{head}\n");
    let lists = |value: &Value| !value.is_object() && is_section(value);
    let pairs = || table.as_object().into_iter().flatten();
    for (key, value) in pairs().filter(|(_, value)| !lists(value)) {
        assign(out, key, value);
    }
    for (key, list) in pairs().filter(|(_, value)| lists(value)) {
        let path = format!("{path}.{key}");
        list.as_array().into_iter().flatten().for_each(|entry| section(out, &format!("[[{path}]]"), &path, entry));
    }
}

fn assign(out: &mut String, key: &str, value: &Value) {
    let _ = writeln!(out, "{} = {}", self::key(key), inline(value));
}

/// A value on one line of TOML.
pub(super) fn inline(value: &Value) -> String {
    match value {
        Value::Null => "nan".to_owned(),
        Value::Bool(truth) => truth.to_string(),
        Value::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => whole.to_string(),
            (None, Some(float)) => self::number(float),
            (None, None) => number.to_string(),
        },
        Value::String(text) => quote(text),
        Value::Array(items) => format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Object(table) if table.is_empty() => "{}".to_owned(),
        Value::Object(table) => {
            let pairs: Vec<String> = table.iter().map(|(key, value)| format!("{} = {}", self::key(key), inline(value))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
    }
}

/// The fewest digits that read back as the same f64, with a power of ten where that is shorter
/// and the number is not an everyday one; whole numbers without a point. Minus zero is zero.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let (plain, power) = (format!("{value}"), format!("{value:e}"));
    let everyday = (1e-3..1e4).contains(&value.abs());
    if everyday || plain.len() <= power.len() { plain } else { power }
}

/// A bare key where TOML allows one.
fn key(text: &str) -> String {
    let bare = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-');
    if bare { text.to_owned() } else { quote(text) }
}

/// A basic TOML string.
fn quote(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c if c.is_control() => {
                let _ = write!(out, "\\U{:08X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
