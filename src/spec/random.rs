//! Random specs from the whole schema: what nobody would write, and the solver has to survive.
//!
//! A value is drawn for whatever the schema allows, so that a field that is added is drawn too. What
//! only makes sense together (names, the scene, the length of a run) is set afterwards ([`sense`]).

mod sense;

use super::{Spec, SpecError, schema};
use serde_json::{Value, json};

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
/// Share of the properties that need not be there and are.
const GIVEN: f64 = 0.6;

/// How much a spec may ask of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// A blink on a software adapter: frames and substeps are few.
    Small,
    /// What a GPU does in a blink.
    Whole,
}

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
pub fn spec(seed: u64, scene_file: &str, size: Size) -> Result<Spec, SpecError> {
    let mut random = Random(seed);
    let mut value = draw(schema::spec(), None, &mut random).unwrap_or_default();
    sense::make(&mut value, scene_file, seed, size, &mut random);
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

/// Adds the properties that a schema names: those it requires, and most of the others.
fn with_properties(schema: &Value, mut value: Value, random: &mut Random) -> Value {
    let (Some(properties), Some(table)) = (schema.get("properties").and_then(Value::as_object), value.as_object_mut()) else { return value };
    let required = schema.get("required").and_then(Value::as_array);
    for (name, property) in properties {
        let needed = required.is_some_and(|r| r.iter().any(|n| n == name));
        if needed || random.chance(GIVEN) {
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

#[cfg(test)]
mod tests;
