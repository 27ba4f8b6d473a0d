//! Text to spec: TOML or JSON, other spellings settled, checked against the schema, then as a whole.

use std::path::Path;

use serde_json::{Map, Value};
use toml::de::{DeTable, DeValue};

use super::error::{SpecError, SpecErrorKind, shorten};
use super::{Object, Spec, check, limits, path, spelling, validate};

impl Spec {
    /// A spec of one elastic object of all Gaussians, named after the scene's file, defaults elsewhere.
    pub fn of_scene(file: &str) -> Spec {
        Spec {
            format: limits::FORMAT,
            seed: 1,
            scene: super::Scene { file: file.to_owned(), blake3: None, up: super::Auto::Auto, metres_per_unit: 1.0 },
            time: super::Time::default(),
            world: super::World::default(),
            solver: super::Solver::default(),
            objects: vec![Object::new(&path::name_from_file(file))],
            pins: Vec::new(),
            colliders: Vec::new(),
            forces: Vec::new(),
            events: Vec::new(),
            skin: super::Skin::default(),
            camera: super::Auto::Auto,
            output: super::Output::default(),
            expectations: Vec::new(),
        }
    }

    /// Reads TOML; faults name the line.
    pub fn from_toml(text: &str) -> Result<Spec, SpecError> {
        Spec::from_toml_noted(text, &mut Vec::new())
    }

    fn from_toml_noted(text: &str, notes: &mut Vec<String>) -> Result<Spec, SpecError> {
        let (value, lines) = toml_value(text)?;
        Spec::from_value_noted(value, notes).map_err(|mut error| {
            error.line = lines.of(&error.path);
            error
        })
    }

    /// Reads JSON.
    pub fn from_json(text: &str) -> Result<Spec, SpecError> {
        Spec::from_json_noted(text, &mut Vec::new())
    }

    fn from_json_noted(text: &str, notes: &mut Vec<String>) -> Result<Spec, SpecError> {
        let value = serde_json::from_str(text).map_err(|error| {
            let mut fault = SpecError::new(SpecErrorKind::Syntax, "", format!("not JSON: {error}"));
            fault.line = u32::try_from(error.line()).ok();
            fault
        })?;
        Spec::from_value_noted(value, notes)
    }

    /// Reads a JSON value: other spellings settled, structure and ranges checked, references resolved.
    pub fn from_value(value: Value) -> Result<Spec, SpecError> {
        Spec::from_value_noted(value, &mut Vec::new())
    }

    /// As [`Spec::from_value`]; `notes` gets a sentence for each value that was converted from another program's.
    pub(super) fn from_value_noted(mut value: Value, notes: &mut Vec<String>) -> Result<Spec, SpecError> {
        spelling::settle(&mut value, notes)?;
        check::spec(&value)?;
        check::whole_numbers(&mut value);
        let spec: Spec = serde_json::from_value(value).map_err(|error| SpecError::new(SpecErrorKind::Type, "", error.to_string()))?;
        validate::spec(&spec)?;
        Ok(spec)
    }

    /// Checks a spec that was made in code as strictly as one that was read.
    pub fn validate(&self) -> Result<(), SpecError> {
        check::spec(&self.to_value())?;
        validate::spec(self)
    }

    /// Reads a `.toml` or `.json` file. The path of its scene becomes absolute, from the file's folder.
    pub fn read(file: &Path) -> Result<Spec, SpecError> {
        Spec::read_noted(file, &mut Vec::new())
    }

    /// As [`Spec::read`]; `notes` gets a sentence for each value that was converted from another program's.
    pub fn read_noted(file: &Path, notes: &mut Vec<String>) -> Result<Spec, SpecError> {
        let text = read_text(file)?;
        let json = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        let spec = if json { Spec::from_json_noted(&text, notes) } else { Spec::from_toml_noted(&text, notes) }?;
        spec.absolute_from(file.parent().unwrap_or(Path::new("")))
    }
}

fn read_text(file: &Path) -> Result<String, SpecError> {
    let fault = |message: String| SpecError::new(SpecErrorKind::File, "", message).allowed("a .toml or .json file of a spec");
    let shown = file.display();
    let size = match std::fs::metadata(file) {
        Ok(meta) if meta.is_dir() => return Err(fault(format!("{shown} is a directory"))),
        Ok(meta) => meta.len(),
        Err(error) => return Err(fault(format!("{shown} cannot be read: {error}"))),
    };
    if size > limits::TEXT_BYTES {
        let error = SpecError::new(SpecErrorKind::Range, "", format!("{shown} has {size} bytes, too many for a spec"));
        return Err(error.allowed(format!("at most {} bytes", limits::TEXT_BYTES)));
    }
    let bytes = std::fs::read(file).map_err(|error| fault(format!("{shown} cannot be read: {error}")))?;
    String::from_utf8(bytes).map_err(|_| SpecError::new(SpecErrorKind::Syntax, "", format!("{shown} is not UTF-8 text")))
}

/// On which line each path was written.
struct Lines<'a> {
    text: &'a str,
    at: Vec<(String, usize)>,
}

impl Lines<'_> {
    /// The line of a path, or of the nearest one above it.
    fn of(&self, path: &str) -> Option<u32> {
        // A list as a whole says nothing of the place of an entry that has no name.
        let within =
            |outer: &str| path == outer || (path.starts_with(outer) && path[outer.len()..].starts_with('.') && !path::LISTS.contains(&outer));
        let nearest = self.at.iter().filter(|(outer, _)| within(outer)).max_by_key(|(outer, _)| outer.len())?;
        Some(line(self.text, nearest.1))
    }
}

fn line(text: &str, offset: usize) -> u32 {
    let before = &text.as_bytes()[..offset.min(text.len())];
    u32::try_from(before.iter().filter(|byte| **byte == b'\n').count() + 1).unwrap_or(u32::MAX)
}

/// Parses TOML into a JSON value, and remembers where each path was written.
fn toml_value(text: &str) -> Result<(Value, Lines<'_>), SpecError> {
    let table = DeTable::parse(text).map_err(|error| {
        let first = error.message().lines().next().unwrap_or_default().to_owned();
        let mut fault = SpecError::new(SpecErrorKind::Syntax, "", format!("not TOML: {first}"));
        fault.line = error.span().map(|span| line(text, span.start));
        fault
    })?;
    let mut lines = Lines { text, at: Vec::new() };
    let value = json_table(table.get_ref(), "", &mut lines)?;
    Ok((value, lines))
}

/// A single value in TOML's syntax; none where the text is not one value.
pub(super) fn parse_inline(text: &str) -> Option<Result<Value, SpecError>> {
    let value = DeValue::parse(text).ok()?;
    match value.get_ref() {
        DeValue::Datetime(_) => None,
        value => Some(json_value(value, "", &mut Lines { text, at: Vec::new() }).map_err(|error| SpecError { line: None, ..error })),
    }
}

fn json_table(table: &DeTable, place: &str, lines: &mut Lines) -> Result<Value, SpecError> {
    let mut out = Map::new();
    for (key, value) in table {
        let inner = path::join(place, key.get_ref());
        lines.at.push((inner.clone(), key.span().start));
        out.insert(key.get_ref().to_string(), json_value(value.get_ref(), &inner, lines).map_err(|error| at_line(error, key.span().start, lines))?);
    }
    Ok(Value::Object(out))
}

fn at_line(mut error: SpecError, offset: usize, lines: &Lines) -> SpecError {
    error.line = error.line.or_else(|| Some(line(lines.text, offset)));
    error
}

fn json_value(value: &DeValue, place: &str, lines: &mut Lines) -> Result<Value, SpecError> {
    let number = |text: &str| SpecError::new(SpecErrorKind::Range, place, format!("{} is not a finite number within reach", shorten(text)));
    Ok(match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Boolean(truth) => Value::Bool(*truth),
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix()).map(Value::from).map_err(|_| number(digits.as_str()))?,
        DeValue::Float(digits) => {
            let float = digits.as_str().parse::<f64>().ok().and_then(serde_json::Number::from_f64);
            Value::Number(float.ok_or_else(|| number(digits.as_str()))?)
        }
        DeValue::Datetime(date) => return Err(SpecError::new(SpecErrorKind::Type, place, format!("{date} is a date; nothing in a spec is"))),
        DeValue::Array(items) => {
            let mut out = Vec::new();
            for (index, item) in items.iter().enumerate() {
                let inner = match item.get_ref() {
                    DeValue::Table(table) => entry_place(place, index, table),
                    _ => place.to_owned(),
                };
                if item.get_ref().is_table() {
                    lines.at.push((inner.clone(), item.span().start));
                }
                out.push(json_value(item.get_ref(), &inner, lines)?);
            }
            Value::Array(out)
        }
        DeValue::Table(table) => json_table(table, place, lines)?,
    })
}

fn entry_place(list: &str, index: usize, table: &DeTable) -> String {
    let text = |key: &str| table.get(key).and_then(|value| value.get_ref().as_str()).map(str::to_owned);
    let mut named = Map::new();
    for key in ["name", "that"] {
        if let Some(text) = text(key) {
            named.insert(key.to_owned(), Value::String(text));
        }
    }
    path::entry(list, index, &Value::Object(named))
}
