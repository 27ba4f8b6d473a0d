//! Random specs from the whole schema: what nobody would write, and the solver has to survive.
//!
//! A value is drawn for whatever the schema allows, so that a field that is added is drawn too. What
//! only makes sense together (names, the scene, the length of a run) is set afterwards.

use super::{Force, Spec, SpecError, schema};
use serde_json::{Map, Value, json};

/// Longest run, in frames.
const FRAMES_MOST: u64 = 3;
/// Expressions to draw from, the unkind ones among them.
const EXPRESSIONS: [&str; 6] = [
    "vec3(6.0 * sin(3.0 * t), 0, 0)",
    "vec3(0, 0, 30) - 4.0 * v",
    "cross(vec3(0, 0, 20), x)",
    "vec3(1.0 / (x.x - x.x), 0, 0)",
    "-40.0 * (x - x0)",
    "vec3(exp(90.0 * t), ln(-1.0), 0)",
];

/// What was drawn and does not go together is taken out, so many times.
const REPAIRS: u32 = 32;
/// Effects of an event, of which it has one.
const EVENTS: [&str; 6] = ["push_m_s", "velocity_m_s", "material", "weaken", "freeze", "release"];

/// SplitMix64 (Steele, Lea and Flood 2014): equal seeds, equal specs, everywhere.
#[derive(Clone, Debug)]
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// From 0 to below 1.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.share() * count as f64) as usize
    }

    fn chance(&mut self, share: f64) -> bool {
        self.share() < share
    }

    /// Within bounds, the bounds themselves now and then; evenly over the orders of magnitude where
    /// there are many.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = self.share();
        match self.below(12) {
            0 => low,
            1 => high,
            2 if low <= 0.0 && high >= 0.0 => 0.0,
            _ if low > 0.0 && high / low > 100.0 => low * (high / low).powf(share),
            _ if low < 0.0 && high > 0.0 && high - low > 100.0 => {
                let most = if self.chance(0.5) { high } else { low };
                most * 1e-4f64.powf(share)
            }
            _ if low == 0.0 && high > 100.0 => high * 1e-6f64.powf(share),
            _ => low + share * (high - low),
        }
    }
}

/// A spec drawn from the schema for a scene file; the error where what was drawn does not go together.
pub fn spec(seed: u64, scene_file: &str) -> Result<Spec, SpecError> {
    let mut random = Random(seed);
    let mut value = draw(schema::spec(), None, &mut random).unwrap_or_default();
    make_sense(&mut value, scene_file, seed, &mut random);
    let mut result = Spec::from_value(value.clone());
    for _ in 0..REPAIRS {
        match &result {
            Err(error) if take_out(&mut value, &error.path) => result = Spec::from_value(value.clone()),
            _ => break,
        }
    }
    result
}

/// Takes out what an error points at: a field of an object, a part of it, or the entry of another
/// list. Whether there was such a thing.
fn take_out(value: &mut Value, path: &str) -> bool {
    let words: Vec<&str> = path.split('.').collect();
    let Some(spec) = value.as_object_mut() else { return false };
    let named = |item: &Value, name: &str| item.get("name").and_then(Value::as_str) == Some(name);
    let remove = |list: Option<&mut Value>, name: &str| {
        let Some(items) = list.and_then(Value::as_array_mut) else { return false };
        let before = items.len();
        items.retain(|item| !named(item, name));
        items.len() < before
    };
    match words.as_slice() {
        ["object", name, rest @ ..] => {
            let object = spec.get_mut("object").and_then(Value::as_array_mut).into_iter().flatten().find(|o| named(o, name));
            let Some(object) = object.and_then(Value::as_object_mut) else { return false };
            match rest {
                ["part", part, ..] => remove(object.get_mut("part"), part),
                [field, ..] => object.remove(*field).is_some(),
                [] => false,
            }
        }
        [list, name, ..] => remove(spec.get_mut(*list), name),
        _ => false,
    }
}

/// A value that a schema allows; `around` is the schema whose alternative it is, for its bounds.
fn draw(schema: &Value, around: Option<&Value>, random: &mut Random) -> Option<Value> {
    if let Some(name) = schema.get("$ref").and_then(Value::as_str) {
        let target = schema::spec().pointer(name.trim_start_matches('#'))?;
        return draw(target, around.or(Some(schema)), random);
    }
    if let Some(value) = schema.get("const") {
        return Some(value.clone());
    }
    if let Some(values) = schema.get("enum").and_then(Value::as_array) {
        return values.get(random.below(values.len())).cloned();
    }
    for alternatives in ["oneOf", "anyOf"] {
        if let Some(list) = schema.get(alternatives).and_then(Value::as_array) {
            let chosen = draw(list.get(random.below(list.len()))?, Some(schema), random)?;
            return Some(with_properties(schema, chosen, random));
        }
    }
    let bound = |name: &str| [Some(schema), around].into_iter().flatten().find_map(|s| s.get(name).and_then(Value::as_f64));
    match schema.get("type").and_then(Value::as_str)? {
        "number" => Some(json!(random.between(bound("minimum").unwrap_or(-1e3), bound("maximum").unwrap_or(1e3)))),
        "integer" => Some(json!(random.between(bound("minimum").unwrap_or(0.0), bound("maximum").unwrap_or(1e3)).round() as i64)),
        "boolean" => Some(json!(random.chance(0.5))),
        "string" => Some(json!(EXPRESSIONS[random.below(EXPRESSIONS.len())])),
        "array" => array(schema, random),
        "object" => Some(with_properties(schema, json!({}), random)),
        _ => None,
    }
}

/// Adds the properties that a schema names: those it requires, and half of the others.
fn with_properties(schema: &Value, mut value: Value, random: &mut Random) -> Value {
    let (Some(properties), Some(table)) = (schema.get("properties").and_then(Value::as_object), value.as_object_mut()) else { return value };
    let required = schema.get("required").and_then(Value::as_array);
    for (name, property) in properties {
        let needed = required.is_some_and(|r| r.iter().any(|n| n == name));
        if needed || random.chance(0.5) {
            table.extend(draw(property, None, random).map(|v| (name.clone(), v)));
        }
    }
    value
}

/// As many items as are asked for, at most three more; a vector no longer than its norm may be.
fn array(schema: &Value, random: &mut Random) -> Option<Value> {
    let size = |name: &str| schema.get(name).and_then(Value::as_u64);
    let least = size("minItems").unwrap_or(0);
    let most = size("maxItems").unwrap_or(least + 3).min(least + 3);
    let count = least + random.below((most - least + 1) as usize) as u64;
    let items: Vec<Value> = match schema.get("prefixItems").and_then(Value::as_array) {
        Some(each) => each.iter().filter_map(|s| draw(s, None, random)).collect(),
        None => (0..count).filter_map(|_| draw(schema.get("items")?, Some(schema), random)).collect(),
    };
    let numbers: Option<Vec<f64>> = items.iter().map(Value::as_f64).collect();
    match (schema.get("x-maxNorm").and_then(Value::as_f64), numbers) {
        (Some(limit), Some(numbers)) => {
            let norm = numbers.iter().map(|n| n * n).sum::<f64>().sqrt();
            let share = if norm > limit { 0.999 * limit / norm } else { 1.0 };
            Some(json!(numbers.iter().map(|n| n * share).collect::<Vec<_>>()))
        }
        _ => Some(Value::Array(items)),
    }
}

/// Names that refer to each other, a scene that is there, a run of a few frames on a small grid.
fn make_sense(value: &mut Value, scene_file: &str, seed: u64, random: &mut Random) {
    let Some(spec) = value.as_object_mut() else { return };
    spec.insert("format".to_owned(), json!(1));
    spec.insert("seed".to_owned(), json!(seed % 1000));
    // A scene of 1 mm, 1 m or 100 m.
    let metres_per_unit = [1e-3, 1.0, 1.0, 1.0, 100.0][random.below(5)];
    spec.insert("scene".to_owned(), json!({ "file": scene_file, "up": "+z", "metres_per_unit": metres_per_unit }));
    let fps = [24, 50, 50, 120, 1000][random.below(5)];
    spec.insert("time".to_owned(), json!({ "fps": fps, "duration_s": random.below(FRAMES_MOST as usize + 1) as f64 / f64::from(fps) }));
    spec.insert("solver".to_owned(), json!({ "cells_across": 4 + random.below(3) }));
    for key in ["camera", "output", "skin", "expect", "look"] {
        spec.remove(key);
    }
    let end_s = FRAMES_MOST as f64 / f64::from(fps);
    let objects = names(spec, "object", "thing", 1 + random.below(2));
    for (list, stem) in [("pin", "pin"), ("collider", "wall"), ("force", "force"), ("event", "event")] {
        names(spec, list, stem, 3);
        for item in entries(spec, list) {
            if item.contains_key("object") {
                item.insert("object".to_owned(), json!(objects[random.below(objects.len().max(1))]));
            }
            for time in ["at_s", "from_s", "to_s"] {
                if item.get(time).is_some_and(Value::is_number) {
                    let share = 0.5 * random.share() + if time == "to_s" { 0.5 } else { 0.0 };
                    item.insert(time.to_owned(), json!(end_s * share));
                }
            }
            one_way(item, list, random);
            if item.contains_key("path") {
                item.insert("path".to_owned(), json!([[0.0, 0.0, 0.0, 0.0], [end_s, 0.1 * metres_per_unit, 0.0, 0.0]]));
            }
            if item.contains_key("when") {
                item.remove("at_s");
            }
            item.remove("part");
        }
    }
    // Near enough to each other, and to the ground, to meet.
    for item in entries(spec, "object") {
        item.insert("select".to_owned(), json!("all"));
        let near = |random: &mut Random| json!(std::array::from_fn::<f64, 3, _>(|_| (random.share() - 0.4) * metres_per_unit));
        if random.chance(0.8) {
            item.insert("offset_m".to_owned(), near(random));
        }
        if let Some(parts) = item.get_mut("part").and_then(Value::as_array_mut) {
            for (number, part) in parts.iter_mut().filter_map(Value::as_object_mut).enumerate() {
                part.insert("name".to_owned(), json!(format!("part{number}")));
            }
        }
    }
    split_scene(spec, metres_per_unit);
}

/// Of the ways that exclude each other in a force or an event, one; a plain one where none was drawn.
fn one_way(item: &mut Map<String, Value>, list: &str, random: &mut Random) {
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
fn entries<'a>(spec: &'a mut Map<String, Value>, list: &str) -> impl Iterator<Item = &'a mut Map<String, Value>> {
    spec.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

/// Shortens a list, and numbers the names in it.
fn names(spec: &mut Map<String, Value>, list: &str, stem: &str, most: usize) -> Vec<String> {
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

/// Two objects take the halves of the scene, on either side of x = 0.
fn split_scene(spec: &mut Map<String, Value>, metres_per_unit: f64) {
    let count = spec.get("object").and_then(Value::as_array).map_or(0, Vec::len);
    if count < 2 {
        return;
    }
    for (number, item) in entries(spec, "object").enumerate() {
        let x = if number == 0 { -1.0 } else { 1.0 } * metres_per_unit;
        let size = [2.0 * metres_per_unit, 4.0 * metres_per_unit, 4.0 * metres_per_unit];
        item.insert("select".to_owned(), json!({ "box": { "centre_m": [x, 0.0, 0.0], "size_m": size } }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_is_mostly_a_spec_and_always_the_same() {
        let drawn: Vec<_> = (0..300).map(|seed| spec(seed, "block.ply")).collect();
        let good: Vec<&Spec> = drawn.iter().flatten().collect();
        assert!(
            good.len() > 200,
            "{} of 300; {:?}",
            good.len(),
            drawn.iter().filter_map(|d| d.as_ref().err()).map(ToString::to_string).take(5).collect::<Vec<_>>()
        );
        assert_eq!(spec(7, "block.ply").map(|s| s.hash()).ok(), spec(7, "block.ply").map(|s| s.hash()).ok());
        // Every list is drawn, and every material that there is.
        assert!(good.iter().any(|s| !s.pins.is_empty()) && good.iter().any(|s| !s.forces.is_empty()) && good.iter().any(|s| !s.events.is_empty()));
        assert!(good.iter().any(|s| s.objects.len() == 2) && good.iter().any(|s| !s.colliders.is_empty()));
    }
}
