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

/// The schema of a list of edits.
pub fn edit() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Vec<Edit>>().to_value())
}
