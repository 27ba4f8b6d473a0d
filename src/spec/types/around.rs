//! What holds, meets and drives objects: pins, colliders, forces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::Until;
use crate::spec::limits::{self, length};
use crate::spec::path::NAME_PATTERN;

use super::{ColliderShape, Region};

/// Holds part of an object still.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Its name, unique among pins.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// The object it holds.
    pub object: String,
    /// Which part.
    pub region: Region,
    /// From when.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub from_s: f64,
    /// Until when.
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub to_s: Until,
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

/// An acceleration of one object over a span of time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Its name, unique among forces.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// The object it moves.
    pub object: String,
    /// From when.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub from_s: f64,
    /// Until when.
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub to_s: Until,
    /// World frame.
    #[schemars(transform = length(limits::ACCELERATION_M_S2))]
    pub acceleration_m_s2: [f64; 3],
}
