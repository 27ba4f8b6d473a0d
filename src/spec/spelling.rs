//! Spellings that are read and never written: presets by name, the names of Genesis, entries that
//! were given no name. All become the one form that the types describe.

use serde_json::{Map, Value, json};

use super::error::{SpecError, SpecErrorKind, show};
use super::{canonical::number, expression, later, path, presets, validate};

/// Genesis's names of elastic parameters and ours.
const RENAMED: [(&str, &str); 3] = [("E", "young_pa"), ("nu", "poisson"), ("rho", "density_kg_m3")];

/// Genesis's names of Lamé's two parameters.
const LAME: [&str; 3] = ["mu", "lam", "lambda"];

/// Brings a whole spec, as read, into the form that the types describe.
pub(super) fn settle(root: &mut Value) -> Result<(), SpecError> {
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
        let place = path::join(&path::entry("object", index, object), "material");
        if let Some(material) = object.get_mut("material") {
            settle_material(material, &place)?;
        }
    }
    for (index, force) in entries(root, "force") {
        let place = path::join(&path::entry("force", index, force), "acceleration_m_s2");
        if let Some(acceleration) = force.get_mut("acceleration_m_s2") {
            settle_expression(acceleration, &place)?;
        }
    }
    name_events(root);
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
fn settle_material(material: &mut Value, place: &str) -> Result<(), SpecError> {
    if let Some(word) = material.as_str().map(str::to_owned) {
        *material = named_material(&word, place)?;
        return Ok(());
    }
    let Some(table) = material.as_object_mut() else { return Ok(()) };
    if let Some(preset) = table.shift_remove("preset") {
        let word = preset.as_str().ok_or_else(|| {
            SpecError::new(SpecErrorKind::Type, path::join(place, "preset"), format!("{} is not a name", show(&preset))).allowed(preset_names())
        })?;
        let base = named_material(word, &path::join(place, "preset"))?;
        for (key, value) in base.as_object().into_iter().flatten() {
            if !table.contains_key(key) {
                table.insert(key.clone(), value.clone());
            }
        }
    }
    if !table.contains_key("kind") {
        table.shift_insert(0, "kind".to_owned(), json!("elastic"));
    }
    if table["kind"] == "elastic" { settle_elastic(table, place) } else { Ok(()) }
}

/// A preset's values, or the defaults of a kind.
fn named_material(word: &str, place: &str) -> Result<Value, SpecError> {
    if word == "elastic" {
        return Ok(json!({ "kind": "elastic" }));
    }
    if let Some(preset) = presets::elastic(word) {
        return Ok(json!({ "kind": "elastic", "young_pa": preset.young_pa, "poisson": preset.poisson, "density_kg_m3": preset.density_kg_m3 }));
    }
    match later::material(word) {
        Some(what) => Err(later::error(place, what, &preset_names())),
        None => Err(SpecError::unknown(place, "material", word, std::iter::once("elastic").chain(presets::ELASTIC.iter().map(|preset| preset.name)))),
    }
}

fn preset_names() -> String {
    let names: Vec<&str> = std::iter::once("elastic").chain(presets::ELASTIC.iter().map(|preset| preset.name)).collect();
    names.join(", ")
}

/// Genesis's names: `E nu rho`, Lamé's parameters, the models.
fn settle_elastic(table: &mut Map<String, Value>, place: &str) -> Result<(), SpecError> {
    for (theirs, ours) in RENAMED {
        let Some(value) = table.shift_remove(theirs) else { continue };
        if table.contains_key(ours) && table[ours] != value {
            return Err(twice(place, theirs, ours));
        }
        table.insert(ours.to_owned(), value);
    }
    if let Some(model) = table.get_mut("model") {
        match model.as_str() {
            Some("corotation") => *model = json!("corotated"),
            Some("neohooken" | "neohookean") => *model = json!("neo_hookean"),
            _ => {}
        }
    }
    settle_lame(table, place)
}

/// Lamé's parameters to Young's modulus and Poisson's ratio: E = mu (3 lambda + 2 mu) / (lambda + mu),
/// nu = lambda / (2 (lambda + mu)). One of the two is enough where nu is given.
fn settle_lame(table: &mut Map<String, Value>, place: &str) -> Result<(), SpecError> {
    let mut take = |name: &str| -> Result<Option<f64>, SpecError> {
        let Some(value) = table.shift_remove(name) else { return Ok(None) };
        match value.as_f64().filter(|value| *value > 0.0) {
            Some(value) => Ok(Some(value)),
            None => Err(SpecError::new(SpecErrorKind::Type, path::join(place, name), format!("{} is not a modulus", show(&value)))
                .allowed("a number above 0")),
        }
    };
    let mu = take(LAME[0])?;
    let lambda = match take(LAME[1])? {
        Some(lambda) => Some(lambda),
        None => take(LAME[2])?,
    };
    if mu.is_none() && lambda.is_none() {
        return Ok(());
    }
    if table.get("young_pa").is_some_and(|young| young != "auto") {
        return Err(twice(place, if mu.is_some() { "mu" } else { "lambda" }, "young_pa"));
    }
    let given_nu = table.get("poisson").and_then(Value::as_f64);
    let (young, nu) = match (mu, lambda, given_nu) {
        (Some(mu), Some(lambda), None) => (mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), lambda / (2.0 * (lambda + mu))),
        (Some(_), Some(_), Some(_)) => return Err(twice(place, "lambda", "poisson")),
        (Some(mu), None, nu) => (2.0 * mu * (1.0 + nu.unwrap_or(0.3)), nu.unwrap_or(0.3)),
        (None, Some(lambda), nu) => {
            let nu = nu.unwrap_or(0.3);
            if nu <= 0.0 {
                let message = format!("lambda = {} says nothing with poisson = {}", number(lambda), number(nu));
                return Err(SpecError::new(SpecErrorKind::Conflict, place, message).allowed("young_pa and poisson"));
            }
            (lambda * (1.0 + nu) * (1.0 - 2.0 * nu) / nu, nu)
        }
        (None, None, _) => return Ok(()),
    };
    table.insert("young_pa".to_owned(), json!(young));
    table.insert("poisson".to_owned(), json!(nu));
    Ok(())
}

fn twice(place: &str, theirs: &str, ours: &str) -> SpecError {
    SpecError::new(SpecErrorKind::Duplicate, place, format!("`{theirs}` and `{ours}` say the same")).allowed("one of them")
}

/// The path that is meant where the last key is one of Genesis's names.
pub(super) fn settle_path(path: &str) -> String {
    match path.rsplit_once('.') {
        Some((front, last)) if front.ends_with(".material") => {
            let ours = RENAMED.iter().find(|(theirs, _)| *theirs == last).map_or(last, |(_, ours)| ours);
            format!("{front}.{ours}")
        }
        _ => path.to_owned(),
    }
}

/// Whether `key` is a parameter that is only read, together with others.
pub(super) fn is_lame(key: &str) -> bool {
    LAME.contains(&key)
}
