//! The types of a spec. Field names carry their units; doc comments become the reference.

mod activation;
mod around;
mod event;
mod field;
mod force;
mod material;
mod object;
mod scene;
mod shape;
mod view;
mod young;

pub use activation::*;
pub use around::*;
pub use event::*;
pub use field::*;
pub use force::*;
pub use material::*;
pub use object::*;
pub use scene::*;
pub use shape::*;
pub use view::*;
pub use young::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::auto::Auto;
use super::limits;

/// One simulation, whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "PhysTalk spec")]
pub struct Spec {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = limits::FORMAT))]
    pub format: u32,
    /// Seed of everything random: sampling jitter, dither, expressions.
    #[serde(default = "default_seed")]
    #[schemars(range(max = limits::SEED))]
    pub seed: u64,
    /// The captured scene.
    pub scene: Scene,
    /// How long, how fine in time.
    #[serde(default)]
    pub time: Time,
    /// Gravity and ground.
    #[serde(default)]
    pub world: World,
    /// Resolution of the solver.
    #[serde(default)]
    pub solver: Solver,
    /// The things that move, by name.
    #[schemars(length(min = 1, max = limits::OBJECTS))]
    #[serde(rename = "object")]
    pub objects: Vec<Object>,
    /// What holds parts of objects.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "pin", skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// What objects collide with, beside the ground.
    #[schemars(length(max = limits::COLLIDERS))]
    #[serde(default, rename = "collider", skip_serializing_if = "Vec::is_empty")]
    pub colliders: Vec<Collider>,
    /// Accelerations over a span of time.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "force", skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<Force>,
    /// What happens at an instant.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "event", skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
    /// How Gaussians follow particles.
    #[serde(default)]
    pub skin: Skin,
    /// From where it is seen.
    #[serde(default)]
    pub camera: Auto<Camera>,
    /// The picture.
    #[serde(default)]
    pub output: Output,
    /// What must hold of the result.
    #[schemars(length(max = limits::ENTRIES))]
    #[serde(default, rename = "expect", skip_serializing_if = "Vec::is_empty")]
    pub expectations: Vec<Expectation>,
}

fn default_seed() -> u64 {
    1
}
