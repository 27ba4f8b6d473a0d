//! JSON Schema of specs and edits, made from the types.

use std::sync::OnceLock;

use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::{Edit, Spec};

/// The schema of a spec, ranges included.
pub fn spec() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Spec>().to_value())
}

/// The paths of all values of a spec, with `NAME` for the entries of lists.
pub fn paths() -> &'static [String] {
    static PATHS: OnceLock<Vec<String>> = OnceLock::new();
    PATHS.get_or_init(|| {
        let mut paths = Vec::new();
        collect(spec(), "", &mut paths);
        // A parameter that several kinds of material share is one path.
        let mut seen = std::collections::BTreeSet::new();
        paths.retain(|path| seen.insert(path.clone()));
        paths
    })
}

fn collect(schema: &Value, path: &str, paths: &mut Vec<String>) {
    let reference = |schema: &Value| schema["$ref"].as_str().and_then(|reference| spec().pointer(reference.strip_prefix('#')?));
    let schema = reference(schema).unwrap_or(schema);
    if let Some(items) = schema.get("items").and_then(reference) {
        return collect(items, &format!("{path}.NAME"), paths);
    }
    let forms = schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Value::as_array);
    let number = forms.into_iter().flatten().any(|form| form["type"] == "number");
    let tables = forms.into_iter().flatten().map(|form| reference(form).unwrap_or(form)).chain([schema]);
    let properties: Vec<_> = tables.filter_map(|table| table["properties"].as_object()).flatten().collect();
    if properties.is_empty() || number {
        paths.push(path.to_owned());
    }
    for (key, property) in properties {
        collect(property, &super::path::join(path, key), paths);
    }
}

/// The schema of a list of edits.
pub fn edit() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Vec<Edit>>().to_value())
}
