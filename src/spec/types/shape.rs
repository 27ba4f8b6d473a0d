//! Shapes, and what is picked by them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::limits::{self, each, length};

/// An axis-aligned box, world frame; what it picks of an object it picks in the captured pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Its centre.
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: [f64; 3],
    /// Its whole edge lengths.
    #[schemars(transform = each(limits::SIZE_M.0, limits::SIZE_M.1))]
    pub size_m: [f64; 3],
}

/// A sphere, world frame; what it picks of an object it picks in the captured pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereShape {
    /// Its centre.
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: [f64; 3],
    /// Its radius.
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub radius_m: f64,
}

/// A rod with round ends: all that is within a radius of a line, world frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleShape {
    /// One end of the line.
    #[schemars(transform = length(limits::PLACE_M))]
    pub from_m: [f64; 3],
    /// The other end.
    #[schemars(transform = length(limits::PLACE_M))]
    pub to_m: [f64; 3],
    /// Its radius.
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub radius_m: f64,
}

/// A half-space: everything behind a plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneShape {
    /// A point of the plane.
    #[schemars(transform = length(limits::PLACE_M))]
    pub point_m: [f64; 3],
    /// Points out of the solid side; need not be of unit length.
    pub normal: [f64; 3],
}

/// Which Gaussians belong to an object: those whose centres are inside.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Select {
    /// Every Gaussian of the scene.
    #[default]
    All,
    /// Those in a box.
    Box(BoxShape),
    /// Those in a sphere.
    Sphere(SphereShape),
    /// Those of these places in the scene's file, from 0.
    Ids(#[schemars(length(min = 1, max = limits::IDS))] Vec<u32>),
}

/// A part of an object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// Above this fraction of the object's height.
    Above(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// Below this fraction of the object's height.
    Below(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// In a box.
    Box(BoxShape),
    /// In a sphere.
    Sphere(SphereShape),
    /// Behind a plane.
    HalfSpace(PlaneShape),
}

/// The shape of a static collider, world metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColliderShape {
    /// A box.
    Box(BoxShape),
    /// A sphere.
    Sphere(SphereShape),
    /// A rod with round ends.
    Capsule(CapsuleShape),
    /// A half-space.
    Plane(PlaneShape),
}
