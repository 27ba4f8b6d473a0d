//! Edits: the only way in which a spec changes.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::error::{SpecError, SpecErrorKind, shorten, show};
use super::path::{self, LISTS, Step};
use super::{Spec, aliases, canonical::inline};

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
        /// The list: `object`, `pin`, `collider`, `force`, `event` or `expect`, or `object.NAME.part`.
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
        self.apply_noted(edits, &mut Vec::new())
    }

    /// As [`Spec::apply`]; `notes` gets a sentence for each value that was converted from another program's.
    pub fn apply_noted(&self, edits: &[Edit], notes: &mut Vec<String>) -> Result<Spec, SpecError> {
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
        Spec::from_value_noted(root, notes)
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

fn set(root: &mut Value, path: &str, value: Value) -> Result<(), SpecError> {
    // A preset is a whole material.
    let path = match path.strip_suffix(".preset") {
        Some(front) if is_material(front) => front,
        _ => path,
    };
    let steps = path::steps(path);
    let (last, front) = split_last(&steps, path)?;
    match last {
        Step::List(_) => return Err(by_name(path)),
        Step::Entry(name) => {
            let list = front[front.len() - 1].text();
            *entry(root, front, name)? = named(value, list, name);
            return Ok(());
        }
        Step::Key(_) => {}
    }
    let (parent, key) = (parent_of(root, front, last.text())?, last.text());
    match parent {
        Value::Array(items) => {
            let index = axis(path, key, items)?;
            items[index] = value;
        }
        Value::Object(table) => {
            if is_material(self::front(path)) {
                set_parameter(table, key, &value);
            }
            table.insert(key.to_owned(), value);
        }
        other => return Err(no_parts(path, key, other)),
    }
    Ok(())
}

fn is_material(path: &str) -> bool {
    path.ends_with(".material")
}

/// Makes room for a parameter: a new kind keeps what it shares with the old one, and a value under
/// another program's name replaces ours.
fn set_parameter(table: &mut Map<String, Value>, key: &str, value: &Value) {
    let kind = table.get("kind").and_then(Value::as_str).unwrap_or_default().to_owned();
    match (key, value.as_str()) {
        ("kind", Some(next)) if next != kind => aliases::switch_kind(table, next),
        _ => aliases::stands_for(&kind, key).iter().for_each(|ours| {
            table.shift_remove(*ours);
        }),
    }
}

fn add(root: &mut Value, path: &str, value: Value) -> Result<(), SpecError> {
    let steps = path::steps(path);
    match steps.split_last() {
        Some((Step::List(_), _)) => {
            if let Value::Array(entries) = descend(root, &steps)? {
                entries.push(value);
            }
            Ok(())
        }
        _ => Err(SpecError::unknown(path, "list", path, LISTS)),
    }
}

fn remove(root: &mut Value, path: &str) -> Result<(), SpecError> {
    let steps = path::steps(path);
    let (last, before) = split_last(&steps, path)?;
    match last {
        Step::List(_) => return Err(by_name(path)),
        Step::Entry(name) => {
            entry(root, before, name)?;
            if let Value::Array(entries) = descend(root, before)? {
                entries.retain(|entry| path::entry_name(entry) != Some(name));
            }
            return Ok(());
        }
        Step::Key(_) => {}
    }
    let key = last.text();
    match parent_of(root, before, key)? {
        Value::Object(table) => {
            let kind = table.get("kind").and_then(Value::as_str).unwrap_or_default();
            let ours = if is_material(front(path)) { aliases::stands_for(kind, key).first() } else { None };
            let key = ours.copied().unwrap_or(key);
            match table.shift_remove(key) {
                Some(_) => Ok(()),
                None => Err(SpecError::unknown(front(path), "key", key, table.keys().map(String::as_str))),
            }
        }
        other => Err(no_parts(path, key, other)),
    }
}

fn split_last<'a, 'p>(steps: &'a [Step<'p>], path: &str) -> Result<(Step<'p>, &'a [Step<'p>]), SpecError> {
    let (last, front) = steps.split_last().ok_or_else(|| SpecError::new(SpecErrorKind::Syntax, path, "an edit without a path"))?;
    Ok((*last, front))
}

/// The path of some steps.
fn written(steps: &[Step]) -> String {
    steps.iter().map(|step| step.text()).collect::<Vec<_>>().join(".")
}

/// What stands at the end of some steps.
fn descend<'a>(root: &'a mut Value, steps: &[Step]) -> Result<&'a mut Value, SpecError> {
    let mut at = root;
    for (index, step) in steps.iter().enumerate() {
        let place = || written(&steps[..index]);
        at = match step {
            Step::Entry(name) => {
                let entries = at.as_array_mut().map(Vec::as_mut_slice).unwrap_or_default();
                let Some(found) = entries.iter().position(|entry| path::entry_name(entry) == Some(name)) else {
                    let list = place();
                    let what = if list == "expect" { "condition" } else { list.rsplit('.').next().unwrap_or_default() };
                    return Err(SpecError::unknown(&list, what, name, entries.iter().filter_map(path::entry_name)));
                };
                &mut entries[found]
            }
            // A list that is not there has no entries.
            Step::List(list) => match at {
                Value::Object(table) => table.entry(*list).or_insert_with(|| json!([])),
                other => return Err(no_parts(&written(&steps[..=index]), list, other)),
            },
            Step::Key(key) => {
                let place = place();
                let choice = CHOICES.contains(&place.rsplit('.').next().unwrap_or_default());
                if at.get(key).is_none() {
                    return Err(match at.as_object() {
                        Some(table) if !choice => SpecError::unknown(&place, "key", key, table.keys().map(String::as_str)),
                        _ => no_parts(&written(&steps[..=index]), key, at),
                    });
                }
                &mut at[*key]
            }
        };
    }
    Ok(at)
}

/// The table or vector that holds a key; a choice of another form is emptied first.
fn parent_of<'a>(root: &'a mut Value, front: &[Step], key: &str) -> Result<&'a mut Value, SpecError> {
    let at = descend(root, front)?;
    let choice = front.last().is_some_and(|step| CHOICES.contains(&step.text()));
    if choice && at.get(key).is_none() {
        *at = Value::Object(Map::new());
    }
    Ok(at)
}

fn entry<'a>(root: &'a mut Value, list: &[Step], name: &str) -> Result<&'a mut Value, SpecError> {
    let steps: Vec<Step> = list.iter().copied().chain([Step::Entry(name)]).collect();
    descend(root, &steps)
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
