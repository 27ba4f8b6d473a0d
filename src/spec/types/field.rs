//! The fields that forces are: moving air, resistance, swirls, pulls, blasts, springs, motors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::Auto;
use crate::spec::limits::{self, each, length};

/// Moving air.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Mean velocity of the air.
    #[schemars(transform = length(limits::SPEED_M_S))]
    pub velocity_m_s: [f64; 3],
    /// How fast what it meets takes on its velocity: acceleration over difference of velocity.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = limits::RATE_PER_S))]
    pub drag_per_s: f64,
    /// How much the whole wind swells and falls, as a share of its speed, over about a second.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 2.0))]
    pub gust: f64,
    /// How strong its eddies are, as a share of its speed; they travel with it.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 2.0))]
    pub turbulence: f64,
    /// Size of its eddies.
    #[serde(default = "eddy")]
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub eddy_m: f64,
}

/// Resistance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Of a slow or sticky stream: speed falls by exp(-linear t).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::RATE_PER_S))]
    pub linear_per_s: f64,
    /// Of a fast stream: a fall ends at the speed sqrt(g / quadratic).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = limits::RATE_PER_S))]
    pub quadratic_per_m: f64,
}

/// A swirl about an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Vortex {
    /// A point of the axis; `"auto"` is the object's centre where it starts.
    #[serde(default)]
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: Auto<[f64; 3]>,
    /// Its direction; it turns counter-clockwise seen against it.
    #[serde(default = "up")]
    #[schemars(transform = each(-1e6, 1e6))]
    pub axis: [f64; 3],
    /// The largest speed S of the air.
    #[schemars(range(min = -limits::SPEED_M_S, max = limits::SPEED_M_S))]
    pub speed_m_s: f64,
    /// Where it has that speed.
    #[serde(default = "half")]
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub radius_m: f64,
    /// Speed of the air along the axis.
    #[serde(default)]
    #[schemars(range(min = -limits::SPEED_M_S, max = limits::SPEED_M_S))]
    pub lift_m_s: f64,
    /// How fast what it meets takes on its velocity.
    #[serde(default = "two")]
    #[schemars(range(min = 0.0, max = limits::RATE_PER_S))]
    pub drag_per_s: f64,
}

/// A pull towards a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Attractor {
    /// Towards where; `"auto"` is the object's centre where it starts.
    #[serde(default)]
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: Auto<[f64; 3]>,
    /// The acceleration at `radius_m`; a negative one pushes away.
    #[schemars(range(min = -limits::ACCELERATION_M_S2, max = limits::ACCELERATION_M_S2))]
    pub strength_m_s2: f64,
    /// Where it has that strength.
    #[serde(default = "one")]
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub radius_m: f64,
    /// 0 the same everywhere, 1 as the inverse of the distance, 2 as gravity, -1 as a spring.
    #[serde(default = "two")]
    #[schemars(range(min = -4.0, max = 8.0))]
    pub falloff: f64,
}

/// A blast.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Explosion {
    /// From where; `"auto"` is the object's centre where it starts.
    #[serde(default)]
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: Auto<[f64; 3]>,
    /// The speed that it gives near its centre.
    #[schemars(range(min = -limits::SPEED_M_S, max = limits::SPEED_M_S))]
    pub speed_m_s: f64,
    /// Where it gives half of that.
    #[serde(default = "one")]
    #[schemars(range(min = limits::SIZE_M.0, max = limits::SIZE_M.1))]
    pub radius_m: f64,
}

/// A spring to a place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Where the object's centre is drawn to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", transform = length(limits::PLACE_M))]
    pub to_m: Option<[f64; 3]>,
    /// Points `[t, x, y, z]` that it is drawn along, straight from one to the next: seconds, then metres.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = limits::PATH))]
    pub path_m: Vec<[f64; 4]>,
    /// The square of its angular frequency: 40 swings about once a second.
    #[serde(default = "stiffness")]
    #[schemars(range(min = 0.0, max = limits::STIFFNESS_PER_S2))]
    pub stiffness_per_s2: f64,
    /// Twice the damping ratio times the angular frequency: 12.6 comes to rest without swinging over at 40.
    #[serde(default = "damping")]
    #[schemars(range(min = 0.0, max = limits::RATE_PER_S))]
    pub damping_per_s: f64,
}

/// Turns about an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// A point of the axis; `"auto"` is the object's centre where it starts.
    #[serde(default)]
    #[schemars(transform = length(limits::PLACE_M))]
    pub centre_m: Auto<[f64; 3]>,
    /// Its direction; it turns counter-clockwise seen against it.
    #[serde(default = "up")]
    #[schemars(transform = each(-1e6, 1e6))]
    pub axis: [f64; 3],
    /// The angular speed aimed at.
    #[schemars(range(min = -limits::SPIN_RAD_S, max = limits::SPIN_RAD_S))]
    pub speed_rad_s: f64,
    /// How fast it is reached: 1 over the time in which the difference falls to a third.
    #[serde(default = "five")]
    #[schemars(range(min = 0.0, max = limits::RATE_PER_S))]
    pub rate_per_s: f64,
}

fn one() -> f64 {
    1.0
}

fn two() -> f64 {
    2.0
}

fn five() -> f64 {
    5.0
}

fn half() -> f64 {
    0.5
}

fn eddy() -> f64 {
    0.3
}

fn stiffness() -> f64 {
    40.0
}

fn damping() -> f64 {
    4.0
}

fn up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}
