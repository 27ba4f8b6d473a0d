//! What makes sense of a spec whose values were drawn one by one: names that refer to each other, a scene that is
//! there, a run of a few frames on a small grid, and places near enough to matter.

use super::{Random, Size, draw, schema};
use crate::spec::Force;
use serde_json::{Map, Value, json};

/// Longest run, in frames.
const FRAMES_MOST: usize = 3;
/// Effects of an event, of which it has one.
const EVENTS: [&str; 6] = ["push_m_s", "velocity_m_s", "material", "weaken", "freeze", "release"];
/// Share of places and sizes that lie within the scene; the others are anywhere that a spec allows.
const NEAR: f64 = 0.85;

type Table = Map<String, Value>;

pub(super) fn make(value: &mut Value, scene_file: &str, seed: u64, size: Size, random: &mut Random) {
    let Some(spec) = value.as_object_mut() else { return };
    spec.insert("format".to_owned(), json!(1));
    spec.insert("seed".to_owned(), json!(seed % 1000));
    // A scene of 1 mm, 1 m or 100 m.
    let scale = [1e-3, 1.0, 1.0, 1.0, 100.0][random.below(5)];
    spec.insert("scene".to_owned(), json!({ "file": scene_file, "up": "+z", "metres_per_unit": scale }));
    let end_s = run(spec, size, random);
    if let Some(height) = spec.get_mut("world").and_then(|world| world.pointer_mut("/ground/height_m")).filter(|height| height.is_number()) {
        // What lies under the ground altogether is refused.
        if random.chance(NEAR) {
            *height = json!((0.8 * random.share() - 0.4) * scale);
        }
    }
    for key in ["camera", "output", "skin", "expect", "look"] {
        spec.remove(key);
    }
    let objects = names(spec, "object", "thing", 1 + random.below(2));
    for item in entries(spec, "object") {
        object(item, scale, random);
        // The search for a captured pose's stress takes longer than all else.
        if size == Size::Small && random.chance(0.8) {
            item.insert("rest".to_owned(), json!("stress_free"));
        }
    }
    split_scene(spec, scale, random);
    let parts: Vec<Vec<Value>> = entries(spec, "object").map(|item| part_names(item)).collect();
    for (list, stem) in [("pin", "pin"), ("collider", "wall"), ("force", "force"), ("event", "event")] {
        names(spec, list, stem, 3);
        for item in entries(spec, list) {
            let index = random.below(objects.len().max(1));
            if item.contains_key("object") {
                item.insert("object".to_owned(), json!(objects[index]));
            }
            times(item, end_s, scale, random);
            one_way(item, list, random);
            item.remove("part");
            if list == "event" && !parts[index].is_empty() && random.chance(0.5) {
                item.insert("part".to_owned(), parts[index][random.below(parts[index].len())].clone());
            }
            item.values_mut().for_each(|v| near(v, scale, random));
        }
    }
}

/// The length of the run and what it may cost; seconds that it takes at most.
fn run(spec: &mut Table, size: Size, random: &mut Random) -> f64 {
    let most = if size == Size::Small { 2 } else { FRAMES_MOST };
    let fps = [24, 50, 50, 120, 1000][random.below(5)];
    let frames = if random.chance(0.1) { 0 } else { 1 + random.below(most) };
    spec.insert("time".to_owned(), json!({ "fps": fps, "duration_s": frames as f64 / f64::from(fps) }));
    let (cells, substeps) = match size {
        Size::Small => (4 + random.below(2), 20.0 * 4f64.powf(random.share())),
        Size::Whole => (4 + random.below(5), 20.0 * 200f64.powf(random.share().powi(3))),
    };
    spec.insert("solver".to_owned(), json!({ "cells_across": cells, "substeps_most": substeps.round() as u32 }));
    most as f64 / f64::from(fps)
}

/// An object of some material, near enough to others and to the ground to meet them.
fn object(item: &mut Table, scale: f64, random: &mut Random) {
    item.insert("select".to_owned(), json!("all"));
    if random.chance(0.05) {
        // A particle, or a few.
        let ids: Vec<usize> = (0..1 + random.below(3)).map(|_| random.below(960)).collect();
        item.insert("select".to_owned(), json!({ "ids": ids }));
        // So few lie in a plane, and have no hull.
        item.insert("proxy".to_owned(), json!("voxel"));
    }
    if random.chance(NEAR) {
        item.insert("offset_m".to_owned(), json!(std::array::from_fn::<f64, 3, _>(|_| (random.share() - 0.4) * scale)));
    }
    if !item.contains_key("material") && random.chance(0.8) {
        let drawn = schema::spec().pointer("/$defs/Material").and_then(|material| draw(material, None, random));
        item.extend(drawn.map(|material| ("material".to_owned(), material)));
    }
    for (number, part) in item.get_mut("part").and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut).enumerate() {
        part.insert("name".to_owned(), json!(format!("part{number}")));
        part.values_mut().for_each(|v| near(v, scale, random));
    }
}

fn part_names(item: &Table) -> Vec<Value> {
    item.get("part").and_then(Value::as_array).into_iter().flatten().filter_map(|part| part.get("name").cloned()).collect()
}

/// Moments within the run, and ways that take as long as it does.
fn times(item: &mut Table, end_s: f64, scale: f64, random: &mut Random) {
    for time in ["at_s", "from_s", "to_s"] {
        if item.get(time).is_some_and(Value::is_number) {
            let share = 0.5 * random.share() + if time == "to_s" { 0.5 } else { 0.0 };
            item.insert(time.to_owned(), json!(end_s * share));
        }
    }
    let way = json!([[0.0, 0.0, 0.0, 0.0], [end_s, 0.1 * scale, 0.0, 0.0]]);
    if item.contains_key("path") {
        item.insert("path".to_owned(), way.clone());
    }
    if let Some(spring) = item.get_mut("spring").and_then(Value::as_object_mut).filter(|spring| spring.contains_key("path_m")) {
        spring.insert("path_m".to_owned(), way);
        spring.remove("to_m");
    }
    if item.contains_key("when") {
        item.remove("at_s");
    }
}

/// Brings most places into the scene, and makes most things about as large as it.
fn near(value: &mut Value, scale: f64, random: &mut Random) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|v| near(v, scale, random)),
        Value::Object(table) => {
            for (key, inner) in table {
                let place = matches!(key.as_str(), "centre_m" | "point_m" | "from_m" | "to_m") && inner.is_array();
                let size = matches!(key.as_str(), "size_m" | "radius_m" | "eddy_m");
                match () {
                    _ if place && random.chance(NEAR) => *inner = json!(std::array::from_fn::<f64, 3, _>(|_| (1.6 * random.share() - 0.7) * scale)),
                    _ if size && random.chance(NEAR) => {
                        let mut length = || 1.5 * scale * 0.03f64.powf(random.share());
                        *inner = if inner.is_array() { json!([length(), length(), length()]) } else { json!(length()) };
                    }
                    _ if place || size => {}
                    _ => near(inner, scale, random),
                }
            }
        }
        _ => {}
    }
}

/// Of the ways that exclude each other in a force or an event, one; a plain one where none was drawn.
fn one_way(item: &mut Table, list: &str, random: &mut Random) {
    let (ways, plain): (&[&str], _) = match list {
        "force" => (Force::WAYS, "acceleration_m_s2"),
        "event" => (&EVENTS, "push_m_s"),
        _ => return,
    };
    let drawn: Vec<&str> = ways.iter().copied().filter(|w| item.get(*w).is_some_and(|v| *v != json!(false))).collect();
    let kept = if drawn.is_empty() { plain } else { drawn[random.below(drawn.len())] };
    ways.iter().filter(|w| **w != kept).for_each(|w| drop(item.remove(*w)));
    item.entry(kept).or_insert(json!([0.5, 0.0, 2.0]));
}

/// The entries of a list that are tables.
fn entries<'a>(spec: &'a mut Table, list: &str) -> impl Iterator<Item = &'a mut Table> {
    spec.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

/// Shortens a list, and numbers the names in it.
fn names(spec: &mut Table, list: &str, stem: &str, most: usize) -> Vec<String> {
    if let Some(items) = spec.get_mut(list).and_then(Value::as_array_mut) {
        items.truncate(most);
    }
    let mut given = Vec::new();
    for (number, item) in entries(spec, list).enumerate() {
        let name = format!("{stem}{number}");
        item.insert("name".to_owned(), json!(name));
        given.push(name);
    }
    given
}

/// Two objects take the halves of the scene, on either side of x = 0, or one takes little and the other the rest.
fn split_scene(spec: &mut Table, scale: f64, random: &mut Random) {
    let count = spec.get("object").and_then(Value::as_array).map_or(0, Vec::len);
    if count < 2 {
        return;
    }
    // Two layers of Gaussians at least, which have a hull.
    let at = if random.chance(0.2) { -0.15 } else { 0.0 };
    for (number, item) in entries(spec, "object").enumerate().filter(|(_, item)| item.get("select") == Some(&json!("all"))) {
        let x = (at + if number == 0 { -1.0 } else { 1.0 }) * scale;
        let size = [2.0 * scale, 4.0 * scale, 4.0 * scale];
        item.insert("select".to_owned(), json!({ "box": { "centre_m": [x, 0.0, 0.0], "size_m": size } }));
    }
}
