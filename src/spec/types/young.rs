//! How stiff a solid is.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Young's modulus, given, left to the program, or something of both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Young {
    /// Written `"auto"`: enough to stand firmly, or to bear its own weight where it flows.
    #[default]
    Auto,
    /// Given by the user, and so it is, whatever comes of it.
    Value(f64),
    /// Written `{ at_least = 1e4 }`: this, and only where that would not bear the thing's own weight as much as just does.
    AtLeast(f64),
}

impl Young {
    /// The number in it.
    pub fn given_pa(self) -> Option<f64> {
        match self {
            Young::Auto => None,
            Young::Value(young_pa) | Young::AtLeast(young_pa) => Some(young_pa),
        }
    }
}

/// The table that [`Young::AtLeast`] is written as.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Least {
    at_least: f64,
}

impl Serialize for Young {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Young::Auto => serializer.serialize_str("auto"),
            Young::Value(young_pa) => serializer.serialize_f64(young_pa),
            Young::AtLeast(at_least) => Least { at_least }.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Young {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(deserializer)?;
        if value == "auto" {
            return Ok(Young::Auto);
        }
        if value.is_object() {
            return serde_json::from_value(value).map(|Least { at_least }| Young::AtLeast(at_least)).map_err(serde::de::Error::custom);
        }
        serde_json::from_value(value).map(Young::Value).map_err(|e| serde::de::Error::custom(format!("{e}, \"auto\" or {{ at_least = 1e4 }}")))
    }
}

impl JsonSchema for Young {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Young".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let (low, high) = crate::spec::limits::YOUNG_PA;
        let number = generator.subschema_for::<f64>();
        let mut least = number.clone();
        least.insert("minimum".to_owned(), low.into());
        least.insert("maximum".to_owned(), high.into());
        let table =
            serde_json::json!({ "type": "object", "properties": { "at_least": least }, "required": ["at_least"], "additionalProperties": false });
        schemars::json_schema!({ "anyOf": [{ "const": "auto" }, number, table] })
    }
}
