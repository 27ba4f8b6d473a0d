//! Compares a value with the schema and says the first thing that is wrong, in the words of the
//! person who wrote it: path by name, value, what is allowed, nearest name.

use serde_json::{Map, Value};

use super::canonical::number;
use super::error::{SpecError, SpecErrorKind, nearest, show};
use super::{later, limits, path};

/// Checks structure, types and ranges of a whole spec.
pub(super) fn spec(value: &Value) -> Result<(), SpecError> {
    if let Some(format) = value.get("format").and_then(Value::as_u64)
        && format > u64::from(limits::FORMAT)
    {
        let message = format!("this spec has format {format}, newer than this program");
        return Err(SpecError::new(SpecErrorKind::Newer, "format", message).allowed(format!("format {}, or a newer phystalk", limits::FORMAT)));
    }
    Walk { root: super::schema::spec() }.check(super::schema::spec(), value, &Place::default())
}

/// Writes numbers without a fraction as whole ones, for those who wrote `50.0` where a count is asked for. Any number may be
/// written so.
pub(super) fn whole_numbers(value: &mut Value) {
    match value {
        Value::Number(number) => {
            // Beyond 2^53 not every whole number is one of these.
            if let Some(whole) =
                number.as_f64().filter(|f| number.is_f64() && f.fract() == 0.0 && f.abs() < 9e15 && !(*f == 0.0 && f.is_sign_negative()))
            {
                *number = (whole as i64).into();
            }
        }
        Value::Array(items) => items.iter_mut().for_each(whole_numbers),
        Value::Object(table) => table.values_mut().for_each(whole_numbers),
        _ => {}
    }
}

/// What a part of the schema allows, in words.
pub(super) fn describe(schema: &Value) -> String {
    Walk { root: super::schema::spec() }.describe(schema)
}

/// Where the walk is: as shown, with entries by name, and as a pattern, without them.
#[derive(Clone, Default)]
struct Place {
    shown: String,
    pattern: String,
}

impl Place {
    fn key(&self, key: &str) -> Place {
        Place { shown: path::join(&self.shown, key), pattern: path::join(&self.pattern, key) }
    }

    fn entry(&self, index: usize, entry: &Value) -> Place {
        Place { shown: path::entry(&self.shown, index, entry), pattern: self.pattern.clone() }
    }
}

struct Walk<'a> {
    root: &'a Value,
}

impl<'a> Walk<'a> {
    /// Follows a reference; a bound that stands beside it is not lost, since `check` looks there.
    fn resolve(&self, schema: &'a Value) -> &'a Value {
        match schema.get("$ref").and_then(Value::as_str).and_then(|reference| reference.strip_prefix('#')) {
            Some(pointer) => self.root.pointer(pointer).unwrap_or(schema),
            None => schema,
        }
    }

    fn check(&self, schema: &'a Value, value: &Value, place: &Place) -> Result<(), SpecError> {
        let resolved = self.resolve(schema);
        if let Some(alternatives) = alternatives(resolved) {
            let chosen = alternatives.iter().find(|alternative| self.fits(alternative, value));
            return match chosen {
                Some(chosen) => {
                    self.check(chosen, value, place)?;
                    bounds(schema, value, place, self)
                }
                None => Err(self.no_alternative(schema, alternatives, value, place)),
            };
        }
        if !self.fits(resolved, value) {
            return Err(self.wrong_type(schema, value, place));
        }
        match value {
            Value::Object(table) => self.table(resolved, table, place),
            Value::Array(items) => {
                bounds(schema, value, place, self)?;
                self.list(resolved, items, value, place)
            }
            _ => bounds(schema, value, place, self),
        }
    }

    /// Whether a value is of the right sort for a schema, without looking further in.
    fn fits(&self, schema: &'a Value, value: &Value) -> bool {
        let schema = self.resolve(schema);
        if let Some(constant) = schema.get("const") {
            return constant == value;
        }
        if let Some(alternatives) = alternatives(schema) {
            return alternatives.iter().any(|alternative| self.fits(alternative, value));
        }
        match (schema["type"].as_str(), value) {
            (Some("object"), Value::Object(table)) => {
                let tag_fits = |(key, property): (&String, &Value)| match property.get("const") {
                    Some(constant) => table.get(key) == Some(constant),
                    None => true,
                };
                // In a choice among `{ box = … }` and `{ sphere = … }` the key is the choice.
                let single = property_count(schema) == 1 && required(schema).count() == 1;
                properties(schema).all(tag_fits) && (!single || table.is_empty() || required(schema).all(|key| table.contains_key(key)))
            }
            (Some("array"), Value::Array(_)) | (Some("string"), Value::String(_)) | (Some("boolean"), Value::Bool(_)) => true,
            (Some("integer"), Value::Number(number)) => number.as_f64().is_some_and(|float| float.fract() == 0.0),
            (Some("number"), Value::Number(_)) => true,
            _ => false,
        }
    }

    fn table(&self, schema: &'a Value, table: &Map<String, Value>, place: &Place) -> Result<(), SpecError> {
        for (key, value) in table {
            let inner = place.key(key);
            match schema["properties"].get(key) {
                Some(property) => self.check(property, value, &inner)?,
                None => return Err(self.unknown_key(schema, key, value, place)),
            }
        }
        match required(schema).find(|key| !table.contains_key(*key)) {
            Some(key) => {
                let wanted = self.describe(&schema["properties"][key]);
                Err(SpecError::new(SpecErrorKind::Missing, &place.key(key).shown, "missing").allowed(wanted))
            }
            None => Ok(()),
        }
    }

    fn unknown_key(&self, schema: &'a Value, key: &str, value: &Value, place: &Place) -> SpecError {
        let known = schema["properties"].as_object().into_iter().flatten().map(|(key, _)| key.as_str());
        match later::key(&place.pattern, key) {
            Some(what) => later::error(&place.key(key).shown, what, &known.collect::<Vec<_>>().join(", ")),
            None => {
                let mut error = SpecError::unknown(&place.shown, "key", key, known);
                error.message = format!("{} = {}", error.message, show(value)).into();
                error.nearest = error.nearest.or_else(|| elsewhere(key));
                let kinds = kinds_with(key);
                if place.pattern.ends_with("material") && !kinds.is_empty() {
                    error.nearest = None;
                    error.allowed = error.allowed.map(|known| format!("{known}; `{key}` is of kind {}", kinds.join(", ")).into());
                }
                error
            }
        }
    }

    fn list(&self, schema: &'a Value, items: &[Value], value: &Value, place: &Place) -> Result<(), SpecError> {
        let count = items.len() as u64;
        let (least, most) = (schema["minItems"].as_u64().unwrap_or(0), schema["maxItems"].as_u64().unwrap_or(u64::MAX));
        if count < least || count > most {
            let message = format!("{} has {count} entries", show(value));
            let allowed = if least == most { format!("{least}") } else { format!("{least} to {most}") };
            return Err(SpecError::new(SpecErrorKind::Range, &place.shown, message).allowed(allowed));
        }
        for (index, item) in items.iter().enumerate() {
            // Components of a vector are spoken of as the vector.
            let inner = if item.is_object() { place.entry(index, item) } else { place.clone() };
            self.check(&schema["items"], item, &inner).map_err(|mut error| {
                if item.is_number() {
                    error.message = format!("{}, in {}", error.message, show(value)).into();
                }
                error
            })?;
        }
        Ok(())
    }

    fn wrong_type(&self, schema: &'a Value, value: &Value, place: &Place) -> SpecError {
        if value.is_null() {
            return SpecError::new(SpecErrorKind::Type, &place.shown, "not a finite number").allowed(self.describe(schema));
        }
        if let Some(what) = later::value(&place.pattern, value) {
            return later::error(&place.shown, what, &self.describe(schema));
        }
        SpecError::new(SpecErrorKind::Type, &place.shown, format!("{} is {}", show(value), sort(value))).allowed(self.describe(schema))
    }

    /// None of several forms: a word that is not known, or a value of the wrong sort.
    fn no_alternative(&self, schema: &'a Value, alternatives: &'a [Value], value: &Value, place: &Place) -> SpecError {
        let words = alternatives.iter().filter_map(|alternative| word(self.resolve(alternative)));
        let tag = alternatives.iter().find_map(|alternative| tag(self.resolve(alternative)));
        let given = match (value, tag) {
            (Value::String(text), _) => Some(text.as_str()),
            (Value::Object(table), Some((tag, _))) => table.get(tag).and_then(Value::as_str),
            (Value::Object(table), None) if table.len() == 1 => table.keys().next().map(String::as_str),
            _ => None,
        };
        let inner = if tag.is_some() && value.is_object() { place.key(tag.map_or("", |(tag, _)| tag)) } else { place.clone() };
        if let Some(what) = later::value(&inner.pattern, value).or_else(|| given.and_then(|word| later::word(&inner.pattern, word))) {
            return later::error(&inner.shown, what, &words.collect::<Vec<_>>().join(", "));
        }
        match given {
            Some(given) => {
                let mut error = SpecError::unknown(&inner.shown, "value", given, words);
                error.allowed = Some(self.describe(schema).into());
                error
            }
            None => self.wrong_type(schema, value, place),
        }
    }

    /// What a schema allows, in words.
    fn describe(&self, schema: &'a Value) -> String {
        let resolved = self.resolve(schema);
        if let Some(alternatives) = alternatives(resolved) {
            let mut words: Vec<String> = Vec::new();
            for alternative in alternatives {
                let inner = self.resolve(alternative);
                match word(inner) {
                    Some(name) if inner.get("const").is_some() => words.push(format!("\"{name}\"")),
                    Some(name) => words
                        .push(format!("{{ {} }}", tag(inner).map_or(format!("{name} = … "), |(tag, _)| format!("{tag} = \"{name}\", … ")).trim())),
                    None => words.insert(0, with_range(&self.describe(alternative), schema, resolved)),
                }
            }
            return words.join(" or ");
        }
        let sort = match resolved["type"].as_str() {
            Some("number") => "a number".to_owned(),
            Some("integer") => "a whole number".to_owned(),
            Some("string") => match resolved["pattern"].as_str() {
                Some(path::NAME_PATTERN) => format!("a name of a-z, 0-9, _ and -, at most {} long", limits::NAME),
                Some(limits::COLOUR_PATTERN) => "a colour such as \"#eaeaf2\"".to_owned(),
                Some(_) => "64 hexadecimal digits".to_owned(),
                None => "a text".to_owned(),
            },
            Some("array") => match resolved["minItems"].as_u64() {
                Some(count) if resolved["maxItems"].as_u64() == Some(count) => {
                    let each = self.resolve(&resolved["items"]);
                    let length = schema.get(limits::MAX_NORM).or(resolved.get(limits::MAX_NORM)).and_then(Value::as_f64);
                    let range = match length {
                        Some(most) => format!(" of length at most {}", number(most)),
                        None => range(each).map(|range| format!(", each {range}")).unwrap_or_default(),
                    };
                    return format!("{}{range}", if count == 3 { "a vector of 3 numbers".to_owned() } else { format!("a list of {count} numbers") });
                }
                _ => match (resolved["items"]["type"].as_str(), resolved["maxItems"].as_u64()) {
                    (Some("array"), _) => format!("a list of {}", self.describe(&resolved["items"]).replace("a list", "lists")),
                    (Some("integer"), Some(most)) => format!("a list of at most {most} whole numbers"),
                    _ => "a list".to_owned(),
                },
            },
            Some("boolean") => "true or false".to_owned(),
            Some("object") => {
                let keys: Vec<&str> = properties(resolved).map(|(key, _)| key.as_str()).collect();
                format!("a table of {}", keys.join(", "))
            }
            _ => "nothing".to_owned(),
        };
        with_range(&sort, schema, resolved)
    }
}

/// The kinds of material that have a parameter of that name.
fn kinds_with(key: &str) -> Vec<&'static str> {
    let forms = super::schema::spec()["$defs"]["Material"]["oneOf"].as_array();
    let having = forms.into_iter().flatten().filter(|form| form["properties"].get(key).is_some());
    having.filter_map(|form| Some(tag(form)?.1)).collect()
}

/// A key like this one in another table, as a whole path.
fn elsewhere(key: &str) -> Option<Box<str>> {
    let paths = super::schema::paths();
    let last = |path: &'static str| path.rsplit('.').next().unwrap_or(path);
    let meant = nearest(key, paths.iter().map(|path| last(path)))?;
    paths.iter().find(|path| last(path) == meant).map(|path| path.as_str().into())
}

/// Ranges of numbers, patterns of texts, lengths of vectors.
fn bounds(schema: &Value, value: &Value, place: &Place, walk: &Walk) -> Result<(), SpecError> {
    let refuse = |message: String| Err(SpecError::new(SpecErrorKind::Range, &place.shown, message).allowed(walk.describe(schema)));
    match value {
        Value::Number(given) => {
            let given = given.as_f64().unwrap_or(f64::NAN);
            let least = schema["minimum"].as_f64().unwrap_or(f64::NEG_INFINITY);
            let most = schema["maximum"].as_f64().unwrap_or(f64::INFINITY);
            if (least..=most).contains(&given) { Ok(()) } else { refuse(format!("{} is out of range", number(given))) }
        }
        Value::String(text) => match schema["pattern"].as_str() {
            Some(pattern) if !matches(pattern, text) => refuse(format!("{} does not fit", show(value))),
            _ => Ok(()),
        },
        Value::Array(items) => {
            let length = items.iter().filter_map(Value::as_f64).fold(0.0, f64::hypot);
            match schema[limits::MAX_NORM].as_f64() {
                Some(most) if length > most => refuse(format!("{} is {} long", show(value), number((length * 1e3).round() / 1e3))),
                _ => Ok(()),
            }
        }
        _ => Ok(()),
    }
}

/// The three patterns that our schema holds.
fn matches(pattern: &str, text: &str) -> bool {
    let hex = |rest: &str, count: usize| rest.len() == count && rest.bytes().all(|byte| byte.is_ascii_hexdigit());
    match pattern {
        limits::COLOUR_PATTERN => text.strip_prefix('#').is_some_and(|rest| hex(rest, 6)),
        path::NAME_PATTERN => path::is_name(text),
        _ => hex(text, 64) && !text.bytes().any(|byte| byte.is_ascii_uppercase()),
    }
}

fn with_range(text: &str, schema: &Value, resolved: &Value) -> String {
    match range(schema).or_else(|| range(resolved)) {
        Some(range) => format!("{text} {range}"),
        None => text.to_owned(),
    }
}

fn range(schema: &Value) -> Option<String> {
    match (schema["minimum"].as_f64(), schema["maximum"].as_f64()) {
        (Some(least), Some(most)) if least == most => Some(format!("that is {}", number(least))),
        (Some(least), Some(most)) => Some(format!("from {} to {}", number(least), number(most))),
        _ => None,
    }
}

/// The forms among which a schema chooses.
fn alternatives(schema: &Value) -> Option<&[Value]> {
    schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Value::as_array).map(Vec::as_slice)
}

/// The word by which one form of several is chosen.
fn word(schema: &Value) -> Option<&str> {
    if let Some(word) = schema.get("const") {
        return word.as_str();
    }
    match tag(schema) {
        Some((_, word)) => Some(word),
        None if property_count(schema) == 1 => properties(schema).next().map(|(key, _)| key.as_str()),
        None => None,
    }
}

/// The key and the word of a form that carries its choice inside: `kind = "elastic"`.
fn tag(schema: &Value) -> Option<(&str, &str)> {
    properties(schema).find_map(|(key, property)| Some((key.as_str(), property.get("const")?.as_str()?)))
}

fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema["properties"].as_object().into_iter().flatten()
}

fn property_count(schema: &Value) -> usize {
    schema["properties"].as_object().map_or(0, Map::len)
}

fn required(schema: &Value) -> impl Iterator<Item = &str> {
    schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str)
}

/// The sort of a value, in words.
fn sort(value: &Value) -> &'static str {
    match value {
        Value::Null => "nothing",
        Value::Bool(_) => "true or false",
        Value::Number(number) if number.is_f64() => "a number with a fraction",
        Value::Number(_) => "a whole number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "a table",
    }
}
