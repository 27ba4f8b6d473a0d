//! Edits: the only way in which a spec changes.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::error::{SpecError, SpecErrorKind, shorten, show};
use super::path::{self, LISTS};
use super::{Spec, canonical::inline, spelling};

/// Tables that hold one of several forms: to set one form is to leave the other.
const CHOICES: [&str; 3] = ["select", "shape", "region"];

/// One change of a spec. Lists are addressed by name: `object.vase.material.young_pa`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "op", rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Replaces the value at a path.
    Set {
        /// Dotted path.
        path: String,
        /// The new value.
        value: serde_json::Value,
    },
    /// Adds an entry with a name to a list.
    Add {
        /// The list: `object`, `pin`, `collider`, `force`, `event` or `expect`.
        path: String,
        /// The entry.
        value: serde_json::Value,
    },
    /// Removes an entry, or sets an optional value back to its default.
    Remove {
        /// Dotted path.
        path: String,
    },
}

impl Spec {
    /// The spec after a list of edits: all of them, or an error and none.
    pub fn apply(&self, edits: &[Edit]) -> Result<Spec, SpecError> {
        let mut root = self.to_value();
        for edit in edits {
            if edit.path().is_empty() {
                return Err(
                    SpecError::new(SpecErrorKind::Syntax, "", "an edit without a path").allowed("a path such as object.vase.material.young_pa")
                );
            }
            match edit {
                Edit::Set { path, value } => set(&mut root, path, value.clone())?,
                Edit::Add { path, value } => add(&mut root, path, value.clone())?,
                Edit::Remove { path } => remove(&mut root, path)?,
            }
        }
        Spec::from_value(root)
    }
}

impl Edit {
    /// Replaces the value at a path.
    pub fn set(path: impl Into<String>, value: impl Into<Value>) -> Edit {
        Edit::Set { path: path.into(), value: value.into() }
    }

    /// Adds an entry to a list.
    pub fn add(path: impl Into<String>, value: impl Into<Value>) -> Edit {
        Edit::Add { path: path.into(), value: value.into() }
    }

    /// Removes an entry, or sets a value back to its default.
    pub fn remove(path: impl Into<String>) -> Edit {
        Edit::Remove { path: path.into() }
    }

    /// Where it acts.
    pub fn path(&self) -> &str {
        match self {
            Edit::Set { path, .. } | Edit::Add { path, .. } | Edit::Remove { path } => path,
        }
    }

    /// Reads `PATH=VALUE`, the value as TOML writes it; a bare word is a text.
    pub fn parse_set(text: &str) -> Result<Edit, SpecError> {
        let (path, value) = text.split_once('=').ok_or_else(|| {
            SpecError::new(SpecErrorKind::Syntax, "", format!("`{}` has no =", shorten(text)))
                .allowed("PATH=VALUE, such as object.vase.material.young_pa=3e4")
        })?;
        let (path, value) = (path.trim(), value.trim());
        if path.is_empty() || value.is_empty() {
            let message = format!("`{}` has no {}", shorten(text), if path.is_empty() { "path" } else { "value" });
            return Err(SpecError::new(SpecErrorKind::Syntax, path, message).allowed("PATH=VALUE, such as object.vase.material.young_pa=3e4"));
        }
        Ok(Edit::set(path, parse_value(path, value)?))
    }
}

impl fmt::Display for Edit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Edit::Set { path, value } => write!(out, "set {path} = {}", inline(value)),
            Edit::Add { path, value } => write!(out, "add {path} {}", inline(value)),
            Edit::Remove { path } => write!(out, "remove {path}"),
        }
    }
}

/// A value in TOML's own syntax, or a bare word.
fn parse_value(path: &str, text: &str) -> Result<Value, SpecError> {
    let quoted = text.starts_with(['"', '\'', '[', '{']);
    match super::read::parse_inline(text) {
        Some(Ok(value)) => Ok(value),
        Some(Err(error)) => Err(SpecError { path: path.into(), ..error }),
        None if quoted => Err(SpecError::new(SpecErrorKind::Syntax, path, format!("{} is not a value", shorten(text)))
            .allowed("a TOML value, such as 3e4, [0, 0, 1] or \"auto\"")),
        None => Ok(Value::String(text.to_owned())),
    }
}

/// Splits a path into the list, the entry's name and the rest; lists are the first key only.
/// The name of a condition is its whole text, dots included.
fn split_list(path: &str) -> Option<(&'static str, Option<&str>, Option<&str>)> {
    let (first, rest) = match path.split_once('.') {
        Some((first, rest)) => (first, Some(rest)),
        None => (path, None),
    };
    let list = LISTS.into_iter().find(|list| *list == first)?;
    match rest {
        None => Some((list, None, None)),
        Some(text) if list == "expect" => Some((list, Some(text), None)),
        Some(rest) => match rest.split_once('.') {
            Some((name, inner)) => Some((list, Some(name), Some(inner))),
            None => Some((list, Some(rest), None)),
        },
    }
}

fn set(root: &mut Value, path: &str, value: Value) -> Result<(), SpecError> {
    let path = spelling::settle_path(path);
    // A preset is a whole material.
    let path = match path.strip_suffix(".preset") {
        Some(front) if front.ends_with(".material") => front,
        _ => &path,
    };
    if let Some((list, name, None)) = split_list(path) {
        let name = name.ok_or_else(|| by_name(list))?;
        *find_entry(root, list, name)? = named(value, list, name);
        return Ok(());
    }
    let (parent, key) = parent_of(root, path)?;
    match parent {
        Value::Array(items) => {
            let index = axis(path, key, items)?;
            items[index] = value;
        }
        Value::Object(table) => {
            if spelling::is_lame(key) {
                table.shift_remove("young_pa");
            }
            table.insert(key.to_owned(), value);
        }
        other => return Err(no_parts(path, key, other)),
    }
    Ok(())
}

fn add(root: &mut Value, path: &str, value: Value) -> Result<(), SpecError> {
    if !LISTS.contains(&path) {
        return Err(SpecError::unknown(path, "list", path, LISTS));
    }
    let list = root.as_object_mut().map(|root| root.entry(path).or_insert_with(|| json!([])));
    if let Some(Value::Array(entries)) = list {
        entries.push(value);
    }
    Ok(())
}

fn remove(root: &mut Value, path: &str) -> Result<(), SpecError> {
    let path = spelling::settle_path(path);
    if let Some((list, name, None)) = split_list(&path) {
        let name = name.ok_or_else(|| by_name(list))?;
        find_entry(root, list, name)?;
        if let Some(entries) = root.get_mut(list).and_then(Value::as_array_mut) {
            entries.retain(|entry| path::entry_name(entry) != Some(name));
        }
        return Ok(());
    }
    let (parent, key) = parent_of(root, &path)?;
    match parent {
        Value::Object(table) if table.contains_key(key) => {
            table.shift_remove(key);
            Ok(())
        }
        Value::Object(table) => Err(SpecError::unknown(front(&path), "key", key, table.keys().map(String::as_str))),
        other => Err(no_parts(&path, key, other)),
    }
}

/// The table or vector that holds the last key of a path.
fn parent_of<'a, 'p>(root: &'a mut Value, path: &'p str) -> Result<(&'a mut Value, &'p str), SpecError> {
    let (mut at, mut walked, rest) = match split_list(path) {
        Some((list, Some(name), Some(rest))) => (find_entry(root, list, name)?, list.len() + 1 + name.len(), rest),
        _ => (root, 0, path),
    };
    let (inner, key) = rest.rsplit_once('.').map_or((None, rest), |(inner, key)| (Some(inner), key));
    for segment in inner.into_iter().flat_map(|inner| inner.split('.')) {
        let place = &path[..walked];
        walked += segment.len() + usize::from(walked > 0);
        let choice = CHOICES.contains(&place.rsplit('.').next().unwrap_or_default());
        if at.get(segment).is_none() {
            return Err(match at.as_object() {
                Some(table) if !choice => SpecError::unknown(place, "key", segment, table.keys().map(String::as_str)),
                _ => no_parts(&path[..walked], segment, at),
            });
        }
        at = &mut at[segment];
    }
    if CHOICES.contains(&front(path).rsplit('.').next().unwrap_or_default()) && at.get(key).is_none() {
        *at = Value::Object(Map::new());
    }
    Ok((at, key))
}

fn find_entry<'a>(root: &'a mut Value, list: &str, name: &str) -> Result<&'a mut Value, SpecError> {
    let entries = root.get_mut(list).and_then(Value::as_array_mut).map(Vec::as_mut_slice).unwrap_or_default();
    match entries.iter().position(|entry| path::entry_name(entry) == Some(name)) {
        Some(index) => Ok(&mut entries[index]),
        None => {
            let what = if list == "expect" { "condition" } else { list };
            Err(SpecError::unknown(list, what, name, entries.iter().filter_map(path::entry_name)))
        }
    }
}

/// An entry that is set as a whole keeps its name unless it brings one.
fn named(mut value: Value, list: &str, name: &str) -> Value {
    if let Some(table) = value.as_object_mut()
        && list != "expect"
        && !table.contains_key("name")
    {
        table.shift_insert(0, "name".to_owned(), json!(name));
    }
    value
}

/// x, y and z of a vector.
fn axis(path: &str, key: &str, items: &[Value]) -> Result<usize, SpecError> {
    let axes = &["x", "y", "z"][..items.len().min(3)];
    axes.iter().position(|axis| *axis == key).ok_or_else(|| SpecError::unknown(front(path), "component", key, axes.iter().copied()))
}

fn front(path: &str) -> &str {
    path.rsplit_once('.').map_or("", |(front, _)| front)
}

fn by_name(list: &str) -> SpecError {
    SpecError::new(SpecErrorKind::Unknown, list, "a list; its entries are addressed by name")
        .allowed(format!("{list}.NAME, or an edit that adds to {list}"))
}

fn no_parts(path: &str, key: &str, value: &Value) -> SpecError {
    let front = front(path);
    let message = format!("has no part `{}`, it is {}", shorten(key), show(value));
    SpecError::new(SpecErrorKind::Unknown, front, message).allowed(format!("to set {front} as a whole"))
}
