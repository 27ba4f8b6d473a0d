//! What differs between two specs: by name, with units and in plain words.

use std::fmt;

use serde::Serialize;
use serde_json::Value;

use super::path::{self, Step};
use super::{Edit, Spec, canonical::inline, gloss};

/// Differences smaller than this share of the value are noise.
const NOISE: f64 = 1e-6;

/// One difference between two specs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Dotted path, entries by name.
    pub path: String,
    /// The value before; none where it was added.
    pub from: Option<Value>,
    /// The value after; none where it was removed.
    pub to: Option<Value>,
    /// The unit of both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// to / from − 1, where both are numbers or vectors along one line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_change: Option<f64>,
    /// What it means: "half as stiff".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gloss: Option<String>,
}

impl Spec {
    /// What one has to know to get from this spec to another; nothing where they say the same.
    /// The order of entries and float noise do not count.
    pub fn diff(&self, to: &Spec) -> Vec<Change> {
        let mut changes = Vec::new();
        compare("", &self.to_value(), &to.to_value(), &mut changes);
        for change in &mut changes {
            change.gloss = gloss::gloss(change, self, to);
        }
        changes
    }

    /// Edits that make `to` of this spec, up to what `diff` does not count.
    pub fn edits_to(&self, to: &Spec) -> Vec<Edit> {
        self.diff(to).into_iter().map(Change::into_edit).collect()
    }
}

impl Change {
    fn new(path: &str, from: Option<&Value>, to: Option<&Value>) -> Change {
        let relative_change = from.zip(to).and_then(|(from, to)| ratio(from, to)).map(|ratio| ratio - 1.0);
        Change { path: path.to_owned(), from: from.cloned(), to: to.cloned(), unit: unit(path), relative_change, gloss: None }
    }

    fn into_edit(self) -> Edit {
        let list = match path::steps(&self.path).last() {
            Some(Step::Entry(name)) => Some(self.path[..self.path.len() - name.len() - 1].to_owned()),
            _ => None,
        };
        match (list, self.from, self.to) {
            (Some(list), None, Some(value)) => Edit::add(list, value),
            (_, _, Some(value)) => Edit::set(self.path, value),
            (_, _, None) => Edit::remove(self.path),
        }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |value: &Option<Value>| value.as_ref().map_or_else(|| "none".to_owned(), inline);
        match (&self.from, &self.to) {
            (None, Some(to)) => write!(out, "{}: added {}", self.path, inline(to))?,
            (Some(_), None) => write!(out, "{}: removed", self.path)?,
            _ => write!(out, "{}: {} → {}", self.path, shown(&self.from), shown(&self.to))?,
        }
        if let (Some(unit), Some(Value::Number(_) | Value::Array(_))) = (self.unit, &self.to) {
            write!(out, " {unit}")?;
        }
        match &self.gloss {
            Some(gloss) => write!(out, ", {gloss}"),
            None => Ok(()),
        }
    }
}

fn compare(path: &str, from: &Value, to: &Value, changes: &mut Vec<Change>) {
    match (from, to) {
        _ if same(from, to) => {}
        (Value::Object(a), Value::Object(b)) if a.keys().any(|key| b.contains_key(key)) && a.get("kind") == b.get("kind") => {
            for key in b.keys().chain(a.keys().filter(|key| !b.contains_key(*key))) {
                let inner = path::join(path, key);
                match (a.get(key), b.get(key)) {
                    (from, to) if is_list(&inner) => compare_lists(&inner, entries(from), entries(to), changes),
                    (Some(from), Some(to)) => compare(&inner, from, to, changes),
                    (from, to) => changes.push(Change::new(&inner, from, to)),
                }
            }
        }
        _ => changes.push(Change::new(path, Some(from), Some(to))),
    }
}

fn entries(list: Option<&Value>) -> &[Value] {
    list.and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default()
}

fn is_list(path: &str) -> bool {
    matches!(path::steps(path).last(), Some(Step::List(_)))
}

/// Entries are the same thing where they have the same name. Among the parts of an object the order
/// counts: those that stand otherwise are taken out and put in again.
fn compare_lists(list: &str, from: &[Value], to: &[Value], changes: &mut Vec<Change>) {
    let find = |entries: &'_ [Value], name: Option<&str>| entries.iter().position(|entry| path::entry_name(entry) == name);
    let names = |entries: &[Value]| entries.iter().map(|entry| path::entry_name(entry).map(str::to_owned)).collect::<Vec<_>>();
    if list.ends_with(".part") {
        let (before, after) = (names(from), names(to));
        let kept = before.iter().filter(|name| after.contains(name));
        let patched: Vec<_> = kept.chain(after.iter().filter(|name| !before.contains(name))).collect();
        if !patched.into_iter().eq(&after) {
            changes.extend(from.iter().enumerate().map(|(i, entry)| Change::new(&place(list, i, entry), Some(entry), None)));
            changes.extend(to.iter().enumerate().map(|(i, entry)| Change::new(&place(list, i, entry), None, Some(entry))));
            return;
        }
    }
    for (index, entry) in to.iter().enumerate() {
        let place = place(list, index, entry);
        match find(from, path::entry_name(entry)) {
            Some(before) => compare(&place, &from[before], entry, changes),
            None => changes.push(Change::new(&place, None, Some(entry))),
        }
    }
    for (index, entry) in from.iter().enumerate() {
        if find(to, path::entry_name(entry)).is_none() {
            changes.push(Change::new(&place(list, index, entry), Some(entry), None));
        }
    }
}

fn place(list: &str, index: usize, entry: &Value) -> String {
    match path::entry_name(entry) {
        Some(name) => path::join(list, name),
        None => path::entry(list, index, entry),
    }
}

/// Equal up to noise.
fn same(a: &Value, b: &Value) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => close((a - b).abs(), a.abs().max(b.abs())),
        _ => match (vector(a), vector(b)) {
            (Some(a), Some(b)) if a.len() == b.len() => {
                let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
                close(length(&difference), length(&a).max(length(&b)))
            }
            _ => a == b,
        },
    }
}

fn close(difference: f64, size: f64) -> bool {
    difference <= NOISE * size || difference < 1e-12
}

/// A list of numbers.
pub(super) fn vector(value: &Value) -> Option<Vec<f64>> {
    value.as_array().filter(|items| !items.is_empty())?.iter().map(Value::as_f64).collect()
}

pub(super) fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// to / from, where that says something: numbers, or vectors along one line.
pub(super) fn ratio(from: &Value, to: &Value) -> Option<f64> {
    if let (Some(from), Some(to)) = (from.as_f64(), to.as_f64()) {
        return (from != 0.0).then(|| to / from);
    }
    let (from, to) = (vector(from)?, vector(to)?);
    let (a, b) = (length(&from), length(&to));
    if a == 0.0 || from.len() != to.len() {
        return None;
    }
    let dot: f64 = from.iter().zip(&to).map(|(a, b)| a * b).sum();
    ((dot.abs() - a * b).abs() <= 1e-9 * a * b).then(|| dot / (a * a))
}

/// The unit that a path's last key carries.
pub fn unit(path: &str) -> Option<&'static str> {
    let key = path.rsplit('.').find(|key| !matches!(*key, "x" | "y" | "z" | "min" | "max" | "first" | "last"))?;
    // A threshold of snow, not a time.
    if key == "theta_s" {
        return None;
    }
    let units = [
        ("_kg_m3", "kg/m³"),
        ("_per_s2", "/s²"),
        ("_per_s", "/s"),
        ("_per_m", "/m"),
        ("_pa_s", "Pa·s"),
        ("_n_m", "N/m"),
        ("_m_s2", "m/s²"),
        ("_m_s", "m/s"),
        ("_rad_s", "rad/s"),
        ("_deg_s", "°/s"),
        ("_pa", "Pa"),
        ("_deg", "°"),
        ("_kg", "kg"),
        ("_j", "J"),
        ("_m", "m"),
        ("_s", "s"),
    ];
    let named = units.iter().find(|(ending, _)| key.ends_with(ending)).map(|(_, unit)| *unit);
    named.or(match key {
        "size" => Some("pixels"),
        "fps" => Some("frames/s"),
        "metres_per_unit" => Some("m"),
        _ => None,
    })
}
