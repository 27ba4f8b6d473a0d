//! A thing that moves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::limits::{self, each, length};
use crate::spec::path::NAME_PATTERN;

use super::{Axis, Material, Region, Select};

/// How Gaussians become a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProxyKind {
    /// Occupied voxels: concave things stay concave.
    #[default]
    Voxel,
    /// The convex hull of the pruned centres, as in the paper.
    Hull,
}

/// What the captured pose means for the solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Rest {
    /// It stands as captured: its prestress is solved first.
    #[default]
    AsCaptured,
    /// The captured pose is free of stress.
    StressFree,
}

/// A thing that moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Object {
    /// Its name, `[a-z0-9_-]+`, unique; the scene file's name up to its first dot where none is given.
    #[serde(default)]
    #[schemars(regex(pattern = NAME_PATTERN), transform = limits::no_default)]
    pub name: String,
    /// Its Gaussians.
    #[serde(default)]
    pub select: Select,
    /// How they become a solid.
    #[serde(default)]
    pub proxy: ProxyKind,
    /// What it is made of.
    #[serde(default)]
    pub material: Material,
    /// Parts of another material, bonded to the rest; of two that overlap the later one has what both claim.
    #[schemars(length(max = limits::PARTS))]
    #[serde(default, rename = "part", skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Part>,
    /// Moved by this before t = 0, after the rotation.
    #[serde(default)]
    #[schemars(transform = length(limits::PLACE_M))]
    pub offset_m: [f64; 3],
    /// Turned about fixed x, then y, then z, through the captured centre of mass.
    #[serde(default)]
    #[schemars(transform = each(-limits::ROTATE_DEG, limits::ROTATE_DEG))]
    pub rotate_deg: [f64; 3],
    /// What the captured pose means.
    #[serde(default)]
    pub rest: Rest,
    /// Velocity at t = 0.
    #[serde(default)]
    #[schemars(transform = length(limits::SPEED_M_S))]
    pub velocity_m_s: [f64; 3],
    /// Angular velocity at t = 0 about the centre of mass.
    #[serde(default)]
    #[schemars(transform = length(limits::SPIN_RAD_S))]
    pub spin_rad_s: [f64; 3],
    /// Which world axis is the object's front.
    #[serde(default = "plus_x")]
    pub forward: Axis,
}

fn plus_x() -> Axis {
    Axis::PlusX
}

impl Object {
    /// Whether any of it stands by its own elasticity.
    pub fn stands(&self) -> bool {
        self.material.stands() || self.parts.iter().any(|part| part.material.stands())
    }

    /// An elastic object of all Gaussians, at rest.
    pub fn new(name: &str) -> Object {
        Object {
            name: name.to_owned(),
            select: Select::All,
            proxy: ProxyKind::Voxel,
            material: Material::default(),
            parts: Vec::new(),
            offset_m: [0.0; 3],
            rotate_deg: [0.0; 3],
            rest: Rest::AsCaptured,
            velocity_m_s: [0.0; 3],
            spin_rad_s: [0.0; 3],
            forward: Axis::PlusX,
        }
    }
}

/// Another material in part of an object: no gap and no contact between them, they are one body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its name, unique within the object.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// Which part of the object, in the captured pose.
    pub region: Region,
    /// What it is made of.
    #[serde(default)]
    pub material: Material,
}
