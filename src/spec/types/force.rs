//! What drives objects: accelerations and fields over a span of time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::auto::{Auto, Until};
use crate::spec::limits::{self, each, length};
use crate::spec::path::NAME_PATTERN;

/// Drives one object over a span of time. Exactly one of the ways is given; each acts on every particle by
/// itself, as an acceleration.
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
    /// An acceleration in the world frame: three numbers, or an expression (see below) such as
    /// `"vec3(6 * sin(3 * t), 0, 0)"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Acceleration", transform = length(limits::ACCELERATION_M_S2))]
    pub acceleration_m_s2: Option<Acceleration>,
    /// Air that moves, and drags particles along: a = drag_per_s (air - v).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Wind")]
    pub wind: Option<Wind>,
    /// Resistance of what it moves through: a = -(linear + quadratic |v|) v.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Drag")]
    pub drag: Option<Drag>,
    /// Air that circles: at a distance r from the axis it has the speed 2 S s / (1 + s^2), s = r / radius_m. What floats
    /// along stays on its circle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vortex")]
    pub vortex: Option<Vortex>,
    /// A pull towards a point: a = strength (radius_m / r)^falloff, blunted within a tenth of the radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Attractor")]
    pub attractor: Option<Attractor>,
    /// A blast at `from_s`, over a hundredth of a second: speed / (1 + (r / radius_m)^2) away from a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Explosion")]
    pub explosion: Option<Explosion>,
    /// A spring that draws the object, in its captured shape, to a place or along a path:
    /// a = -stiffness (x - goal) - damping (v - velocity of the goal). The goal of each particle is its captured place, moved
    /// so that the object's centre is at `to_m` or on `path_m`: exactly one of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Spring")]
    pub spring: Option<Spring>,
    /// Drives the speed around an axis towards that of a turning body, and leaves the rest of the motion alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Motor")]
    pub motor: Option<Motor>,
}

/// Three numbers, or an expression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Acceleration {
    /// The same everywhere and always.
    Constant([f64; 3]),
    /// The canonical text of an expression that gives a vector.
    Expression(String),
}

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

/// What a force is: the one of its ways that is given.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each is the key of the spec that it is called")]
pub enum Drive<'a> {
    Constant([f64; 3]),
    Expression(&'a str),
    Wind(&'a Wind),
    Drag(&'a Drag),
    Vortex(&'a Vortex),
    Attractor(&'a Attractor),
    Explosion(&'a Explosion),
    Spring(&'a Spring),
    Motor(&'a Motor),
}

impl Force {
    /// One without any way to act yet.
    pub fn new(name: &str, object: &str, from_s: f64, to_s: Until) -> Force {
        Force {
            name: name.to_owned(),
            object: object.to_owned(),
            from_s,
            to_s,
            acceleration_m_s2: None,
            wind: None,
            drag: None,
            vortex: None,
            attractor: None,
            explosion: None,
            spring: None,
            motor: None,
        }
    }

    /// A constant acceleration.
    pub fn constant(name: &str, object: &str, from_s: f64, to_s: Until, acceleration_m_s2: [f64; 3]) -> Force {
        Force { acceleration_m_s2: Some(Acceleration::Constant(acceleration_m_s2)), ..Force::new(name, object, from_s, to_s) }
    }

    /// Every way that is given; a valid force has one.
    pub fn drives(&self) -> Vec<Drive<'_>> {
        let acceleration = self.acceleration_m_s2.as_ref().map(|a| match a {
            Acceleration::Constant(a) => Drive::Constant(*a),
            Acceleration::Expression(text) => Drive::Expression(text),
        });
        let all = [
            acceleration,
            self.wind.as_ref().map(Drive::Wind),
            self.drag.as_ref().map(Drive::Drag),
            self.vortex.as_ref().map(Drive::Vortex),
            self.attractor.as_ref().map(Drive::Attractor),
            self.explosion.as_ref().map(Drive::Explosion),
            self.spring.as_ref().map(Drive::Spring),
            self.motor.as_ref().map(Drive::Motor),
        ];
        all.into_iter().flatten().collect()
    }

    /// Its constant acceleration, where it is one.
    pub fn constant_m_s2(&self) -> Option<[f64; 3]> {
        match self.acceleration_m_s2 {
            Some(Acceleration::Constant(a)) => Some(a),
            _ => None,
        }
    }

    /// Makes it a constant acceleration, whatever it was.
    pub fn set_constant(&mut self, acceleration_m_s2: [f64; 3]) {
        *self = Force::constant(&self.name, &self.object, self.from_s, self.to_s, acceleration_m_s2);
    }
}

impl Force {
    /// How strong it is, and in what unit: an acceleration, a speed, a rate. None of an expression.
    pub fn strength(&self) -> Option<(f64, &'static str)> {
        let length = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(match self.drives().first()? {
            Drive::Constant(a) => (length(a), "m/s²"),
            Drive::Expression(_) => return None,
            Drive::Wind(wind) => (length(&wind.velocity_m_s), "m/s"),
            Drive::Drag(drag) if drag.linear_per_s > 0.0 => (drag.linear_per_s, "/s"),
            Drive::Drag(drag) => (drag.quadratic_per_m, "/m"),
            Drive::Vortex(vortex) => (vortex.speed_m_s, "m/s"),
            Drive::Attractor(attractor) => (attractor.strength_m_s2, "m/s²"),
            Drive::Explosion(explosion) => (explosion.speed_m_s, "m/s"),
            Drive::Spring(spring) => (spring.stiffness_per_s2, "/s²"),
            Drive::Motor(motor) => (motor.speed_rad_s, "rad/s"),
        })
    }

    /// Multiplies its strength; of an expression the whole.
    pub fn scale(&mut self, ratio: f64) {
        match &mut self.acceleration_m_s2 {
            Some(Acceleration::Constant(a)) => *a = a.map(|x| x * ratio),
            Some(Acceleration::Expression(text)) => *text = format!("{} * ({text})", crate::spec::number(ratio)),
            None => {}
        }
        if let Some(wind) = &mut self.wind {
            wind.velocity_m_s = wind.velocity_m_s.map(|x| x * ratio);
        }
        if let Some(drag) = &mut self.drag {
            (drag.linear_per_s, drag.quadratic_per_m) = (drag.linear_per_s * ratio.abs(), drag.quadratic_per_m * ratio.abs());
        }
        let single = [
            self.vortex.as_mut().map(|v| &mut v.speed_m_s),
            self.attractor.as_mut().map(|a| &mut a.strength_m_s2),
            self.explosion.as_mut().map(|e| &mut e.speed_m_s),
            self.motor.as_mut().map(|m| &mut m.speed_rad_s),
        ];
        single.into_iter().flatten().for_each(|strength| *strength *= ratio);
        if let Some(spring) = &mut self.spring {
            spring.stiffness_per_s2 *= ratio.abs();
        }
    }
}
