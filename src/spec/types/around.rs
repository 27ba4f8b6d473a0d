//! What holds and meets objects: pins, colliders.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::Until;
use crate::spec::limits;
use crate::spec::path::NAME_PATTERN;

use super::{ColliderShape, Region};

/// Holds part of an object: still, or along a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Its name, unique among pins.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// The object it holds.
    pub object: String,
    /// Which part: of the captured pose, wherever the object starts.
    pub region: Region,
    /// From when.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub from_s: f64,
    /// Until when.
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub to_s: Until,
    /// Points `[t, dx, dy, dz]` that it takes its part along, straight from one to the next: seconds, then metres
    /// from where it began. It starts from there at `from_s`, and stands still after the last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = limits::PIN_PATH))]
    pub path: Vec<[f64; 4]>,
}

/// A static thing that objects collide with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Collider {
    /// Its name, unique among colliders.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// Where it is solid.
    pub shape: ColliderShape,
    /// Coulomb coefficient.
    #[serde(default = "default_friction")]
    #[schemars(range(min = 0.0, max = limits::FRICTION))]
    pub friction: f64,
    /// Share of the approaching speed that is given back, 0 to 1.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
}

fn default_friction() -> f64 {
    0.3
}
