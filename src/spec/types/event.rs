//! What happens at an instant.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::limits::{self, length};
use crate::spec::path::NAME_PATTERN;

use super::Material;

/// What an event waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// The first time that the object meets the ground, a collider or another object that it did not touch before.
    Impact,
}

/// Something that happens at an instant: one thing, at a time or when something occurs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Its name, unique among events; `event1`, `event2`, … where none is given.
    #[serde(default)]
    #[schemars(regex(pattern = NAME_PATTERN), transform = limits::no_default)]
    pub name: String,
    /// At this time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 0.0, max = limits::TIME_S))]
    pub at_s: Option<f64>,
    /// Or when this occurs, the first time; see below.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "When")]
    pub when: Option<When>,
    /// To which object.
    pub object: String,
    /// Only to this part of it, where its material changes, weakens or freezes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub part: Option<String>,
    /// Added to the velocity of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::SPEED_M_S))]
    pub push_m_s: Option<[f64; 3]>,
    /// Replaces the velocity of all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::SPEED_M_S))]
    pub velocity_m_s: Option<[f64; 3]>,
    /// What it is made of from then on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Material")]
    pub material: Option<Material>,
    /// Multiplies its stiffness, and its yield stress and cohesion where it has them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = limits::WEAKEN.0, max = limits::WEAKEN.1))]
    pub weaken: Option<f64>,
    /// Makes it a solid of the shape that it has then, free of stress and moving on: what it was at the start where that
    /// kept its shape, else an elastic one. A release melts it again.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub freeze: bool,
    /// Ends every pin of the object that has begun, and undoes a freeze.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub release: bool,
}

impl Event {
    /// An event without an effect yet.
    pub fn at(name: &str, object: &str, at_s: f64) -> Event {
        Event { name: name.to_owned(), object: object.to_owned(), at_s: Some(at_s), ..Event::default() }
    }

    /// An event that waits for an impact, without an effect yet.
    pub fn on_impact(name: &str, object: &str) -> Event {
        Event { name: name.to_owned(), object: object.to_owned(), when: Some(When::Impact), ..Event::default() }
    }

    /// The keys of what it does: exactly one in a spec that holds.
    pub fn effects(&self) -> Vec<&'static str> {
        let given = [
            (self.push_m_s.is_some(), "push_m_s"),
            (self.velocity_m_s.is_some(), "velocity_m_s"),
            (self.material.is_some(), "material"),
            (self.weaken.is_some(), "weaken"),
            (self.freeze, "freeze"),
            (self.release, "release"),
        ];
        given.into_iter().filter(|(is, _)| *is).map(|(_, key)| key).collect()
    }
}
