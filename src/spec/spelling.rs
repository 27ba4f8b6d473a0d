//! Spellings that are read and never written: presets by name, the names of Genesis, entries that
//! were given no name. All become the one form that the types describe.

use serde_json::{Map, Value, json};

use super::aliases::{self, Settling};
use super::error::{SpecError, SpecErrorKind, show};
use super::{Material, expression, path, presets, validate};

/// Brings a whole spec, as read, into the form that the types describe. `notes` gets what was converted and how.
pub(super) fn settle(root: &mut Value, notes: &mut Vec<String>) -> Result<(), SpecError> {
    let file = root.pointer("/scene/file").and_then(Value::as_str).unwrap_or_default().to_owned();
    if let Some(gravity) = root.pointer_mut("/world/gravity_m_s2") {
        settle_gravity(gravity)?;
    }
    for (index, object) in entries(root, "object") {
        if let Some(table) = object.as_object_mut()
            && unnamed(table)
        {
            table.shift_insert(0, "name".to_owned(), json!(path::name_from_file(&file)));
        }
        let place = path::entry("object", index, object);
        settle_material(object, &place, notes)?;
        if let Some(select) = object.get_mut("select")
            && select.as_array().is_some_and(|ids| ids.iter().all(Value::is_number))
        {
            *select = json!({ "ids": select.take() });
        }
        let parts = path::join(&place, "part");
        for (index, part) in entries(object, "part") {
            settle_material(part, &path::entry(&parts, index, part), notes)?;
        }
    }
    for (index, force) in entries(root, "force") {
        let place = path::join(&path::entry("force", index, force), "acceleration_m_s2");
        if let Some(acceleration) = force.get_mut("acceleration_m_s2") {
            settle_expression(acceleration, &place)?;
        }
    }
    name_events(root);
    for (index, event) in entries(root, "event") {
        settle_material(event, &path::entry("event", index, event), notes)?;
    }
    for (_, condition) in entries(root, "expect") {
        if condition.is_string() {
            *condition = json!({ "that": condition.take() });
        }
    }
    Ok(())
}

fn entries<'a>(root: &'a mut Value, list: &str) -> impl Iterator<Item = (usize, &'a mut Value)> {
    root.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten().enumerate()
}

fn unnamed(table: &Map<String, Value>) -> bool {
    table.get("name").is_none_or(|name| name == "")
}

/// Events without a name become `event1`, `event2`, …, the first numbers that are free.
fn name_events(root: &mut Value) {
    let mut taken: Vec<String> = entries(root, "event").filter_map(|(_, event)| Some(event.get("name")?.as_str()?.to_owned())).collect();
    let mut number = 0_usize;
    for (_, event) in entries(root, "event") {
        let Some(table) = event.as_object_mut().filter(|table| unnamed(table)) else { continue };
        let name = loop {
            number += 1;
            let name = format!("event{number}");
            if !taken.contains(&name) {
                break name;
            }
        };
        table.shift_insert(0, "name".to_owned(), json!(name.clone()));
        taken.push(name);
    }
}

/// An expression takes its canonical form.
fn settle_expression(value: &mut Value, place: &str) -> Result<(), SpecError> {
    if let Some(text) = value.as_str() {
        let tree = expression::parse(text, expression::Kind::Vector).map_err(|fault| validate::expression(place, &fault))?;
        *value = json!(tree.to_string());
    }
    Ok(())
}

/// `gravity_m_s2 = "moon"`.
fn settle_gravity(gravity: &mut Value) -> Result<(), SpecError> {
    let Some(name) = gravity.as_str() else { return Ok(()) };
    let preset = presets::gravity(name).ok_or_else(|| {
        let known = presets::GRAVITY.iter().map(|preset| preset.name);
        let mut error = SpecError::unknown("world.gravity_m_s2", "gravity", name, known);
        error.allowed = error.allowed.map(|names| format!("a list of 3 numbers, or one of {names}").into());
        error
    })?;
    *gravity = json!(preset.vector());
    Ok(())
}

/// `material = "rubber"`, `material = { preset = "rubber", … }`, Genesis's names, and no kind at all.
fn settle_material(owner: &mut Value, place: &str, notes: &mut Vec<String>) -> Result<(), SpecError> {
    let Some(material) = owner.get_mut("material") else { return Ok(()) };
    let place = &path::join(place, "material");
    if let Some(word) = material.as_str().map(str::to_owned) {
        *material = named_material(&word, place)?;
        return Ok(());
    }
    let Some(table) = material.as_object_mut() else { return Ok(()) };
    let kind = |table: &Map<String, Value>| table.get("kind").and_then(Value::as_str).map(str::to_owned);
    if let Some(preset) = table.shift_remove("preset") {
        let place = path::join(place, "preset");
        let word = preset.as_str().ok_or_else(|| {
            SpecError::new(SpecErrorKind::Type, &place, format!("{} is not a name", show(&preset))).allowed(names().collect::<Vec<_>>().join(", "))
        })?;
        let base = named_material(word, &place)?;
        let base = base.as_object().cloned().unwrap_or_default();
        let mut given = std::mem::replace(table, base);
        let (is, asked) = (kind(table).unwrap_or_default(), kind(&given));
        if let Some(asked) = asked.filter(|asked| *asked != is) {
            let message = format!("{word} is {is}, and kind says {asked}");
            return Err(SpecError::new(SpecErrorKind::Conflict, place, message).allowed("a preset of that kind, or a kind without a preset"));
        }
        // What is given by another name replaces the preset's value too.
        for key in given.keys() {
            for ours in aliases::stands_for(&is, key) {
                table.shift_remove(*ours);
            }
        }
        table.append(&mut given);
    }
    let kind = kind(table).unwrap_or_else(|| {
        if !table.contains_key("kind") {
            table.shift_insert(0, "kind".to_owned(), json!("elastic"));
        }
        "elastic".to_owned()
    });
    aliases::settle(&kind, &mut Settling { table, place, notes })
}

/// A preset's values, or the defaults of a kind. The stuff called plastic is not the kind.
fn named_material(word: &str, place: &str) -> Result<Value, SpecError> {
    let material = presets::material(word).map(|preset| preset.material.clone()).or_else(|| Material::of_kind(word));
    match material {
        Some(material) => Ok(serde_json::to_value(material).unwrap_or_default()),
        None => Err(SpecError::unknown(place, "material", word, names())),
    }
}

/// The words that name a material.
fn names() -> impl Iterator<Item = &'static str> {
    let presets = || presets::MATERIALS.iter().map(|preset| preset.name);
    Material::KINDS.into_iter().filter(move |kind| !presets().any(|name| name == *kind)).chain(presets())
}
