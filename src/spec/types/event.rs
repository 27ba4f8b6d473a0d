//! What happens at an instant.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::limits::{self, length};
use crate::spec::path::NAME_PATTERN;

/// Something that happens at an instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Its name, unique among events; `event1`, `event2`, … where none is given.
    #[serde(default)]
    #[schemars(regex(pattern = NAME_PATTERN), transform = limits::no_default)]
    pub name: String,
    /// When.
    #[schemars(range(min = 0.0, max = limits::TIME_S))]
    pub at_s: f64,
    /// To which object.
    pub object: String,
    /// Added to the velocity of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::SPEED_M_S))]
    pub push_m_s: Option<[f64; 3]>,
    /// Replaces the velocity of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::SPEED_M_S))]
    pub velocity_m_s: Option<[f64; 3]>,
}
