//! How it is seen and what is expected of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::Auto;
use crate::spec::limits::{self, each, length};

/// Skinning weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// Exact under any affine motion.
    #[default]
    Exact,
    /// The paper's equations as printed.
    Paper,
}

/// How Gaussians follow particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Skin {
    /// How many particles each Gaussian follows, 1 to 16.
    #[schemars(range(min = 1, max = limits::NEIGHBOURS))]
    pub neighbours: u32,
    /// How they are weighted.
    pub weights: Weights,
}

impl Default for Skin {
    fn default() -> Self {
        Skin { neighbours: 8, weights: Weights::Exact }
    }
}

/// A camera in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where it stands.
    #[schemars(transform = length(limits::PLACE_M))]
    pub eye_m: [f64; 3],
    /// What it looks at.
    #[schemars(transform = length(limits::PLACE_M))]
    pub target_m: [f64; 3],
    /// Vertical field of view.
    #[serde(default = "default_fov")]
    #[schemars(range(min = limits::FOV_DEG.0, max = limits::FOV_DEG.1))]
    pub fov_deg: f64,
    /// Turns about the vertical through the target; counter-clockwise seen from above.
    #[serde(default)]
    #[schemars(range(min = -limits::ORBIT_DEG_S, max = limits::ORBIT_DEG_S))]
    pub orbit_deg_s: f64,
}

fn default_fov() -> f64 {
    45.0
}

/// The picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Width and height in pixels; `"auto"` is 1280 x 720, in draft 640 x 360.
    #[schemars(transform = each(limits::PICTURE.0, limits::PICTURE.1))]
    pub size: Auto<[u32; 2]>,
    /// `#rrggbb`, sRGB.
    #[schemars(regex(pattern = limits::COLOUR_PATTERN))]
    pub background: String,
}

impl Default for Output {
    fn default() -> Self {
        Output { size: Auto::Auto, background: "#eaeaf2".to_owned() }
    }
}

/// What must hold of the result, such as `vase.apex_m > 0.3`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// The condition.
    pub that: String,
}
