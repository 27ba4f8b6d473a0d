//! Values that may be a word instead of a number: `"auto"`, `"end"`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value that may be left to the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Auto<T> {
    /// Written `"auto"`: chosen from the scene and the rest of the spec, and reported as resolved.
    #[default]
    Auto,
    /// Given by the user.
    Value(T),
}

impl<T: Copy> Auto<T> {
    /// The given value, or `fallback` where the program chooses.
    pub fn unwrap_or(self, fallback: T) -> T {
        match self {
            Auto::Auto => fallback,
            Auto::Value(value) => value,
        }
    }
}

/// Until when something lasts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Until {
    /// Written `"end"`.
    #[default]
    End,
    /// A time in seconds.
    Time(f64),
}

impl<T: Serialize> Serialize for Auto<T> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Auto::Auto => serializer.serialize_str("auto"),
            Auto::Value(value) => value.serialize(serializer),
        }
    }
}

impl<'de, T: serde::de::DeserializeOwned> Deserialize<'de> for Auto<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(deserializer)?;
        if value == "auto" {
            return Ok(Auto::Auto);
        }
        T::deserialize(value).map(Auto::Value).map_err(|e| serde::de::Error::custom(format!("{e}, or \"auto\"")))
    }
}

impl Serialize for Until {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Until::End => serializer.serialize_str("end"),
            Until::Time(time_s) => serializer.serialize_f64(*time_s),
        }
    }
}

impl<'de> Deserialize<'de> for Until {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(deserializer)?;
        if value == "end" {
            return Ok(Until::End);
        }
        f64::deserialize(value).map(Until::Time).map_err(|e| serde::de::Error::custom(format!("{e}, or \"end\"")))
    }
}

impl<T: JsonSchema> JsonSchema for Auto<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("Auto_{}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let value = generator.subschema_for::<T>();
        schemars::json_schema!({ "anyOf": [{ "const": "auto" }, value] })
    }
}

impl JsonSchema for Until {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Until".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "anyOf": [{ "const": "end" }, { "type": "number" }] })
    }
}
