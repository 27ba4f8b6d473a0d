//! The scene, time, the world and its ground, resolution.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::Auto;
use crate::spec::limits::{self, length};

/// An axis of the scene's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// +x
    #[serde(rename = "+x")]
    PlusX,
    /// -x
    #[serde(rename = "-x")]
    MinusX,
    /// +y
    #[serde(rename = "+y")]
    PlusY,
    /// -y
    #[serde(rename = "-y")]
    MinusY,
    /// +z
    #[serde(rename = "+z")]
    PlusZ,
    /// -z
    #[serde(rename = "-z")]
    MinusZ,
}

/// Where the Gaussians come from, and how their frame becomes the world's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Path of the splat file, from the spec's folder; `builtin:demo` is the built-in scene; a path that is not UTF-8 is `bytes:` and its bytes, percent-encoded (`bytes:caf%E9.splat`).
    pub file: String,
    /// BLAKE3 of the file's bytes, recorded when the spec is made; a file that changed is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", regex(pattern = "^[0-9a-f]{64}$"))]
    pub blake3: Option<String>,
    /// Which axis of the file points up.
    #[serde(default)]
    pub up: Auto<Axis>,
    /// Metres in one unit of the file.
    #[serde(default = "one")]
    #[schemars(range(min = limits::METRES_PER_UNIT.0, max = limits::METRES_PER_UNIT.1))]
    pub metres_per_unit: f64,
}

fn one() -> f64 {
    1.0
}

/// Length and frame rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Time {
    /// Seconds; `"auto"` is long enough to land and settle by ballistics, 2 to 8.
    #[schemars(extend("minimum" = 0.0, "maximum" = limits::TIME_S))]
    pub duration_s: Auto<f64>,
    /// Frames a second.
    #[schemars(range(min = 1, max = limits::FPS))]
    pub fps: u32,
}

impl Default for Time {
    fn default() -> Self {
        Time { duration_s: Auto::Auto, fps: 50 }
    }
}

/// What acts on everything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct World {
    /// Acceleration of free fall, world frame.
    #[schemars(transform = length(limits::GRAVITY_M_S2))]
    pub gravity_m_s2: [f64; 3],
    /// The ground plane.
    pub ground: Ground,
}

impl Default for World {
    fn default() -> Self {
        World { gravity_m_s2: [0.0, 0.0, -9.81], ground: Ground::default() }
    }
}

/// A horizontal plane that nothing passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Ground {
    /// Height of the plane; `"auto"` is the lowest centre of all objects' Gaussians as captured.
    #[schemars(extend("minimum" = -limits::PLACE_M, "maximum" = limits::PLACE_M))]
    pub height_m: Auto<f64>,
    /// Coulomb coefficient.
    #[schemars(range(min = 0.0, max = limits::FRICTION))]
    pub friction: f64,
    /// Share of the approaching speed that is given back, 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Ground { height_m: Auto::Auto, friction: 0.15, restitution: 0.0 }
    }
}

/// Resolution of the solver, and what a frame may cost. Its substep is its own affair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Grid cells along the longest side of the objects; `"auto"` follows the quality.
    #[schemars(extend("minimum" = limits::CELLS_ACROSS.0, "maximum" = limits::CELLS_ACROSS.1))]
    pub cells_across: Auto<u32>,
    /// Substeps that a fiftieth of a second, or a shorter frame, may take for the sake of stiffness, and as many for the sake of speed. What is
    /// stiffer or faster than they follow is softened or held back, and that is said.
    #[schemars(range(min = limits::SUBSTEPS.0, max = limits::SUBSTEPS.1))]
    pub substeps_most: u32,
}

impl Default for Solver {
    fn default() -> Self {
        Solver { cells_across: Auto::Auto, substeps_most: 4000 }
    }
}
